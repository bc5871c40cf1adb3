#include "fem/fibre/points.hpp"

namespace brachium::fem {

CellPoints::CellPoints(const data::Mesh& mesh, Formulation formulation) : mesh_(&mesh) {
  if (mesh.type != cell_type(formulation)) {
    throw data::InputError("cell-type-mismatch",
                           "the mesh has " + to_string(mesh.type) + " cells, `" + to_string(formulation) +
                               "` takes " + to_string(cell_type(formulation)),
                           "convert the mesh, or choose a formulation for its cells");
  }
  const Quadrature& rule = cell_quadrature(formulation);
  weights_ = rule.weights;
  for (int q = 0; q < rule.size(); ++q) shapes_.push_back(cell_shape(mesh.type, rule.points.col(q)));
}

Eigen::Matrix3Xd CellPoints::nodes(int cell) const {
  Eigen::Matrix3Xd X(3, mesh_->cells.rows());
  for (int a = 0; a < X.cols(); ++a) X.col(a) = mesh_->points.col(mesh_->cells(a, cell));
  return X;
}

}  // namespace brachium::fem
