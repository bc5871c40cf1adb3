#include "fem/limb/lever_arms.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include "data/model/curve.hpp"
#include "data/model/error.hpp"

namespace brachium::fem {

ResultantLeverArms lever_arms(const Hinge& hinge, const Wrench& wrench, const Eigen::Vector3d& x_s) {
  const Eigen::Vector3d &e = hinge.axis, &R = wrench.force_n;
  const LineOfAction line = line_of_action(wrench, x_s);
  ResultantLeverArms arms;
  const double about_s = e.dot((x_s - hinge.centre_m).cross(R));
  const double about_m = e.dot((line.point_m - hinge.centre_m).cross(R));
  arms.vrla_m = about_s / R.norm();
  arms.vrla_plus_m = about_m / R.norm();
  arms.moment_n_m = about_s + e.dot(wrench.moment_n_m);
  arms.moment_of_line_n_m = about_m + e.dot(line.parallel_moment_n_m);
  return arms;
}

std::vector<double> tendon_displacement_lever_arms(const std::vector<double>& q,
                                                   const std::vector<double>& length) {
  if (q.size() < 4 || q.size() != length.size()) {
    throw data::InputError(
        "too-few-states",
        fmt::format("lever arms by tendon displacement: {} angles and {} lengths", q.size(), length.size()),
        "solve the passive muscle at 4 angles at least");
  }
  const data::PiecewiseCubic spline = data::PiecewiseCubic::forsythe(q, length);
  std::vector<double> arms;
  for (const double at : q) arms.push_back(-spline(at).slope);
  return arms;
}

}  // namespace brachium::fem
