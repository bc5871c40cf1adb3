#pragma once
/// Values at quadrature points brought to the points of the mesh.

#include <Eigen/Core>

#include "fem/assembly/discretisation.hpp"

namespace brachium::fem {

/// Least squares within each cell over polynomials in local coordinates (tri-linear on hex8, linear on tet4,
/// complete quadratic on the others), evaluated at the cell's nodes, then the mean over the cells that meet
/// at a point. Where regions meet, a point takes the mean over the cells of the region that is named first:
/// values are not mixed across tissues. `at_quadrature`: values x (n_q n_cells), columns q + n_q c; returns
/// values x n_points. Throws InputError("field-size").
Eigen::MatrixXd to_points(const Discretisation& discretisation, const Eigen::MatrixXd& at_quadrature);

/// Extrapolation within one cell: row vector w with value(xi) = at_quadrature_of_cell · w', for the same
/// polynomials.
Eigen::VectorXd extrapolation_weights(const Discretisation& discretisation, const Eigen::Vector3d& xi);

}  // namespace brachium::fem
