#include "data/limb/muscle_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "data/model/error.hpp"

namespace brachium::limb {
namespace {

using data::InputError;

constexpr double degrees = 180.0 / std::numbers::pi;

// p(x) and p'(x) by Horner's scheme.
data::CurveValue polynomial(std::span<const double> c, double x) {
  double p = 0.0, dp = 0.0;
  for (std::size_t k = c.size(); k-- > 0;) {
    dp = dp * x + p;
    p = p * x + c[k];
  }
  return {p, dp};
}

// Integral of a cubic piece from a to b: Simpson's rule is exact for cubics.
double simpson(const data::PiecewiseCubic& f, double a, double b) {
  return (b - a) / 6.0 * (f(a).value + 4.0 * f(0.5 * (a + b)).value + f(b).value);
}

void require_finite(const std::string& muscle, const std::vector<double>& values, const char* what) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      throw InputError("bad-geometry",
                       fmt::format("{} {} of muscle `{}` is not a finite number", what, i + 1, muscle));
    }
  }
}

}  // namespace

MusclePath::MusclePath(std::string muscle, const data::PathGeometry& geometry,
                       const data::Coordinate& coordinate)
    : muscle_(std::move(muscle)),
      coordinate_(coordinate.name),
      lower_(coordinate.lower_rad),
      upper_(coordinate.upper_rad) {
  if (!(lower_ < upper_) || !std::isfinite(lower_) || !std::isfinite(upper_)) {
    throw InputError("bad-range", fmt::format("the range of coordinate `{}` is empty: {:.6g} to {:.6g} deg",
                                              coordinate_, lower_ * degrees, upper_ * degrees));
  }
  if (geometry.kind == data::PathGeometry::Kind::none ||
      (geometry.length_m.empty() && geometry.moment_arm_m.empty())) {
    throw InputError("missing-geometry", fmt::format("muscle `{}` has no geometry", muscle_),
                     "give its length, its moment arm, or both against the angle");
  }
  require_finite(muscle_, geometry.length_m, "length entry");
  require_finite(muscle_, geometry.moment_arm_m, "moment arm entry");
  require_finite(muscle_, geometry.angle_rad, "angle knot");
  if (geometry.length_m.empty() && !(geometry.reference_length_m > 0.0)) {
    throw InputError(
        "bad-geometry",
        fmt::format("muscle `{}` has a moment arm but neither a length nor a reference length", muscle_),
        "give the length at one angle: the moment arm only tells how it changes");
  }
  if (geometry.length_m.empty() &&
      !(geometry.reference_angle_rad >= lower_ && geometry.reference_angle_rad <= upper_)) {
    throw InputError(
        "bad-geometry",
        fmt::format("the reference angle {:.6g} deg of muscle `{}` is outside the range {:.6g} to {:.6g} deg "
                    "of coordinate `{}`",
                    geometry.reference_angle_rad * degrees, muscle_, lower_ * degrees, upper_ * degrees,
                    coordinate_));
  }
  if (geometry.kind == data::PathGeometry::Kind::polynomial) {
    build_polynomial(geometry);
  } else {
    build_table(geometry);
  }
  check_lengths();
  check_consistency(geometry.consistency_tolerance_m);
}

void MusclePath::build_polynomial(const data::PathGeometry& g) {
  consistency_.both_given = !g.length_m.empty() && !g.moment_arm_m.empty();
  length_ = g.length_m;
  arm_ = g.moment_arm_m;
  if (arm_.empty()) {  // r = -dL/dq
    for (std::size_t k = 1; k < length_.size(); ++k) arm_.push_back(-static_cast<double>(k) * length_[k]);
    if (arm_.empty()) arm_.push_back(0.0);
  }
  if (length_.empty()) {  // L = L_ref - integral of r from q_ref
    length_.push_back(0.0);
    for (std::size_t k = 0; k < arm_.size(); ++k) length_.push_back(-arm_[k] / static_cast<double>(k + 1));
    length_[0] = g.reference_length_m - polynomial(length_, g.reference_angle_rad).value;
  }
}

void MusclePath::build_table(const data::PathGeometry& g) {
  const std::vector<double>& q = g.angle_rad;
  const auto wrong_size = [&](const std::vector<double>& values, const char* what) {
    if (!values.empty() && values.size() != q.size()) {
      throw InputError("bad-geometry", fmt::format("the table of muscle `{}` has {} angles but {} {}",
                                                   muscle_, q.size(), values.size(), what));
    }
  };
  wrong_size(g.length_m, "lengths");
  wrong_size(g.moment_arm_m, "moment arms");
  if (q.size() < 2) {
    throw InputError("bad-geometry",
                     fmt::format("the table of muscle `{}` needs at least two angles", muscle_));
  }
  for (std::size_t i = 1; i < q.size(); ++i) {
    if (!(q[i] > q[i - 1])) {
      throw InputError(
          "bad-geometry",
          fmt::format("the angles of muscle `{}` must increase, but {:.6g} deg follows {:.6g} deg", muscle_,
                      q[i] * degrees, q[i - 1] * degrees));
    }
  }
  // A range written in degrees and knots written in degrees may differ in the last digit after conversion.
  const double slack = 1e-9;
  if (!(q.front() <= lower_ + slack && q.back() >= upper_ - slack)) {
    throw InputError(
        "bad-geometry",
        fmt::format(
            "the table of muscle `{}` covers {:.6g} to {:.6g} deg, less than the range {:.6g} to {:.6g} "
            "deg of coordinate `{}`",
            muscle_, q.front() * degrees, q.back() * degrees, lower_ * degrees, upper_ * degrees,
            coordinate_),
        "extend the table or narrow the coordinate's range_deg");
  }
  if (!g.length_m.empty() && !g.moment_arm_m.empty()) {
    consistency_.both_given = true;
    std::vector<double> slope(g.moment_arm_m);
    for (double& s : slope) s = -s;
    curve_ = data::PiecewiseCubic::hermite(q, g.length_m, slope);
  } else if (!g.length_m.empty()) {
    curve_ = data::PiecewiseCubic::forsythe(q, g.length_m);
  } else {
    curve_ = data::PiecewiseCubic::monotone(q, g.moment_arm_m);
    knot_length_.assign(q.size(), 0.0);
    for (std::size_t i = 1; i < q.size(); ++i)
      knot_length_[i] = knot_length_[i - 1] - simpson(*curve_, q[i - 1], q[i]);
    const double shift = g.reference_length_m - unchecked(g.reference_angle_rad).length_m;
    for (double& length : knot_length_) length += shift;
  }
}

MusclePath::Value MusclePath::unchecked(double q) const {
  if (!curve_) {
    const data::CurveValue arm = polynomial(arm_, q);
    return {polynomial(length_, q).value, arm.value, arm.slope};
  }
  if (!knot_length_.empty()) {
    const std::span<const double> knots = curve_->knots();
    const auto after = std::upper_bound(knots.begin() + 1, knots.end() - 1, q);
    const auto i = static_cast<std::size_t>(after - knots.begin()) - 1;
    const data::CurveValue arm = (*curve_)(q);
    return {knot_length_[i] - simpson(*curve_, knots[i], q), arm.value, arm.slope};
  }
  const data::CurveValue length = (*curve_)(q);
  return {length.value, -length.slope, -curve_->curvature(q)};
}

void MusclePath::check_consistency(double tolerance_m) {
  if (!consistency_.both_given) return;
  if (!(tolerance_m > 0.0)) {
    throw InputError("bad-geometry",
                     fmt::format("the consistency tolerance of muscle `{}` must be greater than 0", muscle_));
  }
  consistency_.tolerance_m = tolerance_m;
  double given = 0.0, slope = 0.0;
  const auto worst = [&](double q, double r, double minus_dl_dq) {
    const double off = std::abs(r - minus_dl_dq);
    if (off <= consistency_.worst_disagreement_m) return;
    consistency_.worst_disagreement_m = off;
    consistency_.worst_angle_rad = q;
    given = r;
    slope = minus_dl_dq;
  };
  if (!curve_) {
    constexpr int steps = 200;
    for (int i = 0; i <= steps; ++i) {
      const double q = lower_ + (upper_ - lower_) * i / steps;
      worst(q, polynomial(arm_, q).value, -polynomial(length_, q).slope);
    }
  } else {
    // At the knots the Hermite curve has slope -r by construction; what can disagree is the length gained
    // between two knots and the moment arm's mean there (of its own monotone interpolant).
    std::vector<double> arm;
    for (const double s : curve_->knot_slopes()) arm.push_back(-s);
    const std::span<const double> q = curve_->knots();
    const auto own = data::PiecewiseCubic::monotone(q, arm);
    for (std::size_t i = 1; i < q.size(); ++i) {
      const double h = q[i] - q[i - 1];
      worst(0.5 * (q[i] + q[i - 1]), simpson(own, q[i - 1], q[i]) / h,
            -((*curve_)(q[i]).value - (*curve_)(q[i - 1]).value) / h);
    }
  }
  if (!(consistency_.worst_disagreement_m <= tolerance_m)) {
    throw InputError("inconsistent-geometry",
                     fmt::format("length and moment arm of muscle `{}` disagree: at {:.4g} deg the moment "
                                 "arm is {:.4g} mm, but -dL/dq is "
                                 "{:.4g} mm; they differ by {:.3g} mm, more than {:.3g} mm",
                                 muscle_, consistency_.worst_angle_rad * degrees, given * 1e3, slope * 1e3,
                                 consistency_.worst_disagreement_m * 1e3, tolerance_m * 1e3),
                     "r = -dL/dq with flexion positive: check sign and units of both, or leave one out");
  }
}

void MusclePath::check_lengths() const {
  constexpr int steps = 100;
  for (int i = 0; i <= steps; ++i) {
    const double q = lower_ + (upper_ - lower_) * i / steps;
    const double length = unchecked(q).length_m;
    if (!(length > 0.0)) {
      throw InputError(
          "bad-geometry",
          fmt::format("muscle `{}` has a length of {:.4g} m at {:.4g} deg", muscle_, length, q * degrees),
          "a muscle-tendon length is positive over the whole range of its coordinate");
    }
  }
}

MusclePath::Value MusclePath::operator()(double q) const {
  if (!(q >= lower_ && q <= upper_)) {
    throw InputError(
        "angle-out-of-range",
        fmt::format(
            "angle {:.2f} deg is outside the range {:.6g} to {:.6g} deg of coordinate `{}` for which the "
            "geometry of muscle `{}` holds",
            q * degrees, lower_ * degrees, upper_ * degrees, coordinate_, muscle_),
        "check the angle's sign, offset and unit, or give geometry for a wider range");
  }
  return unchecked(q);
}

void MusclePath::evaluate(std::span<const double> q, std::span<const double> qdot, std::span<double> length,
                          std::span<double> moment_arm, std::span<double> velocity) const {
  const std::size_t n = q.size();
  if (length.size() != n || moment_arm.size() != n || qdot.size() != velocity.size() ||
      (!qdot.empty() && qdot.size() != n)) {
    throw InputError(
        "wrong-size",
        fmt::format("path of muscle `{}`: spans of {} angles, {} velocities, {} lengths, {} moment "
                    "arms and {} muscle velocities do not fit together",
                    muscle_, n, qdot.size(), length.size(), moment_arm.size(), velocity.size()));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const Value at = (*this)(q[i]);
    length[i] = at.length_m;
    moment_arm[i] = at.moment_arm_m;
    if (!qdot.empty()) {
      if (!std::isfinite(qdot[i])) {
        throw InputError(
            "not-finite",
            fmt::format("the rate of coordinate `{}` is not a finite number at sample {}", coordinate_, i));
      }
      velocity[i] = -at.moment_arm_m * qdot[i];
    }
  }
}

}  // namespace brachium::limb
