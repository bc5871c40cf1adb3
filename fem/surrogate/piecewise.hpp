#pragma once
/// Interpolation in one direction as a linear map from data at nodes to the coefficients of polynomials
/// between them.
///
/// Between nodes x_i and x_(i+1), with t = (x - x_i) / h_i in [0, 1]:   s(x) = Σ_k c_ik t^k
///
/// - spline of odd degree p through values: p - 1 times continuously differentiable, with the not-a-knot
/// condition: no
///   knots at the first and last (p - 1)/2 inner nodes (de Boor 2001, A Practical Guide to Splines, ch. IV
///   and XIII)
/// - cubic Hermite through values and slopes: once continuously differentiable
/// - quintic Hermite through values and slopes, with the second derivatives that make the third continuous,
/// and the
///   fourth at the first and last inner node: three times continuously differentiable
/// - monotone cubic (Fritsch & Carlson 1980, doi:10.1137/0717021): not linear in its data, so not a map

#include <Eigen/Core>
#include <vector>

namespace brachium::fem {

/// Coefficients c_ik = row i (degree + 1) + k; columns stand for the data.
struct PiecewiseMap {
  int degree = 0;
  Eigen::MatrixXd from_values;  ///< cells (degree + 1) x nodes
  Eigen::MatrixXd from_slopes;  ///< the same, or empty where only values are taken
};

/// Spline of degree 1, 3 or 5 through values. With n <= degree nodes: the polynomial of degree n - 1 through
/// them. Throws InputError("bad-option") for another degree or fewer than 2 nodes.
PiecewiseMap spline_map(const std::vector<double>& nodes, int degree);

/// Hermite interpolation of degree 3 or 5; with 2 nodes always 3.
PiecewiseMap hermite_map(const std::vector<double>& nodes, int degree);

/// Slopes at the nodes of the spline through values (nodes x nodes).
Eigen::MatrixXd slope_map(const std::vector<double>& nodes, int degree);

/// Coefficients of the monotone cubic through the columns of `values` (nodes x m): 4 cells x m.
Eigen::MatrixXd monotone_coefficients(const std::vector<double>& nodes, const Eigen::MatrixXd& values);

/// Value and derivatives up to the second of B-splines of a degree over knots, at x: 3 x (degree + 1), for
/// the functions `first` to `first + degree` (Piegl & Tiller 1997, The NURBS Book, algorithm A2.3, written
/// anew by recursion).
struct SplineValues {
  std::size_t first = 0;
  Eigen::MatrixXd derivative;  ///< row d: d-th derivative
};
SplineValues bsplines(const std::vector<double>& knots, int degree, double x, int derivatives);

}  // namespace brachium::fem
