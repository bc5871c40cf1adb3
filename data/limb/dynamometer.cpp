#include "data/limb/dynamometer.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/limb/smoothing.hpp"
#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using data::InputError;
using Eigen::Index;
using Eigen::VectorXd;

constexpr double degrees = 180.0 / std::numbers::pi;

VectorXd converted(std::span<const double> samples, int sign, double zero, const char* what) {
  VectorXd out(static_cast<Index>(samples.size()));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!std::isfinite(samples[i])) {
      throw InputError("not-finite",
                       fmt::format("the dynamometer's {} is not a finite number at sample {}", what, i),
                       "fill or cut the gap before");
    }
    out(static_cast<Index>(i)) = sign * (samples[i] - zero);
  }
  return out;
}

void require_sign(int sign, const char* what) {
  if (sign != 1 && sign != -1)
    throw InputError("bad-layout",
                     fmt::format("the dynamometer's {} sign must be 1 or -1, not {}", what, sign));
}

}  // namespace

DynamometerRecord joint_record(std::span<const double> angle, std::span<const double> velocity,
                               std::span<const double> torque, double rate_hz,
                               const DynamometerLayout& layout, double cutoff_hz) {
  require_sign(layout.angle_sign, "angle");
  require_sign(layout.torque_sign, "torque");
  if (torque.size() != angle.size() || (!velocity.empty() && velocity.size() != angle.size())) {
    throw InputError("wrong-size",
                     fmt::format("the dynamometer's record has {} angles, {} velocities and {} torques",
                                 angle.size(), velocity.size(), torque.size()));
  }
  if (!std::isfinite(layout.angle_zero_rad) || !std::isfinite(layout.torque_zero_N_m)) {
    throw InputError("bad-layout", "the dynamometer's zeros must be finite numbers");
  }
  DynamometerRecord r;
  r.rate_hz = rate_hz;
  r.angle_rad = converted(angle, layout.angle_sign, layout.angle_zero_rad, "angle");
  r.torque_N_m = converted(torque, layout.torque_sign, layout.torque_zero_N_m, "torque");
  const Smoothing smoothing{cutoff_hz, rate_hz};
  if (velocity.empty()) {
    const Eigen::MatrixXd smoothed =
        smooth_rows(r.angle_rad.transpose(), smoothing, "the dynamometer's angle");
    r.velocity_rad_per_s = derivative_rows(smoothed, rate_hz).transpose();
    r.acceleration_rad_per_s2 = derivative_rows(r.velocity_rad_per_s.transpose(), rate_hz).transpose();
  } else {
    r.velocity_measured = true;
    r.velocity_rad_per_s = converted(velocity, layout.angle_sign, 0.0, "velocity");
    const Eigen::MatrixXd smoothed =
        smooth_rows(r.velocity_rad_per_s.transpose(), smoothing, "the dynamometer's velocity");
    r.acceleration_rad_per_s2 = derivative_rows(smoothed, rate_hz).transpose();
  }
  r.edge_samples = std::min(static_cast<Index>(smoothing.edge_samples()), r.angle_rad.size());
  return r;
}

double GravityModel::operator()(double q) const {
  return cos_N_m * std::cos(q) + sin_N_m * std::sin(q) + offset_N_m;
}

GravityModel fit_gravity(const DynamometerRecord& passive, const PassiveSweepOptions& options) {
  std::vector<Index> used;
  double lowest = 0.0, highest = 0.0;
  for (Index i = passive.edge_samples; i < passive.angle_rad.size() - passive.edge_samples; ++i) {
    if (!(std::abs(passive.velocity_rad_per_s(i)) <= options.max_speed_rad_per_s)) continue;
    const double q = passive.angle_rad(i);
    lowest = used.empty() ? q : std::min(lowest, q);
    highest = used.empty() ? q : std::max(highest, q);
    used.push_back(i);
  }
  if (used.size() < 10) {
    throw InputError(
        "too-few-samples",
        fmt::format("the passive sweep has {} samples slower than {:.3g} deg/s; the gravity fit needs 10",
                    used.size(), options.max_speed_rad_per_s * degrees),
        "record a slower sweep, or allow a higher speed");
  }
  if (!(highest - lowest >= options.min_range_rad)) {
    throw InputError(
        "short-sweep",
        fmt::format(
            "the passive sweep covers {:.3g} deg ({:.4g} to {:.4g}); the gravity fit needs {:.3g} deg",
            (highest - lowest) * degrees, lowest * degrees, highest * degrees,
            options.min_range_rad * degrees),
        "record a longer sweep, or take gravity from the limb's inertia");
  }
  const Index terms = options.fit_offset ? 3 : 2;
  const auto n = static_cast<Index>(used.size());
  Eigen::MatrixXd a(n, terms);
  VectorXd t(n);
  for (Index k = 0; k < n; ++k) {
    const double q = passive.angle_rad(used[static_cast<std::size_t>(k)]);
    a(k, 0) = std::cos(q);
    a(k, 1) = std::sin(q);
    if (terms == 3) a(k, 2) = 1.0;
    t(k) = passive.torque_N_m(used[static_cast<std::size_t>(k)]);
  }
  const VectorXd x = a.colPivHouseholderQr().solve(t);
  const VectorXd residual = t - a * x;
  const Eigen::MatrixXd scaled = a * a.colwise().norm().cwiseInverse().asDiagonal();
  // Singular values of the tall matrix from its small normal matrix: good enough for a figure that warns.
  const VectorXd squares =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled.transpose() * scaled).eigenvalues();
  GravityModel g;
  g.cos_N_m = x(0);
  g.sin_N_m = x(1);
  g.offset_N_m = terms == 3 ? x(2) : 0.0;
  g.samples = used.size();
  g.rms_residual_N_m = std::sqrt(residual.squaredNorm() / static_cast<double>(n));
  Index worst = 0;
  g.worst_residual_N_m = residual.cwiseAbs().maxCoeff(&worst);
  g.worst_angle_rad = passive.angle_rad(used[static_cast<std::size_t>(worst)]);
  g.condition_number = std::sqrt(squares(terms - 1) / std::max(squares(0), 1e-300));
  g.origin = fmt::format(
      "fitted to a passive sweep from {:.4g} to {:.4g} deg, rms residual {:.3g} N m (passive tissue "
      "included)",
      lowest * degrees, highest * degrees, g.rms_residual_N_m);
  return g;
}

namespace {

GravityModel gravity_of(double first_moment, double inclination, const std::string& of) {
  if (!std::isfinite(first_moment) || !std::isfinite(inclination))
    throw InputError("not-finite",
                     fmt::format("the first moment of {} or the upper arm's inclination is not finite", of));
  const double weight = first_moment * standard_gravity_m_per_s2;
  GravityModel g;
  g.cos_N_m = -weight * std::sin(inclination);
  g.sin_N_m = -weight * std::cos(inclination);
  g.origin = fmt::format(
      "computed from the masses of {}, upper arm {:.4g} deg from vertical (passive tissue not included)", of,
      inclination * degrees);
  return g;
}

}  // namespace

GravityModel gravity_from_limb(const BodySet& limb, double inclination) {
  return gravity_of(limb.first_moment_kg_m(), inclination, "the limb");
}

GravityModel gravity_from_machine_arm(double first_moment, double inclination) {
  return gravity_of(first_moment, inclination, "the machine's arm");
}

double AxisOffset::moment_factor(double q) const {
  if (pad_distance_m == 0.0) return 1.0;
  return 1.0 - (along_m * std::cos(q) + across_m * std::sin(q)) / pad_distance_m;
}

double AxisOffset::angle_correction_rad(double q) const {
  if (pad_distance_m == 0.0) return 0.0;
  return (along_m * std::sin(q) - across_m * std::cos(q)) / pad_distance_m;
}

double AxisOffset::angle_rate(double q) const {
  return 2.0 - moment_factor(q);
}

double AxisOffset::angle_curvature(double q) const {
  return -angle_correction_rad(q);
}

double AxisOffset::moment_relative_sd() const {
  return pad_distance_m == 0.0 ? 0.0 : sd_m / pad_distance_m;
}

DynamometerMoment dynamometer_moment(const DynamometerRecord& record, const PassiveLoad& limb,
                                     const PassiveLoad& machine, const AxisOffset& axis) {
  for (const double inertia : {limb.inertia_kg_m2, machine.inertia_kg_m2}) {
    if (!(inertia >= 0.0))
      throw InputError("out-of-range",
                       fmt::format("the inertia must be 0 kg m^2 or greater, not {}", inertia));
  }
  if (!(axis.pad_distance_m >= 0.0) || !(axis.sd_m >= 0.0) || !std::isfinite(axis.along_m) ||
      !std::isfinite(axis.across_m)) {
    throw InputError(
        "out-of-range",
        "the axis offset needs finite components, and pad distance and uncertainty of 0 m or greater");
  }
  const bool uncertain = axis.along_m != 0.0 || axis.across_m != 0.0 || axis.sd_m != 0.0;
  if (uncertain && axis.pad_distance_m == 0.0) {
    throw InputError("missing-key", "an axis offset needs the distance from the machine's axis to the pad");
  }
  if (uncertain && !(std::hypot(axis.along_m, axis.across_m) < 0.3 * axis.pad_distance_m)) {
    throw InputError(
        "out-of-range",
        fmt::format("the joint lies {:.3g} mm beside the machine's axis, too far for a first-order "
                    "correction at a pad distance of {:.3g} mm",
                    std::hypot(axis.along_m, axis.across_m) * 1e3, axis.pad_distance_m * 1e3));
  }
  const Index n = record.angle_rad.size();
  DynamometerMoment m;
  m.edge_samples = record.edge_samples;
  for (VectorXd* v :
       {&m.angle_rad, &m.velocity_rad_per_s, &m.moment_N_m, &m.gravity_N_m, &m.inertial_N_m, &m.sd_N_m})
    v->resize(n);
  const double residual = std::hypot(limb.gravity.rms_residual_N_m, machine.gravity.rms_residual_N_m);
  for (Index i = 0; i < n; ++i) {
    const double q = record.angle_rad(i), speed = record.velocity_rad_per_s(i),
                 acceleration = record.acceleration_rad_per_s2(i), factor = axis.moment_factor(q);
    m.angle_rad(i) = q + axis.angle_correction_rad(q);
    m.velocity_rad_per_s(i) = axis.angle_rate(q) * speed;
    m.gravity_N_m(i) = factor * machine.gravity(q) + limb.gravity(m.angle_rad(i));
    m.inertial_N_m(i) =
        factor * machine.inertia_kg_m2 * acceleration +
        limb.inertia_kg_m2 * (axis.angle_rate(q) * acceleration + axis.angle_curvature(q) * speed * speed);
    m.moment_N_m(i) = factor * record.torque_N_m(i) - m.gravity_N_m(i) + m.inertial_N_m(i);
    m.sd_N_m(i) = std::hypot(axis.moment_relative_sd() * record.torque_N_m(i), residual);
  }
  return m;
}

}  // namespace brachium::limb
