#include "data/limb/forearm_motion.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using data::InputError;
using Eigen::Index;

constexpr double degrees = 180.0 / std::numbers::pi;

Eigen::Vector3d unit(const Eigen::Vector3d& v, const char* what) {
  const double norm = v.norm();
  if (!(norm > 0.0) || !std::isfinite(norm))
    throw InputError("out-of-range", fmt::format("{} has no length", what));
  return v / norm;
}

Eigen::Quaterniond rotation(const Eigen::Matrix4Xd& q, Index i, bool segment_to_world) {
  const Eigen::Vector4d c = q.col(i);
  if (!c.allFinite())
    throw InputError("not-finite", fmt::format("the orientation is not finite at sample {}", i));
  const double norm = c.norm();
  if (!(std::abs(norm - 1.0) <= 1e-3)) {
    throw InputError("bad-quaternion",
                     fmt::format("the orientation at sample {} has the norm {:.6g}, not 1", i, norm),
                     "the four components are x, y, z, w of a unit quaternion");
  }
  const Eigen::Quaterniond r(c(3) / norm, c(0) / norm, c(1) / norm, c(2) / norm);
  return segment_to_world ? r : r.conjugate();
}

// atan2 keeps its precision for small angles, where acos does not.
double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Eigen::MatrixXd stacked(std::span<const data::Signal> components) {
  if (components.empty()) throw InputError("wrong-size", "no signals to put together");
  const data::SignalInfo& first = components.front().info;
  Eigen::MatrixXd rows(static_cast<Index>(components.size()), static_cast<Index>(first.count));
  for (std::size_t r = 0; r < components.size(); ++r) {
    const data::SignalInfo& info = components[r].info;
    if (info.rate_hz != first.rate_hz || info.start_time_s != first.start_time_s ||
        info.count != first.count) {
      throw InputError(
          "rates-disagree",
          fmt::format("signals `{}` and `{}` belong together, but differ in rate, start or length "
                      "({:.6g} and {:.6g} Hz, {:.6g} and {:.6g} s, {} and {} samples)",
                      first.name, info.name, first.rate_hz, info.rate_hz, first.start_time_s,
                      info.start_time_s, first.count, info.count),
          "resample one of them first");
    }
    for (std::size_t i = 0; i < components[r].samples.size(); ++i)
      rows(static_cast<Index>(r), static_cast<Index>(i)) = components[r].samples[i];
  }
  return rows;
}

ForearmMotion motion_from_orientation(const Eigen::Matrix4Xd& q, double rate_hz,
                                      const OrientationConvention& convention) {
  ForearmMotion m;
  m.rate_hz = rate_hz;
  m.up = unit(convention.up, "the vertical axis");
  const Eigen::Vector3d axis = unit(convention.long_axis, "the forearm's long axis");
  m.direction.resize(3, q.cols());
  for (Index i = 0; i < q.cols(); ++i)
    m.direction.col(i) = rotation(q, i, convention.segment_to_world) * axis;
  m.origin = fmt::format(
      "segment orientation, long axis ({:.4g}, {:.4g}, {:.4g}) of the segment, {}", axis(0), axis(1), axis(2),
      convention.segment_to_world ? "quaternion from segment to world" : "quaternion from world to segment");
  return m;
}

ForearmMotion motion_from_points(const Eigen::Matrix3Xd& elbow, const Eigen::Matrix3Xd& distal,
                                 double rate_hz, const Eigen::Vector3d& up) {
  if (elbow.cols() != distal.cols()) {
    throw InputError("wrong-size",
                     fmt::format("{} elbow points but {} distal points", elbow.cols(), distal.cols()));
  }
  ForearmMotion m;
  m.rate_hz = rate_hz;
  m.up = unit(up, "the vertical axis");
  m.elbow_m = elbow;
  m.direction.resize(3, elbow.cols());
  for (Index i = 0; i < elbow.cols(); ++i) {
    const Eigen::Vector3d along = distal.col(i) - elbow.col(i);
    if (!along.allFinite())
      throw InputError("not-finite", fmt::format("a point of the forearm is not finite at sample {}", i));
    if (!(along.norm() > 1e-3)) {
      throw InputError(
          "out-of-range",
          fmt::format("elbow and distal point are {:.3g} mm apart at sample {}", along.norm() * 1e3, i),
          "positions are in m inside; check the declared unit");
    }
    m.direction.col(i) = along.normalized();
  }
  m.origin = "trajectories of the elbow and a distal point";
  return m;
}

ForearmMotion motion_from_angle(const Eigen::VectorXd& angle, double rate_hz, double inclination) {
  if (!std::isfinite(inclination))
    throw InputError("not-finite", "the upper arm's inclination is not a finite number");
  for (Index i = 0; i < angle.size(); ++i) {
    if (!std::isfinite(angle(i)))
      throw InputError("not-finite",
                       fmt::format("the elbow angle is not a finite number at sample {} ({:.6g} s)", i,
                                   static_cast<double>(i) / rate_hz),
                       "fill or cut the gap before");
  }
  ForearmMotion m;
  m.rate_hz = rate_hz;
  m.direction.resize(3, angle.size());
  for (Index i = 0; i < angle.size(); ++i) {
    const double phi = angle(i) + inclination;
    m.direction.col(i) = Eigen::Vector3d(std::sin(phi), 0.0, -std::cos(phi));
  }
  m.origin = fmt::format("flexion angle over an upper arm held {:.4g} deg from vertical (assumed)",
                         inclination * degrees);
  return m;
}

DirectionAgreement compare_directions(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  if (a.cols() != b.cols() || a.cols() == 0) {
    throw InputError("wrong-size", fmt::format("cannot compare {} with {} directions", a.cols(), b.cols()));
  }
  DirectionAgreement r;
  double sum = 0.0, squares = 0.0;
  for (Index i = 0; i < a.cols(); ++i) {
    const double angle = angle_between(a.col(i), b.col(i)) * degrees;
    sum += angle;
    squares += angle * angle;
    if (angle > r.worst_deg) {
      r.worst_deg = angle;
      r.worst_sample = i;
    }
  }
  r.mean_deg = sum / static_cast<double>(a.cols());
  r.rms_deg = std::sqrt(squares / static_cast<double>(a.cols()));
  return r;
}

ImpliedInclination implied_inclination(const ForearmMotion& motion, const Eigen::VectorXd& angle) {
  if (motion.direction.cols() != angle.size() || angle.size() == 0) {
    throw InputError("wrong-size", fmt::format("{} directions of the forearm but {} elbow angles",
                                               motion.direction.cols(), angle.size()));
  }
  ImpliedInclination r;
  for (Index i = 0; i < angle.size(); ++i) {
    const double inclination = angle_between(motion.direction.col(i), -motion.up) - angle(i);
    r.mean_rad += inclination / static_cast<double>(angle.size());
    r.lowest_rad = i == 0 ? inclination : std::min(r.lowest_rad, inclination);
    r.highest_rad = i == 0 ? inclination : std::max(r.highest_rad, inclination);
  }
  return r;
}

LongAxisEstimate estimate_long_axis(const Eigen::Matrix4Xd& q, const Eigen::Matrix3Xd& direction,
                                    bool segment_to_world) {
  if (q.cols() != direction.cols() || q.cols() == 0) {
    throw InputError("wrong-size",
                     fmt::format("{} orientations but {} directions", q.cols(), direction.cols()));
  }
  Eigen::Matrix3Xd own(3, q.cols());
  for (Index i = 0; i < q.cols(); ++i)
    own.col(i) = rotation(q, i, segment_to_world).conjugate() * direction.col(i);
  LongAxisEstimate e;
  e.long_axis = unit(own.rowwise().mean(), "the mean long axis");
  double squares = 0.0;
  for (Index i = 0; i < own.cols(); ++i)
    squares += std::pow(angle_between(own.col(i), e.long_axis) * degrees, 2);
  e.scatter_deg = std::sqrt(squares / static_cast<double>(own.cols()));
  return e;
}

}  // namespace brachium::limb
