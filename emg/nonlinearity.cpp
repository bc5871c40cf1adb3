#include "emg/nonlinearity.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "data/model/error.hpp"
#include "emg/names.hpp"

namespace brachium::emg {
namespace {

constexpr std::array<std::pair<Nonlinearity, const char*>, 3> names{
    {{Nonlinearity::exponential, "exponential"},
     {Nonlinearity::piecewise, "piecewise"},
     {Nonlinearity::none, "none"}}};

// Below this |A| the exponential is evaluated through φ, above it by one expm1 and one product.
constexpr double small_shape = 1e-3;

// φ(x) = (e^x - 1)/x
double phi(double x) {
  return x == 0.0 ? 1.0 : std::expm1(x) / x;
}

// φ'(x) = (e^x - φ(x))/x, by its series Σ n x^(n-1)/(n+1)! where the difference would cancel
double phi_slope(double x) {
  if (std::abs(x) > 0.5) return (std::exp(x) - phi(x)) / x;
  double term = 0.5, sum = 0.5;  // term of n: x^(n-1)/(n+1)!
  for (int n = 2; n <= 16; ++n) {
    term *= x / (n + 1);
    sum += n * term;
  }
  return sum;
}

// h(y) = y/(1 - e^-y), h - 1 without cancellation, and h'
std::pair<double, double> node_function(double y) {
  if (y < 0.05) {
    const double y2 = y * y;
    return {y / 2 + y2 / 12 - y2 * y2 / 720 + y2 * y2 * y2 / 30240,
            0.5 + y / 6 - y2 * y / 180 + y2 * y2 * y / 5040};
  }
  const double e = std::exp(-y);
  const double d = -std::expm1(-y);
  return {y / d - 1.0, (d - y * e) / (d * d)};
}

// (s/(1 + s) - ln(1 + s))/s^2, by its series Σ_(n>=2) (-1)^(n-1) (n-1)/n s^(n-2) where the difference would cancel
double log_slope(double s) {
  if (std::abs(s) > 0.05) return (s / (1.0 + s) - std::log1p(s)) / (s * s);
  double power = 1.0, sum = 0.0;
  for (int n = 2; n <= 16; ++n) {
    sum += (n % 2 == 0 ? -1.0 : 1.0) * (n - 1) / n * power;
    power *= s;
  }
  return sum;
}

}  // namespace

std::string to_string(Nonlinearity nonlinearity) {
  return name_of(names, nonlinearity);
}
Nonlinearity parse_nonlinearity(const std::string& name) {
  return parse_name(names, name, "unknown-nonlinearity", "an activation nonlinearity");
}

ShapeRange shape_range(Nonlinearity nonlinearity) {
  switch (nonlinearity) {
    case Nonlinearity::exponential:
      return {-3.0, 0.0};
    case Nonlinearity::piecewise:
      return {0.0, 0.12};
    case Nonlinearity::none:
      break;
  }
  return {-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
}

ShapedNonlinearity::ShapedNonlinearity(Nonlinearity kind, double shape) : kind_(kind), shape_(shape) {
  const ShapeRange range = shape_range(kind);
  if (!(shape >= range.lower && shape <= range.upper)) {
    throw data::InputError("out-of-range",
                           fmt::format("`shape` = {} is outside [{}, {}], the range of the {} nonlinearity",
                                       shape, range.lower, range.upper, to_string(kind)));
  }
  if (kind == Nonlinearity::exponential) prepare_exponential();
  if (kind == Nonlinearity::piecewise) prepare_piecewise();
}

void ShapedNonlinearity::prepare_exponential() {
  phi_ = phi(shape_);
  dphi_ = phi_slope(shape_);
  inverse_expm1_ = shape_ == 0.0 ? 0.0 : 1.0 / std::expm1(shape_);
}

// With y = ln(1 + x), x = β u0, the two conditions at the node, α ln(1 + x) = a0 and α β/(1 + x) = m, leave one
// equation, h(y) = y/(1 - e^-y) = a0/(m u0), and κ = α x = m e^y u0. a0 - m u0 = 1 - m = (a0 - u0)/(1 - u0).
void ShapedNonlinearity::prepare_piecewise() {
  constexpr double root_half = 1.0 / std::numbers::sqrt2;
  const double u0 = 0.3085 - shape_ * root_half;
  const double a0 = 0.3085 + shape_ * root_half;
  const double m = (1.0 - a0) / (1.0 - u0);
  const double excess = (a0 - u0) / ((1.0 - u0) * m * u0);  // a0/(m u0) - 1

  double y =
      excess;  // h is convex and h - 1 < y: one Newton step overshoots the root, the others come down to it
  for (int i = 0; i < 60; ++i) {
    const auto [value, slope] = node_function(y);
    const double step = (excess - value) / slope;
    y += step;
    if (!(std::abs(step) > 1e-16 * y)) break;
  }

  const double du0 = -root_half, da0 = root_half;
  const double dm = (-da0 * (1.0 - u0) + (1.0 - a0) * du0) / ((1.0 - u0) * (1.0 - u0));
  const double ratio = a0 / (m * u0);
  const double dratio = ratio * (da0 / a0 - dm / m - du0 / u0);
  const double dy = dratio / node_function(y).second;
  const double e = std::exp(y);

  u0_ = u0, du0_ = du0;
  m_ = m, dm_ = dm;
  x_ = std::expm1(y), dx_ = e * dy;
  kappa_ = m * e * u0, dkappa_ = kappa_ * (dm / m + dy + du0 / u0);
  slope_at_0_ = m * e, dslope_at_0_ = slope_at_0_ * (dm / m + dy);
}

double ShapedNonlinearity::operator()(double u) const {
  switch (kind_) {
    case Nonlinearity::exponential:
      if (shape_ < -small_shape) return std::expm1(shape_ * u) * inverse_expm1_;
      return u * phi(shape_ * u) / phi_;
    case Nonlinearity::piecewise:
      if (u >= u0_) return m_ * u + (1.0 - m_);
      if (u < 0.0) return slope_at_0_ * u;
      return x_ == 0.0 ? kappa_ * (u / u0_) : kappa_ * std::log1p(x_ * (u / u0_)) / x_;
    case Nonlinearity::none:
      break;
  }
  return u;
}

NonlinearityValue ShapedNonlinearity::with_derivatives(double u) const {
  switch (kind_) {
    case Nonlinearity::exponential: {
      // a = u φ(A u)/φ(A):  ∂a/∂u = e^(A u)/φ(A),  ∂a/∂A = u (u φ'(A u) φ(A) - φ(A u) φ'(A))/φ(A)^2
      const double x = shape_ * u;
      const double em1 = std::expm1(x);
      const double phi_x = x == 0.0 ? 1.0 : em1 / x;
      const double dphi_x = std::abs(x) > 0.5 ? (em1 + 1.0 - phi_x) / x : phi_slope(x);
      return {(*this)(u), (em1 + 1.0) / phi_, u * (u * dphi_x * phi_ - phi_x * dphi_) / (phi_ * phi_)};
    }
    case Nonlinearity::piecewise: {
      if (u >= u0_) return {(*this)(u), m_, dm_ * (u - 1.0)};
      if (u < 0.0) return {(*this)(u), slope_at_0_, dslope_at_0_ * u};
      // a = κ L(x, w), L = ln(1 + x w)/x, w = u/u0
      const double w = u / u0_;
      const double dw = -w * du0_ / u0_;
      const double s = x_ * w;
      const double L = x_ == 0.0 ? w : std::log1p(s) / x_;
      const double dL_dw = 1.0 / (1.0 + s);
      const double dL_dx = w * w * log_slope(s);
      return {(*this)(u), kappa_ * dL_dw / u0_, dkappa_ * L + kappa_ * (dL_dx * dx_ + dL_dw * dw)};
    }
    case Nonlinearity::none:
      break;
  }
  return {u, 1.0, 0.0};
}

}  // namespace brachium::emg
