#include "fem/quantities/cell_point.hpp"

#include <Eigen/LU>

#include "fem/element/shape.hpp"

namespace brachium::fem {

CellPoint cell_point(const Discretisation& discretisation, const Eigen::VectorXd& dofs, int cell,
                     const Eigen::Vector3d& xi) {
  const data::Mesh& mesh = discretisation.mesh();
  const Shape shape = cell_shape(mesh.type, xi);
  const Eigen::Index corners = shape.value.size();  // nodes that carry the geometry
  const int nodes = discretisation.nodes_per_cell();

  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();  // dX/dxi
  CellPoint point;
  for (Eigen::Index a = 0; a < corners; ++a) {
    const Eigen::Vector3d X = mesh.points.col(mesh.cells(a, cell));
    point.position += shape.value[a] * X;
    jacobian += X * shape.derivative.row(a);
  }
  point.measure = jacobian.determinant();

  Eigen::MatrixX3d local(nodes, 3);
  point.value.resize(nodes);
  local.topRows(corners) = shape.derivative;
  point.value.head(corners) = shape.value;
  if (nodes > corners) {
    const Shape bubble = bubble_shape(xi);
    local.row(corners) = bubble.derivative;
    point.value[corners] = bubble.value[0];
  }
  point.gradient = local * jacobian.inverse();
  if (dofs.size() == 0) return point;
  for (int a = 0; a < nodes; ++a) {
    const Eigen::Vector3d u = dofs.segment<3>(3 * discretisation.nodes_of_cell()(a, cell));
    point.displacement += point.value[a] * u;
    point.F += u * point.gradient.row(a);
  }
  return point;
}

Eigen::Matrix3d deformation_gradient(const Discretisation& discretisation, const Eigen::VectorXd& dofs,
                                     int cell, int q, double& weight) {
  Eigen::MatrixX3d gradient;
  discretisation.reference_gradients(cell, q, gradient, weight);
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
  for (int a = 0; a < discretisation.nodes_per_cell(); ++a) {
    F += dofs.segment<3>(3 * discretisation.nodes_of_cell()(a, cell)) * gradient.row(a);
  }
  return F;
}

}  // namespace brachium::fem
