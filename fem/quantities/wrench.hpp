#pragma once
/// Force and moment that a surface exerts on the body's surroundings, from consistent nodal forces.
///
///   f_i = f_ext,i - f_int,i,   R = Σ f_i,   M = Σ (x_i - x_p) × f_i
///
/// over the surface's nodes i at deformed positions x_i. With these forces the identities of the line of
/// action (moment about any point from R, M and that line) hold to rounding on any mesh.

#include <Eigen/Core>
#include <string>

#include "fem/assembly/assembly.hpp"

namespace brachium::fem {

/// | symbol | identifier | unit | meaning                                     |
/// |--------|------------|------|---------------------------------------------|
/// | R      | force_n    | N    | resultant on the surroundings               |
/// | M      | moment_n_m | N m  | moment of the same forces about the point   |
struct Wrench {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_n_m = Eigen::Vector3d::Zero();
};

/// `internal_force`, `external_force`: by dof, global axes [N] (an empty external force is zero). `surface`:
/// a surface or node set of the mesh. Throws InputError("missing-surface").
Wrench wrench(const Discretisation& discretisation, const Configuration& configuration,
              const Eigen::VectorXd& internal_force, const Eigen::VectorXd& external_force,
              const std::string& surface, const Eigen::Vector3d& point_m);

/// The same forces seen from another point: M' = M + (x_p - x_p') × R.
Wrench moved(const Wrench& wrench, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m);

/// Line of action of a wrench taken about x_p: where the remaining moment is parallel to R.
///   x_m = x_p + R × M / |R|²,   M_par = (M · R) R / |R|²
struct LineOfAction {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d parallel_moment_n_m = Eigen::Vector3d::Zero();
};

/// Throws InputError("no-line-of-action") when the resultant vanishes.
LineOfAction line_of_action(const Wrench& wrench, const Eigen::Vector3d& point_m);

/// Mean of the deformed positions of a surface, weighted by reference area; of a node set, the mean of its
/// nodes [m].
Eigen::Vector3d barycentre(const Discretisation& discretisation, const Configuration& configuration,
                           const std::string& surface);

}  // namespace brachium::fem
