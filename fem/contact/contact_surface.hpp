#pragma once
/// Frictionless contact of a body's surface with a rigid body.
///
/// | symbol  | meaning                                                                             | unit |
/// |---------|-------------------------------------------------------------------------------------|------|
/// | g       | gap: signed distance of a surface point from the rigid body                         | m    |
/// | eps     | penalty                                                                             | Pa/m |
/// | lambda  | multiplier of augmented Lagrange, >= 0, at the quadrature points                     | Pa   |
/// | t       | contact pressure per reference area                                                 | Pa   |
/// | w       | width over which <.> is smoothed                                                    | m    |
///
///   energy   Pi = int phi(g) dA,  t = -dphi/dg          (dA the reference area, so that contact has a
///   potential) penalty  t = eps <-g>,  with a width w > 0: eps (w/2 - g)^2 / (2 w) where |g| < w/2 Uzawa t =
///   <lambda - eps g>,  lambda <- t until the penetration is below its tolerance force on the surface  f_a =
///   int N_a t grad g dA tangent  df_a/du_b = - int N_a N_b (-dt/dg grad g (x) grad g - t Hess g) dA
///   (symmetric)
/// (Wriggers 2006, doi:10.1007/978-3-540-32609-0, chapters 6 and 9.)

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/assembly/discretisation.hpp"
#include "fem/assembly/surface_load.hpp"
#include "fem/contact/distance.hpp"

namespace brachium::fem {

struct ContactOptions {
  double penalty_pa_per_m = 0.0;  ///< eps > 0
  double smoothing_m = 0.0;       ///< w >= 0; with multipliers it must be 0
  int points_per_direction =
      4;  ///< quadrature on quadrilaterals, 1 to 5; triangles are cut into its square of parts
};

struct ContactSums {
  double energy_j = 0.0;                                 ///< Pi (with multipliers: of the augmented function)
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();     ///< on the surface
  Eigen::Vector3d moment_n_m = Eigen::Vector3d::Zero();  ///< on the surface, about the origin
  double greatest_penetration_m = 0.0;                   ///< max of -g where t > 0
  double greatest_pressure_pa = 0.0;
  double area_m2 = 0.0;  ///< reference area that is pressed
  long active_points = 0, points = 0;
};

/// State of every quadrature point, for pictures and multipliers.
struct ContactPoints {
  Eigen::Matrix3Xd position_m;  ///< deformed
  Eigen::VectorXd gap_m, pressure_pa, area_m2;
};

/// Pressure at the points of the mesh, for pictures: each takes the mean over its share of the faces,
/// N_a^2 / sum N_b^2 of it, so that it is never negative and the sum of area x pressure is the integral of t.
struct NodalPressure {
  Eigen::VectorXd pressure_pa, area_m2;  ///< by point of the mesh; 0 off the surface
};

class ContactSurface {
 public:
  /// Throws InputError("missing-surface"), ("contact-option").
  ContactSurface(const Discretisation& discretisation, const std::string& surface, RigidShape shape,
                 ContactOptions options);

  int point_count() const { return static_cast<int>(weight_.size()); }
  const RigidShape& shape() const { return shape_; }

  /// force += contact forces by dof [N] at displacements `dofs` [m], the rigid body at `pose`;
  /// `multiplier_pa` by point, empty: none.
  ContactSums add_force(const Eigen::VectorXd& dofs, const Pose& pose, const Eigen::VectorXd& multiplier_pa,
                        Eigen::VectorXd& force) const;

  /// d(force)/du of the faces that are pressed.
  std::vector<FaceTangent> tangent(const Eigen::VectorXd& dofs, const Pose& pose,
                                   const Eigen::VectorXd& multiplier_pa) const;

  ContactPoints points(const Eigen::VectorXd& dofs, const Pose& pose,
                       const Eigen::VectorXd& multiplier_pa) const;

  NodalPressure at_mesh_points(const Eigen::VectorXd& dofs, const Pose& pose,
                               const Eigen::VectorXd& multiplier_pa) const;

  /// Which points press, one bit a point: a Newton iteration has converged only where it no longer changes.
  std::vector<char> active_set(const Eigen::VectorXd& dofs, const Pose& pose,
                               const Eigen::VectorXd& multiplier_pa) const;

  /// Least gap over the surface's quadrature points [m]: whether bodies can touch at all.
  double least_gap_m(const Eigen::VectorXd& dofs, const Pose& pose) const;

 private:
  struct Pressure {
    double energy, pressure, slope;  ///< phi, t, dt/dg
  };
  Pressure pressure(double gap, double multiplier) const;
  Eigen::Vector3d position(int face, int q, const Eigen::VectorXd& dofs) const;

  const Discretisation* discretisation_;
  RigidShape shape_;
  ContactOptions options_;
  Eigen::MatrixXi faces_;               ///< nodes per face x faces
  std::vector<Eigen::VectorXd> value_;  ///< N by quadrature point of a face
  Eigen::VectorXd weight_;              ///< reference area by point: q + n_q face
};

}  // namespace brachium::fem
