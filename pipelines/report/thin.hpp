#pragma once
/// Long series made short without changing their picture.
///
/// Of all consecutive samples that fall into one column of pixels, a line drawing shows no more than the
/// first, the last, the lowest and the highest: keeping these four gives the same picture (M4 aggregation:
/// Jugel, Jerzak, Hackenbroich & Markl 2014, doi:10.14778/2732951.2732953).

#include <cstddef>
#include <span>
#include <vector>

namespace brachium::pipelines::report {

/// Indices to keep, ascending. x_px, y_px: positions in pixels, equal length; a NaN in either breaks the
/// curve, and one index of each break is kept so that the break survives. `column_px` > 0: width of a column.
std::vector<std::size_t> thin_line(std::span<const double> x_px, std::span<const double> y_px,
                                   double column_px = 1.0);

/// Indices of one point for every square of `cell_px` that holds any, ascending; points that are NaN are left
/// out.
std::vector<std::size_t> thin_points(std::span<const double> x_px, std::span<const double> y_px,
                                     double cell_px = 1.0);

}  // namespace brachium::pipelines::report
