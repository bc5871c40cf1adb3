#include "data/limb/inverse_dynamics.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "data/limb/smoothing.hpp"
#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using Eigen::Index;

// The first-order share of every uncertain number, as coefficients of A and B.
std::vector<MomentContributor> contributors_of(const BodySet& set) {
  std::vector<MomentContributor> out;
  const auto add = [&out](std::string name, double alpha, double beta) {
    if (alpha != 0.0 || beta != 0.0) out.push_back({std::move(name), alpha, beta, 0.0});
  };
  double body_alpha = 0.0, body_beta = 0.0;  // the body mass moves all fractions of it together
  for (const Body& b : set.bodies) {
    const double s = b.mass_kg * b.distance_m;
    // A segment's own inertia grows with its mass: it comes from a radius of gyration.
    const double i = b.inertia_kg_m2 + s * b.distance_m;
    add("mass of " + b.name, b.mass_relative_sd * s, b.mass_relative_sd * i);
    add("distance of " + b.name, b.distance_sd_m * b.mass_kg, b.distance_sd_m * 2.0 * s);
    add("inertia of " + b.name, 0.0, b.inertia_relative_sd * b.inertia_kg_m2);
    if (b.from_body_mass) {
      body_alpha += set.body_mass_relative_sd * s;
      body_beta += set.body_mass_relative_sd * i;
    }
  }
  add("body mass", body_alpha, body_beta);
  return out;
}

// The horizontal direction in which the forearm mostly points over a trial.
Eigen::Vector3d mean_forward(const Eigen::Matrix3Xd& horizontal) {
  const Eigen::Vector3d sum = horizontal.rowwise().sum();
  if (!(sum.norm() > 1e-6 * static_cast<double>(horizontal.cols()))) {
    throw data::InputError(
        "no-forward-direction",
        "the forearm points forward and backward alike over the trial: its plane of flexion is not known",
        "give the motion as an angle with a fixed upper arm");
  }
  return sum.normalized();
}

// Horizontal unit vectors in the forearm's vertical plane, held by the mean plane near the vertical (see the
// header).
Eigen::Matrix3Xd forward_of(const Eigen::Matrix3Xd& horizontal, const Eigen::Vector3d& mean) {
  constexpr double hold = 0.05;
  Eigen::Matrix3Xd h(3, horizontal.cols());
  for (Index i = 0; i < h.cols(); ++i) {
    const Eigen::Vector3d part = horizontal.col(i);
    h.col(i) = (part.dot(mean) * part + hold * mean).normalized();
  }
  return h;
}

}  // namespace

JointMoment inverse_dynamics_moment(const ForearmMotion& motion, const BodySet& bodies,
                                    const InverseDynamicsOptions& options) {
  const Index n = motion.direction.cols();
  const bool moving = options.use_elbow_acceleration && motion.elbow_m.cols() > 0;
  if (moving && motion.elbow_m.cols() != n) {
    throw data::InputError(
        "wrong-size",
        fmt::format("{} directions of the forearm but {} positions of the elbow", n, motion.elbow_m.cols()));
  }
  const Smoothing smoothing{options.cutoff_hz, motion.rate_hz};
  Eigen::Matrix3Xd u = smooth_rows(motion.direction, smoothing, "the forearm's direction");
  u.colwise().normalize();
  const auto twice = [&](const Eigen::Matrix3Xd& x) -> Eigen::Matrix3Xd {
    return derivative_rows(derivative_rows(x, motion.rate_hz), motion.rate_hz);
  };
  const Eigen::Matrix3Xd udd = twice(u);
  Eigen::Matrix3Xd elbow = Eigen::Matrix3Xd::Zero(3, n);
  if (moving) elbow = twice(smooth_rows(motion.elbow_m, smoothing, "the elbow's position"));
  if (!(options.max_plane_deviation_rad > 0.0)) {
    throw data::InputError("out-of-range",
                           fmt::format("the largest deviation from the plane must be greater than 0, not {}",
                                       options.max_plane_deviation_rad));
  }
  const Eigen::Matrix3Xd horizontal = u - motion.up * (motion.up.transpose() * u);
  const Eigen::Vector3d mean = mean_forward(horizontal), sideways = mean.cross(motion.up);
  const Eigen::Matrix3Xd h = forward_of(horizontal, mean);

  JointMoment out;
  out.first_moment_kg_m = bodies.first_moment_kg_m();
  out.inertia_kg_m2 = bodies.inertia_kg_m2();
  out.edge_samples = static_cast<Index>(std::min(smoothing.edge_samples(), static_cast<std::size_t>(n)));
  out.contributors = contributors_of(bodies);
  for (auto* v : {&out.moment_N_m, &out.gravity_part_N_m, &out.inertial_part_N_m, &out.elbow_part_N_m,
                  &out.elevation_rad, &out.sd_N_m, &out.plane_deviation_rad, &out.usable}) {
    v->resize(n);
  }
  const double S = out.first_moment_kg_m, I = out.inertia_kg_m2;
  for (Index i = 0; i < n; ++i) {
    const Eigen::Vector3d at = u.col(i);
    const Eigen::Vector3d axis = Eigen::Vector3d(h.col(i)).cross(motion.up);
    const double B = axis.dot(at.cross(Eigen::Vector3d(udd.col(i))));
    const double from_elbow = axis.dot(at.cross(Eigen::Vector3d(elbow.col(i))));
    const double from_gravity = axis.dot(at.cross(standard_gravity_m_per_s2 * motion.up));
    out.gravity_part_N_m(i) = S * from_gravity;
    out.elbow_part_N_m(i) = S * from_elbow;
    out.inertial_part_N_m(i) = I * B;
    out.moment_N_m(i) = out.gravity_part_N_m(i) + out.elbow_part_N_m(i) + out.inertial_part_N_m(i);
    out.elevation_rad(i) = std::atan2(at.dot(Eigen::Vector3d(h.col(i))), -at.dot(motion.up));
    out.plane_deviation_rad(i) =
        std::asin(std::clamp(at.dot(sideways), -1.0, 1.0));  // a product of unit vectors, to rounding
    const bool in_plane = std::abs(out.plane_deviation_rad(i)) <= options.max_plane_deviation_rad;
    out.out_of_plane_samples += in_plane ? 0 : 1;
    out.usable(i) = in_plane && i >= out.edge_samples && i < n - out.edge_samples ? 1.0 : 0.0;
    double variance = 0.0;
    for (MomentContributor& c : out.contributors) {
      const double share = c.alpha_kg_m * (from_gravity + from_elbow) + c.beta_kg_m2 * B;
      variance += share * share;
      c.rms_sd_N_m += share * share / static_cast<double>(n);
    }
    out.sd_N_m(i) = std::sqrt(variance);
  }
  for (MomentContributor& c : out.contributors) c.rms_sd_N_m = std::sqrt(c.rms_sd_N_m);
  std::stable_sort(out.contributors.begin(), out.contributors.end(),
                   [](const auto& a, const auto& b) { return a.rms_sd_N_m > b.rms_sd_N_m; });
  return out;
}

data::Table contributor_table(const JointMoment& moment) {
  std::vector<std::string> names;
  std::vector<double> shares, relative;
  const double rms = std::sqrt(moment.moment_N_m.squaredNorm() /
                               static_cast<double>(std::max<Index>(1, moment.moment_N_m.size())));
  for (const MomentContributor& c : moment.contributors) {
    names.push_back(c.name);
    shares.push_back(c.rms_sd_N_m);
    relative.push_back(rms > 0.0 ? 100.0 * c.rms_sd_N_m / rms : 0.0);
  }
  return {"Uncertainty of the moment, by what was assumed",
          {{"assumed number", "", std::move(names)},
           {"standard uncertainty", "N m", std::move(shares)},
           {"of the moment", "%", std::move(relative)}}};
}

}  // namespace brachium::limb
