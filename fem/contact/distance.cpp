#include "fem/contact/distance.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "fem/contact/distance_grid.hpp"

namespace brachium::fem {
namespace {

/// Distance r - R from an offset vector d = x - p of length r that spans the directions in which the body is
/// round.
Distance round(const Eigen::Vector3d& d, const Eigen::Matrix3d& across, double radius) {
  const double r = d.norm();
  if (!(r > 0.0)) return {-radius, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()};
  const Eigen::Vector3d n = d / r;
  return {r - radius, n, (across - n * n.transpose()) / r};
}

Distance of(const HalfSpace& s, const Eigen::Vector3d& x) {
  const Eigen::Vector3d n = s.normal.normalized();
  return {n.dot(x - s.point_m), n, Eigen::Matrix3d::Zero()};
}

Distance of(const Sphere& s, const Eigen::Vector3d& x) {
  return round(x - s.centre_m, Eigen::Matrix3d::Identity(), s.radius_m);
}

Distance of(const Cylinder& s, const Eigen::Vector3d& x) {
  const Eigen::Vector3d e = s.axis.normalized();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - e * e.transpose();
  return round(across * (x - s.point_m), across, s.radius_m);
}

Distance of(const Capsule& s, const Eigen::Vector3d& x) {
  const Eigen::Vector3d along = s.to_m - s.from_m;
  const double t = along.dot(x - s.from_m) / along.squaredNorm();
  if (t <= 0.0) return round(x - s.from_m, Eigen::Matrix3d::Identity(), s.radius_m);
  if (t >= 1.0) return round(x - s.to_m, Eigen::Matrix3d::Identity(), s.radius_m);
  const Eigen::Vector3d e = along.normalized();
  return round(x - s.from_m - t * along, Eigen::Matrix3d::Identity() - e * e.transpose(), s.radius_m);
}

/// Foot of the perpendicular on an ellipsoid: p_i = a_i^2 y_i / (a_i^2 + t) with the largest root t of
/// sum (a_i y_i / (a_i^2 + t))^2 = 1 (Eberly, "Distance from a point to an ellipse, an ellipsoid, or a
/// hyperellipsoid"). The left side falls from infinity to 0 on (-min a^2, inf): bisection keeps Newton
/// inside. On a symmetry plane inside the evolute the foot is not unique; the one of the smallest semi-axis
/// is taken.
Eigen::Vector3d ellipsoid_foot(const Eigen::Vector3d& a, const Eigen::Vector3d& y) {
  const Eigen::Vector3d a2 = a.cwiseAbs2();
  int smallest = 0;
  a2.minCoeff(&smallest);
  const auto g = [&](double t) {
    return (a.cwiseProduct(y).cwiseQuotient(a2 + Eigen::Vector3d::Constant(t))).squaredNorm() - 1.0;
  };
  double lower = -a2[smallest] + a[smallest] * std::abs(y[smallest]);  // g >= 0 here, from the one term
  double upper = -a2[smallest] + a.cwiseProduct(y).norm();             // g <= 0 here
  if (!(a2[smallest] + upper > 0.0) || g(-a2[smallest] * (1.0 - 1e-15)) < 0.0) {
    // On the plane y_smallest = 0, so deep inside that even t = -a^2 gives too little: the root stays there
    // and the missing part of the unit length is the smallest axis' own.
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    double rest = 1.0;
    for (int i = 0; i < 3; ++i) {
      if (i == smallest) continue;
      const double denominator = a2[i] - a2[smallest];
      p[i] = denominator > 0.0 ? a2[i] * y[i] / denominator : 0.0;
      rest -= p[i] * p[i] / a2[i];
    }
    p[smallest] = std::copysign(a[smallest] * std::sqrt(std::max(rest, 0.0)), y[smallest]);
    return p;
  }
  double t = upper;
  for (int iteration = 0; iteration < 200 && upper - lower > 1e-16 * (a2.maxCoeff() + std::abs(t));
       ++iteration) {
    const double value = g(t);
    (value >= 0.0 ? lower : upper) = t;
    const Eigen::Vector3d q = a2 + Eigen::Vector3d::Constant(t);
    const double slope =
        -2.0 * (a2.cwiseProduct(y.cwiseAbs2()).cwiseQuotient(q.cwiseProduct(q.cwiseAbs2()))).sum();
    double next = t - value / slope;
    if (!(next > lower && next < upper)) next = 0.5 * (lower + upper);
    if (next == t) break;
    t = next;
  }
  return a2.cwiseProduct(y).cwiseQuotient(a2 + Eigen::Vector3d::Constant(t));
}

Distance of(const Ellipsoid& s, const Eigen::Vector3d& x) {
  const Eigen::Vector3d& a = s.semi_axes_m;
  const Eigen::Vector3d y = s.axes.transpose() * (x - s.centre_m);
  const Eigen::Vector3d foot = ellipsoid_foot(a, y);
  // phi = sum (x_i/a_i)^2 - 1: normal along grad phi, shape operator S = P Hess(phi) P / |grad phi|.
  const Eigen::Vector3d inverse = a.cwiseAbs2().cwiseInverse();
  const Eigen::Vector3d gradient = 2.0 * inverse.cwiseProduct(foot);
  const Eigen::Vector3d n = gradient.normalized();
  const double value = n.dot(y - foot);
  const Eigen::Matrix3d P = Eigen::Matrix3d::Identity() - n * n.transpose();
  const Eigen::Matrix3d S = P * Eigen::Matrix3d((2.0 * inverse / gradient.norm()).asDiagonal()) * P;
  const Eigen::Matrix3d hessian = S * (Eigen::Matrix3d::Identity() + value * S).inverse();
  return {value, s.axes * n, s.axes * (0.5 * (hessian + hessian.transpose())) * s.axes.transpose()};
}

Distance of(const TriangleBody& s, const Eigen::Vector3d& x) {
  return s.grid->evaluate(x);
}

void positive(double value, const char* what, const std::string& body) {
  if (value > 0.0 && std::isfinite(value)) return;
  throw data::InputError("contact-shape", fmt::format("{} of body `{}` is {}", what, body, value),
                         "it must be above 0 and finite");
}

void not_zero(const Eigen::Vector3d& v, const char* what, const std::string& body) {
  if (v.norm() > 0.0 && v.allFinite()) return;
  throw data::InputError("contact-shape", fmt::format("{} of body `{}` has no direction", what, body),
                         "give a vector that is not zero");
}

struct Check {
  const std::string& body;
  void operator()(const HalfSpace& s) const { not_zero(s.normal, "the normal", body); }
  void operator()(const Sphere& s) const { positive(s.radius_m, "the radius", body); }
  void operator()(const Cylinder& s) const {
    positive(s.radius_m, "the radius", body);
    not_zero(s.axis, "the axis", body);
  }
  void operator()(const Capsule& s) const {
    positive(s.radius_m, "the radius", body);
    not_zero(s.to_m - s.from_m, "the axis", body);
  }
  void operator()(const Ellipsoid& s) const {
    for (int i = 0; i < 3; ++i) positive(s.semi_axes_m[i], "a semi-axis", body);
    if (!((s.axes.transpose() * s.axes - Eigen::Matrix3d::Identity()).norm() < 1e-9)) {
      throw data::InputError("contact-shape", fmt::format("the axes of body `{}` are not orthonormal", body),
                             "give three unit vectors at right angles");
    }
  }
  void operator()(const TriangleBody& s) const {
    if (!s.grid) throw data::InputError("contact-shape", fmt::format("body `{}` has no triangles", body));
  }
};

}  // namespace

Distance distance(const RigidShape& shape, const Eigen::Vector3d& x) {
  return std::visit([&](const auto& s) { return of(s, x); }, shape);
}

Distance distance(const RigidShape& shape, const Pose& pose, const Eigen::Vector3d& x) {
  const Distance at_home = distance(shape, pose.rotation.transpose() * (x - pose.translation_m));
  return {at_home.value, pose.rotation * at_home.gradient,
          pose.rotation * at_home.hessian * pose.rotation.transpose()};
}

void check(const RigidShape& shape, const std::string& body) {
  std::visit(Check{body}, shape);
}

}  // namespace brachium::fem
