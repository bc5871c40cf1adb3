#pragma once
/// Where the forearm points, from whatever was recorded of it: orientation, points, or an angle alone.
///
/// | symbol | identifier | unit | meaning                                              |
/// |--------|------------|------|------------------------------------------------------|
/// | u      | direction  | 1    | unit vector elbow -> hand in the world frame (3 x n) |
/// | x_e    | elbow_m    | m    | elbow joint centre in the world frame (3 x n)        |
/// | z      | up         | 1    | unit vector against gravity in the world frame       |
/// | b      | long_axis  | 1    | the forearm's long axis in the segment's own frame   |

#include <Eigen/Core>
#include <span>
#include <string>

#include "data/model/signal.hpp"

namespace brachium::limb {

/// What a recorder means by its quaternion.
struct OrientationConvention {
  Eigen::Vector3d long_axis{0.0, -1.0, 0.0};  ///< b, elbow -> hand; need not be of unit length
  Eigen::Vector3d up{0.0, 0.0, 1.0};          ///< z in the world frame
  bool segment_to_world = true;               ///< the quaternion turns segment vectors into world vectors
};

struct ForearmMotion {
  double rate_hz = 0.0;
  Eigen::Matrix3Xd direction;  ///< u, 3 x n
  Eigen::Matrix3Xd elbow_m;    ///< 3 x n, or 3 x 0: the elbow does not accelerate
  Eigen::Vector3d up{0.0, 0.0, 1.0};
  std::string origin;  ///< one sentence for reports: where this came from
};

/// Signals that belong together (components of a point, of a quaternion) as the rows of a matrix. Throws
/// InputError("rates-disagree") where rate, start time or count differ, naming both signals, or
/// ("wrong-size").
Eigen::MatrixXd stacked(std::span<const data::Signal> components);

/// u = R(quaternion) b. Quaternions are 4 x n, rows x, y, z, w. Throws InputError("not-finite"),
/// ("bad-quaternion") for a norm further than 1e-3 from 1 (sample named), ("out-of-range") for a vector of no
/// length.
ForearmMotion motion_from_orientation(const Eigen::Matrix4Xd& quaternion_xyzw, double rate_hz,
                                      const OrientationConvention& convention);

/// u from the elbow to a distal point (the mean of both styloids, a hand marker), both 3 x n in m.
/// Throws InputError("not-finite") or ("wrong-size"), or ("out-of-range") where the points coincide.
ForearmMotion motion_from_points(const Eigen::Matrix3Xd& elbow_m, const Eigen::Matrix3Xd& distal_m,
                                 double rate_hz, const Eigen::Vector3d& up = {0.0, 0.0, 1.0});

/// u in a vertical plane from the flexion angle alone, with an upper arm at a fixed inclination from straight
/// down (forward positive): inclination of the forearm = inclination + q.
ForearmMotion motion_from_angle(const Eigen::VectorXd& angle_rad, double rate_hz,
                                double upper_arm_inclination_rad);

/// Angle between two directions over a trial.
struct DirectionAgreement {
  double mean_deg = 0.0;
  double rms_deg = 0.0;
  double worst_deg = 0.0;
  Eigen::Index worst_sample = 0;
};
DirectionAgreement compare_directions(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b);

/// Inclination of the upper arm that a forearm's direction and the elbow angle together imply, from straight
/// down: elevation of the forearm minus flexion. Far from constant: the upper arm moved, or angle and
/// direction disagree.
struct ImpliedInclination {
  double mean_rad = 0.0;
  double lowest_rad = 0.0;
  double highest_rad = 0.0;
};
ImpliedInclination implied_inclination(const ForearmMotion& motion, const Eigen::VectorXd& angle_rad);

/// The long axis that a recording itself shows: mean of R^T u over the trial, with its scatter.
struct LongAxisEstimate {
  Eigen::Vector3d long_axis;  ///< unit length
  double scatter_deg = 0.0;   ///< root mean square angle of single samples from it
};
LongAxisEstimate estimate_long_axis(const Eigen::Matrix4Xd& quaternion_xyzw,
                                    const Eigen::Matrix3Xd& direction, bool segment_to_world = true);

}  // namespace brachium::limb
