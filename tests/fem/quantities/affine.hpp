#pragma once
/// Affinely deformed boxes: what quantities say of them is known.

#include <Eigen/LU>

#include "fem/quantities/quantities.hpp"
#include "tests/fem/verification/box_mesh.hpp"

namespace brachium::fem::affine {

inline Eigen::Matrix3d gradient() {
  Eigen::Matrix3d F;
  F << 1.2, 0.1, -0.05, 0.03, 0.9, 0.08, -0.1, 0.02, 1.05;
  return F;
}

/// u = (F - 1) X + shift at every node.
inline Configuration configuration(const Discretisation& discretisation, const Eigen::Matrix3d& F,
                                   const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
  Configuration c;
  c.dofs = Eigen::VectorXd::Zero(discretisation.dof_count());
  for (int i = 0; i < discretisation.mesh().point_count(); ++i) {
    c.dofs.segment<3>(3 * i) =
        (F - Eigen::Matrix3d::Identity()) * discretisation.mesh().points.col(i) + shift;
  }
  c.activation = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(discretisation.mesh().regions.size()));
  return c;
}

inline const std::vector<Formulation>& formulations() {
  static const std::vector<Formulation> list{Formulation::q2_p1_discontinuous, Formulation::q1_p0,
                                             Formulation::p2_p1_taylor_hood,
                                             Formulation::p2b_p1_discontinuous};
  return list;
}

}  // namespace brachium::fem::affine
