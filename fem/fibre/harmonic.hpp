#pragma once
/// Harmonic fibres: Delta phi = 0 in the regions, phi = 0 on the origin, 1 on the insertion, no flux
/// elsewhere; a0 = grad phi/|grad phi|. Laplace-based fibres are described by Bayer et al. 2012,
/// doi:10.1007/s10439-012-0593-5 (heart), and Choi & Blemker 2013, doi:10.1371/journal.pone.0077576 (skeletal
/// muscle).

#include <string>
#include <vector>

#include "fem/fibre/points.hpp"
#include "fem/fibre/rules.hpp"

namespace brachium::fem {

struct HarmonicSummary {
  int unknowns = 0;
  double smallest_gradient_per_m = 0.0;
  double largest_gradient_per_m = 0.0;
  int smallest_gradient_cell = -1;
};

/// Fills columns q + n_q c of `fibre` for the cells given. Throws as build_tissue() says; a gradient below
/// 1e-6 over the size of the body counts as vanished.
HarmonicSummary harmonic_fibres(const CellPoints& points, const HarmonicFibres& rule,
                                const std::vector<int>& cells, Eigen::Matrix3Xd& fibre);

/// The harmonic function itself at the points of the mesh; NaN at points that no cell given has.
Eigen::VectorXd harmonic_function(const CellPoints& points, const HarmonicFibres& rule,
                                  const std::vector<int>& cells);

}  // namespace brachium::fem
