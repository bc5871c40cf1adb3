#pragma once
/// Lever arms of a muscle about a hinge, by three definitions, from what a solved state gives.
///
///   VRLA   l = e . ((x_s - x_J) x R) / |R|
///   VRLA+  l = e . ((x_m - x_J) x R) / |R|,   x_m = x_s + R x M / |R|^2   (the line of action)
///   TDM    l = -dL/dq, of the passive lengths over the range            (An et al. 1984,
///   doi:10.1115/1.3138494) identity   e . [(x_s - x_J) x R + M] = e . [(x_m - x_J) x R + M_par] = e . sum
///   (x_i - x_J) x f_i
///
/// | symbol | identifier   | unit | meaning                                                       |
/// |--------|--------------|------|---------------------------------------------------------------|
/// | e, x_J | hinge        | 1, m | unit axis, a point on it                                      |
/// | x_s    | point_m      | m    | barycentre of the attachment                                  |
/// | R, M   | wrench       |      | force on the attachment [N], its moment about x_s [N m]       |
/// Signs: flexion positive.

#include <vector>

#include "fem/quantities/wrench.hpp"

namespace brachium::fem {

struct Hinge {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< unit, flexion positive
};

struct ResultantLeverArms {
  double vrla_m = 0.0, vrla_plus_m = 0.0;
  double moment_n_m = 0.0;          ///< about the hinge, from R and M at x_s
  double moment_of_line_n_m = 0.0;  ///< the same from the line of action: equal to rounding
};

/// Throws InputError("no-line-of-action") when the resultant vanishes.
ResultantLeverArms lever_arms(const Hinge& hinge, const Wrench& wrench, const Eigen::Vector3d& point_m);

/// -dL/dq at rising angles: the slopes of the twice differentiable spline through the lengths. At least 4
/// states; throws InputError("too-few-states").
std::vector<double> tendon_displacement_lever_arms(const std::vector<double>& q_rad,
                                                   const std::vector<double>& length_m);

}  // namespace brachium::fem
