#pragma once
/// Shape functions and geometry at a formulation's quadrature points, as the rules of this folder need them.

#include <Eigen/LU>
#include <vector>

#include "data/model/mesh.hpp"
#include "fem/element/quadrature.hpp"
#include "fem/element/shape.hpp"

namespace brachium::fem {

class CellPoints {
 public:
  /// Throws InputError("cell-type-mismatch").
  CellPoints(const data::Mesh& mesh, Formulation formulation);

  const data::Mesh& mesh() const { return *mesh_; }
  int per_cell() const { return static_cast<int>(shapes_.size()); }
  const Shape& shape(int q) const { return shapes_[static_cast<std::size_t>(q)]; }
  /// 3 x nodes of a cell [m].
  Eigen::Matrix3Xd nodes(int cell) const;
  /// dX/dxi at a quadrature point, columns by local axis; nodes as above.
  Eigen::Matrix3d jacobian(const Eigen::Matrix3Xd& nodes, int q) const { return nodes * shape(q).derivative; }
  /// Volume that a point stands for [m3].
  double volume(const Eigen::Matrix3d& jacobian, int q) const { return weights_[q] * jacobian.determinant(); }

 private:
  const data::Mesh* mesh_;
  std::vector<Shape> shapes_;
  Eigen::VectorXd weights_;
};

}  // namespace brachium::fem
