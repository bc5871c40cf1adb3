#pragma once
/// Shape functions of the cells, in the node order of data/model/mesh.hpp, and of their faces.
/// Source: Zienkiewicz, Taylor & Zhu 2013, doi:10.1016/C2009-0-24909-9, ch. 6.

#include <Eigen/Core>

#include "data/model/mesh.hpp"

namespace brachium::fem {

/// Values and derivatives at one local point.
struct Shape {
  Eigen::VectorXd value;       ///< n_nodes
  Eigen::MatrixXd derivative;  ///< n_nodes x local dimension (3 in cells, 2 on faces)
};

/// N_a(xi) and dN_a/dxi of a cell. Hexahedra are serendipity for hex20, tensor products otherwise.
Shape cell_shape(data::CellType type, const Eigen::Vector3d& xi);

/// Bubble of a tetrahedron, 256 L0 L1 L2 L3: value and derivative (1 x 3).
Shape bubble_shape(const Eigen::Vector3d& xi);

/// Shape functions of a face with the nodes of data::face_nodes(); local coordinates (r, s) in [-1, 1]^2 for
/// quadrilaterals (first node at (-1,-1), then counter-clockwise), in the unit triangle for triangles. dx/dr x dx/ds
/// points outward.
Shape face_shape(data::CellType type, const Eigen::Vector2d& rs);

/// Local coordinates of a cell's nodes, 3 x n_nodes.
const Eigen::Matrix3Xd& node_coordinates(data::CellType type);

}  // namespace brachium::fem
