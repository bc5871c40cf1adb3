#pragma once
/// Reference position, gradients and deformation at any local point of a cell.
///
/// | symbol | identifier | unit | meaning                                                   |
/// |--------|------------|------|-----------------------------------------------------------|
/// | xi     | xi         | 1    | local coordinates of a cell (data/model/mesh.hpp)         |
/// | N_a    | value      | 1    | shape functions, the bubble last where there is one       |
/// | dN_a/dX| gradient   | 1/m  | their gradients in the reference placement                |
/// | X, u   | position, displacement | m | reference position, displacement                 |
/// | F      | F          | 1    | deformation gradient, 1 + Σ u_a ⊗ dN_a/dX                 |

#include <Eigen/Core>

#include "fem/assembly/assembly.hpp"

namespace brachium::fem {

struct CellPoint {
  Eigen::VectorXd value;
  Eigen::MatrixX3d gradient;
  double measure = 0.0;  ///< det dX/dxi [m3 per local volume]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
};

/// `dofs`: by dof of the discretisation, global axes; empty: the reference placement.
CellPoint cell_point(const Discretisation& discretisation, const Eigen::VectorXd& dofs, int cell,
                     const Eigen::Vector3d& xi);

/// F alone at a quadrature point, from the gradients the discretisation keeps; `weight` receives weight times
/// det dX/dxi.
Eigen::Matrix3d deformation_gradient(const Discretisation& discretisation, const Eigen::VectorXd& dofs,
                                     int cell, int q, double& weight);

}  // namespace brachium::fem
