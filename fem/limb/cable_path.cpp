#include "fem/limb/cable_path.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

double angle_of(const Eigen::Vector2d& v) {
  return std::atan2(v.y(), v.x());
}
Eigen::Vector2d direction(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

}  // namespace

CablePath::CablePath(const CableGeometry& g, double q)
    : origin_(g.origin_m), centre_(g.obstacle_m), radius_(g.radius_m) {
  insertion_ = g.distance_m * Eigen::Vector2d(std::sin(q + g.offset_rad), -std::cos(q + g.offset_rad));
  // Walking down from the origin, the obstacle is on the right of a path that passes anterior: it turns
  // clockwise.
  side_ = g.anterior ? -1.0 : 1.0;
  const Eigen::Vector2d a = origin_ - centre_, b = insertion_ - centre_;
  const double from_origin = a.norm(), from_insertion = b.norm();
  if (!(from_origin > radius_ && from_insertion > radius_)) {
    throw data::InputError(
        "limb-geometry",
        fmt::format("at {:.1f} deg the {} of a tendon's path lies {:.4g} m from the centre of its obstacle "
                    "of radius {:.4g} m",
                    q * 180.0 / std::numbers::pi, from_origin > radius_ ? "insertion" : "origin",
                    std::min(from_origin, from_insertion), radius_),
        "both ends of a path lie outside its obstacle");
  }
  const double leaves = angle_of(a) + side_ * std::acos(radius_ / from_origin);
  const double arrives = angle_of(b) - side_ * std::acos(radius_ / from_insertion);
  const double turn = std::remainder(side_ * (arrives - leaves), 2.0 * std::numbers::pi);
  if (turn > 0.95 * std::numbers::pi || turn < -0.95 * std::numbers::pi) {
    throw data::InputError(
        "limb-geometry",
        fmt::format("at {:.1f} deg a tendon's path turns by more than half a circle around its obstacle",
                    q * 180.0 / std::numbers::pi),
        "move origin, insertion or obstacle of the muscle");
  }
  if (turn <= 0.0) {
    leaves_ = arrives_ = origin_;
    last_ = (insertion_ - origin_).norm();
    return;
  }
  leaves_ = centre_ + radius_ * direction(leaves);
  arrives_ = centre_ + radius_ * direction(arrives);
  first_ = (leaves_ - origin_).norm();
  arc_ = radius_ * turn;
  last_ = (insertion_ - arrives_).norm();
}

Eigen::Vector2d CablePath::pull() const {
  return (arrives_ - insertion_).normalized();
}

double CablePath::lever_arm_m() const {
  const Eigen::Vector2d t = pull();
  return insertion_.x() * t.y() - insertion_.y() * t.x();
}

CablePath::Place CablePath::place(double s) const {
  if (!(s >= 0.0 && s <= length_m())) {
    throw data::InputError(
        "limb-geometry",
        fmt::format("a tendon of {:.4g} m does not fit on a path of {:.4g} m", s, length_m()),
        "shorten the tendon, or move the origin away");
  }
  if (s <= last_) return {insertion_ + s * pull(), pull()};
  if (s <= last_ + arc_) {
    const double angle = angle_of(arrives_ - centre_) - side_ * (s - last_) / radius_;
    const Eigen::Vector2d out = direction(angle);
    return {centre_ + radius_ * out, side_ * Eigen::Vector2d(out.y(), -out.x())};
  }
  const Eigen::Vector2d up = (origin_ - leaves_).normalized();
  return {leaves_ + (s - last_ - arc_) * up, up};
}

}  // namespace brachium::fem
