#pragma once
/// Sparse-grid splines: F(θ, α) = Σ c_p φ_(p.θ) φ_(p.α) over the points of a sparse grid, interpolating
/// there.

#include <map>

#include "fem/surrogate/sparse_grid.hpp"
#include "fem/surrogate/surrogate.hpp"

namespace brachium::fem {

/// Values of the outputs at the points of a grid.
using SparseValues = std::map<SparseIndex, Eigen::VectorXd>;

/// Hierarchical coefficients and what follows from them.
struct SparseSpline {
  SparseBoundary boundary = SparseBoundary::modified;
  std::vector<SparseIndex> points;
  Eigen::MatrixXd surplus;   ///< c: points x outputs
  Eigen::MatrixXd left_out;  ///< error at a point of the interpolant of all others, c_p / (A⁻¹)_pp (Rippa
                             ///< 1999, doi:10.1023/A:1018975909870, for any basis); points x outputs
  /// Sum over all points: the slow way, for states in the unit square; row o: value, d/dx, d/dy.
  Eigen::Matrix<double, Eigen::Dynamic, 3> evaluate(double x, double y) const;
};

/// Solves A c = F, A_pq = φ_q(x_p). Throws ConvergenceFailure where the points do not determine the
/// coefficients.
SparseSpline interpolate(SparseBoundary boundary, const SparseValues& values);

/// As a surrogate over `bounds`. Its error estimate leaves out each leaf of the grid in turn, all of it
/// (boundary `modified`) only inside: towards the boundary that basis extrapolates. Throws
/// InputError("surrogate-too-fine") for more than 2^17 cells.
Surrogate make_surrogate(const SparseSpline& spline, const StateBounds& bounds,
                         std::vector<std::string> outputs);

/// From samples that lie on a sparse grid over `bounds`, in any order.
Surrogate sparse_surrogate(const SampleSet& samples, const StateBounds& bounds, SparseBoundary boundary);

}  // namespace brachium::fem
