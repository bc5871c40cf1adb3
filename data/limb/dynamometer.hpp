#pragma once
/// From a dynamometer's record to the moment of the muscles about the joint.
///
/// | symbol   | identifier | unit   | meaning                                                                       |
/// |----------|------------|--------|-------------------------------------------------------------------------------|
/// | theta, T | -          | rad, N m | the machine's angle and torque, as recorded                                 |
/// | q        | angle_rad  | rad    | joint angle, flexion positive, 0 = straight                                   |
/// | T_l      | torque_N_m | N m    | torque that limb and machine arm exert on the machine, flexion positive       |
/// | G, G_m   | gravity    | N m    | moment of gravity on the limb, on the machine's arm, flexion positive         |
/// | I, I_m   | inertia    | kg m^2 | of the limb about the joint, of the machine's arm about its axis              |
/// | M        | moment_N_m | N m    | moment of the muscles, flexion positive                                       |
/// | e, l     | -          | m      | joint centre from the machine's axis; machine axis to pad                     |
///
/// Equation of motion of limb and machine arm on one axis, (I + I_m) q'' = M + G + G_m - T_l, hence
/// M = T_l - G - G_m + (I + I_m) q''
/// (Winter, Wells & Orr 1981, Eur J Appl Physiol 46; Herzog 1988, J Biomech 21: gravity and inertia are what sets the
/// machine's torque apart from the joint's moment, next to a limb that gives way in its straps, which is not modelled).
/// Passive tissue is part of M where G is computed from masses, and part of G where G is fitted to a passive sweep.

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "data/limb/bodies.hpp"

namespace brachium::limb {

/// What the machine's numbers mean, as the user declares it. Units are converted to SI when the file is read.
///   q = angle_sign (theta - angle_zero),   T_l = torque_sign (T - torque_zero),   q' = angle_sign theta'
struct DynamometerLayout {
  int angle_sign = 1;           ///< +1: the machine's angle grows with flexion; -1 otherwise
  double angle_zero_rad = 0.0;  ///< machine angle at which the joint is straight
  int torque_sign = 1;          ///< +1: the machine's torque is positive when the limb pushes towards flexion
  double torque_zero_N_m = 0.0;  ///< machine torque with nothing attached
};

/// A record in joint terms.
struct DynamometerRecord {
  double rate_hz = 0.0;
  Eigen::VectorXd angle_rad;           ///< q
  Eigen::VectorXd velocity_rad_per_s;  ///< q', from the machine, or differentiated from the smoothed angle
  Eigen::VectorXd acceleration_rad_per_s2;
  Eigen::VectorXd torque_N_m;  ///< T_l
  bool velocity_measured = false;
  Eigen::Index edge_samples = 0;  ///< at each end, where smoothing leans on the record's continuation
};

/// `velocity` may be empty: then the angle is smoothed at `cutoff_hz` and differentiated. The acceleration is
/// always a derivative of the smoothed angle or velocity. Throws InputError: "wrong-size", "not-finite",
/// "bad-layout" for a sign that is not +-1, and what smooth() throws.
DynamometerRecord joint_record(std::span<const double> angle, std::span<const double> velocity,
                               std::span<const double> torque, double rate_hz,
                               const DynamometerLayout& layout, double cutoff_hz);

// ---------------------------------------------------------------- gravity

/// G(q) = c cos q + s sin q + o, flexion positive [N m].
struct GravityModel {
  double cos_N_m = 0.0;
  double sin_N_m = 0.0;
  double offset_N_m = 0.0;
  double rms_residual_N_m = 0.0;  ///< of the fit; 0 where computed
  double worst_residual_N_m = 0.0;
  double worst_angle_rad = 0.0;
  double condition_number = 1.0;  ///< of the fit's scaled columns; large where the sweep is too short
  std::size_t samples = 0;
  std::string origin;  ///< one sentence for reports

  double operator()(double q_rad) const;
};

struct PassiveSweepOptions {
  double max_speed_rad_per_s = 0.35;  ///< samples faster than that are not used (20 deg/s)
  double min_range_rad = 0.70;        ///< a shorter sweep cannot tell the three terms apart (40 deg)
  bool fit_offset = true;             ///< false: o = 0, for a machine whose zero is trusted
};

/// Fits G to a slow sweep of the relaxed limb: there M = 0 and T_l = G(q). Sweeps in both directions average
/// friction out. Throws InputError("short-sweep") naming range and need, or ("too-few-samples").
GravityModel fit_gravity(const DynamometerRecord& passive, const PassiveSweepOptions& options = {});

/// G(q) = -S g sin(q + inclination) of a first moment S, in a vertical plane, with the upper arm inclined from straight
/// down: of the limb's own masses (passive tissue is not part of it) or of the machine's arm.
GravityModel gravity_from_limb(const BodySet& limb, double upper_arm_inclination_rad);
GravityModel gravity_from_machine_arm(double first_moment_kg_m, double upper_arm_inclination_rad);

// ---------------------------------------------------------------- axis

/// Joint centre beside the machine's axis. The pad passes on a force F normal to the machine's arm, so T_l =
/// l F, and about the joint  M = T_l (1 - (e . r) / l),  with r the unit vector along the machine's arm.
/// Friction along the arm is not seen by the machine and is left out. The joint then turns by  dq = -(e . t)
/// / l  more than the machine, t = dr/dq; both are first order in |e| / l, the next term is (|e| / l)^2 / 2.
struct AxisOffset {
  double along_m = 0.0;         ///< e along the machine's arm at q = 0, towards the hand
  double across_m = 0.0;        ///< e across it, towards the side to which flexion turns
  double sd_m = 0.0;            ///< standard uncertainty of either component
  double pad_distance_m = 0.0;  ///< l > 0; 0: no correction

  double moment_factor(double q_rad) const;         ///< M / T_l
  double angle_correction_rad(double q_rad) const;  ///< joint angle minus machine angle
  double angle_rate(double q_rad) const;            ///< d(joint angle)/d(machine angle) = 1 + (e . r) / l
  double angle_curvature(double q_rad) const;       ///< its derivative, (e . t) / l
  double moment_relative_sd() const;                ///< sd / l
};

// ---------------------------------------------------------------- moment

/// What weighs and turns without the muscles: the limb beyond the pad at the joint's angle, the machine's arm at the
/// machine's. What a passive sweep shows is the machine's: it was measured there.
struct PassiveLoad {
  GravityModel gravity;
  double inertia_kg_m2 = 0.0;  ///< 0 leaves the term out: exclude the ramps then
};

struct DynamometerMoment {
  Eigen::VectorXd angle_rad;           ///< q, joint angle: the machine's q_m corrected for the axis
  Eigen::VectorXd velocity_rad_per_s;  ///< q'
  Eigen::VectorXd moment_N_m;          ///< M
  Eigen::VectorXd gravity_N_m;         ///< both loads' weight about the joint
  Eigen::VectorXd inertial_N_m;        ///< and their inertia
  Eigen::VectorXd sd_N_m;              ///< from the axis' uncertainty and the gravity fit's residual
  Eigen::Index edge_samples = 0;
};

/// M = (1 - (e . r) / l) (T_l - G_m(q_m) + I_m q_m'') - G(q) + I q''.
DynamometerMoment dynamometer_moment(const DynamometerRecord& record, const PassiveLoad& limb,
                                     const PassiveLoad& machine, const AxisOffset& axis = {});

// ---------------------------------------------------------------- phases

/// Samples [first, last) of one kind.
struct Phase {
  Eigen::Index first = 0;
  Eigen::Index last = 0;
  double mean = 0.0;  ///< velocity [rad/s] of an isokinetic phase, torque [N m] of a hold
  double sd = 0.0;
};

struct IsokineticOptions {
  double speed_rad_per_s = 0.0;      ///< set speed > 0
  double relative_tolerance = 0.05;  ///< |q'| within this of the set speed
  double min_duration_s = 0.10;
};

/// Stretches of constant velocity, ramps excluded; `mean` tells the direction. None found is a result.
std::vector<Phase> isokinetic_phases(const DynamometerRecord& record, const IsokineticOptions& options);

struct HoldOptions {
  double max_speed_rad_per_s = 0.05;  ///< the joint stands still
  double relative_tolerance = 0.05;   ///< torque within +- this share of the stretch's mid-range
  double min_torque_N_m = 1.0;        ///< below, the limb is at rest
  double min_duration_s = 1.0;
};

/// Isometric holds: longest stretches of steady torque, from left to right. None found is a result.
std::vector<Phase> isometric_holds(const DynamometerRecord& record, const HoldOptions& options);

/// 1 inside the phases, 0 outside: the mask that a calibration uses.
Eigen::VectorXd phase_mask(const std::vector<Phase>& phases, Eigen::Index count);

}  // namespace brachium::limb
