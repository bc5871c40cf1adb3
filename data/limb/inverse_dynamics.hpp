#pragma once
/// The elbow moment that a recorded motion needs, and the uncertainty that assumed masses bring.
///
/// | symbol | identifier           | unit    | meaning                                                             |
/// |--------|----------------------|---------|---------------------------------------------------------------------|
/// | u      | direction            | 1       | elbow -> hand, unit vector in the world frame                       |
/// | n      | axis                 | 1       | flexion axis in the world frame, flexion positive                   |
/// | S, I   | -                    | kg m, kg m^2 | sum m d and sum (I_c + m d^2) of forearm, hand and load        |
/// | a, g   | -                    | m/s^2   | acceleration of the elbow; free fall                                |
/// | theta  | elevation_rad        | rad     | inclination of u from straight down, positive forward               |
/// | M      | moment_N_m           | N m     | muscle moment, flexion positive                                     |
/// | A, B   | -                    | m/s^2, 1/s^2 | A = n . (u x (a - g)),  B = n . (u x u'')                      |
///
/// Angular momentum about the moving elbow, for bodies along one line (their rotation about that line, and forces
/// of the forearm's own twist, are left out):
///   M = n . [ I u x u'' + S u x (a - g) ] = I B + S A       (Winter 2009, ch. 5; Zatsiorsky 2002, ch. 5)
/// The hinge's axis is not recorded: n is taken horizontal and perpendicular to the vertical plane of the forearm.
/// Near the vertical, where that plane is lost, it is held by the trial's mean plane:
///   n = h x up,   h ~ (u_h . h_mean) u_h + 0.05 h_mean,   u_h the horizontal part of u.
/// The product makes h continuous and forward also where the forearm passes the vertical or hangs sideways.
///
/// M is linear in m_i and I_ci and polynomial in d_i, so first-order propagation over independent x_k gives
///   sd(M)^2 = sum_k (alpha_k A + beta_k B)^2,   alpha_k = sd_k dS/dx_k,  beta_k = sd_k dI/dx_k.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "data/limb/bodies.hpp"
#include "data/limb/forearm_motion.hpp"
#include "data/model/table.hpp"

namespace brachium::limb {

struct InverseDynamicsOptions {
  double cutoff_hz = 3.0;              ///< low-pass of the motion, see data/limb/smoothing.hpp
  bool use_elbow_acceleration = true;  ///< where the elbow's trajectory is known
  /// Further than this out of the trial's mean plane (15 deg), the subject turned or reached sideways: the
  /// flexion axis is then not known, and `usable` says so.
  double max_plane_deviation_rad = 0.26;
};

/// One source of uncertainty: its share of M at each instant is alpha A + beta B.
struct MomentContributor {
  std::string name;  ///< "mass of forearm", "body mass", "distance of dumbbell", ...
  double alpha_kg_m = 0.0;
  double beta_kg_m2 = 0.0;
  double rms_sd_N_m = 0.0;  ///< root mean square over the trial
};

struct JointMoment {
  Eigen::VectorXd moment_N_m;         ///< M
  Eigen::VectorXd gravity_part_N_m;   ///< S n . (u x -g): what holding still would need
  Eigen::VectorXd inertial_part_N_m;  ///< I B
  Eigen::VectorXd elbow_part_N_m;     ///< S n . (u x a)
  Eigen::VectorXd elevation_rad;
  Eigen::VectorXd plane_deviation_rad;  ///< of u from the trial's mean vertical plane, signed
  Eigen::VectorXd usable;  ///< 1, or 0 at the edges and out of the plane; fits should leave those out
  Eigen::Index out_of_plane_samples = 0;
  Eigen::VectorXd sd_N_m;  ///< standard uncertainty of M from masses, distances and inertias
  std::vector<MomentContributor> contributors;  ///< largest first
  double first_moment_kg_m = 0.0;               ///< S
  double inertia_kg_m2 = 0.0;                   ///< I
  Eigen::Index edge_samples = 0;  ///< at each end, where smoothing leans on the record's continuation
};

/// Throws InputError as smooth() does, "wrong-size" if direction and elbow differ in length,
/// "no-forward-direction" if the trial has no mean plane, "out-of-range" for a plane deviation that is not
/// above 0.
JointMoment inverse_dynamics_moment(const ForearmMotion& motion, const BodySet& bodies,
                                    const InverseDynamicsOptions& options);

/// The contributors as a table: name, root mean square share [N m], and that share relative to the moment's
/// [%].
data::Table contributor_table(const JointMoment& moment);

}  // namespace brachium::limb
