#pragma once
/// An interactive view of a deforming body as HTML: a static picture for print and for pages without script,
/// the data, and (once a page, view3d_script) what turns them into something one can turn: WebGL 2, or a
/// painter's algorithm on a plain canvas where there is none. Nothing is fetched.
///
/// Numbers are written as digits of base 64 (RFC 4648's alphabet): positions with three digits, 2^18 steps
/// along the longest side of all states; values with two, 4095 steps over the field's range and one code for
/// "no value".

#include <string>
#include <string_view>
#include <vector>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// The view as an HTML <figure>. Throws std::logic_error where the view contradicts itself: positions or
/// values that are not one a point, a triangle of points that are not there, positions that are not finite.
std::string draw_view3d(const View3d& view);

/// The script that all views of a page share.
std::string_view view3d_script();

// ---------------------------------------------------------------- its parts, for tests

/// Range that colours cover. A few extreme values (stress at the edge of a clamp) would leave one colour for
/// all others: where they widen the range by half or more, it covers 99 % of the values and says on which
/// side it is cut.
struct ColourRange {
  double lower = 0.0, upper = 1.0;  ///< lower < upper
  bool cut_below = false, cut_above = false;
};
ColourRange colour_range(const ViewField& field);

/// A view that takes at most `view.limit_bytes`: evenly chosen states (first and last kept, down to eight),
/// then points that lie close together merged (vertex clustering: Rossignac & Borrel 1993,
/// doi:10.1007/978-3-642-78114-8_29; cell edges are then left out), then fewer states. What was done is added
/// to the note.
View3d fitted_view(const View3d& view);

/// Points merged until at most `points` are left; unused points are dropped.
View3d coarsened_view(const View3d& view, std::size_t points);

/// Characters that the data of a view take, without its picture.
std::size_t view_bytes(const View3d& view);

/// Rows: directions of the screen (right, up, towards the reader) in the body's axes, as the view begins.
std::array<double, 9> first_look(const View3d& view);

/// The static picture: the last state in the first field's colours, as SVG.
std::string draw_poster(const View3d& view);

/// `count` digits of base 64, most significant first; 0 <= value < 64^count.
void append_digits(std::string& out, unsigned value, int count);

}  // namespace brachium::pipelines::report
