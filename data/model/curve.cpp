#include "data/model/curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::data {
namespace {

void check_knots(std::span<const double> x, std::span<const double> y) {
  if (x.size() < 2 || x.size() != y.size()) {
    throw InputError("bad-curve",
                     fmt::format("a curve needs at least two points and as many x as y, got {} and {}",
                                 x.size(), y.size()));
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i]) || !std::isfinite(y[i]))
      throw InputError("bad-curve", fmt::format("point {} of a curve is not finite", i));
    if (i > 0 && !(x[i] > x[i - 1])) {
      throw InputError("bad-curve",
                       fmt::format("x must increase strictly: point {} has {}, after {}", i, x[i], x[i - 1]));
    }
  }
}

double sign(double v) {
  return v > 0 ? 1.0 : v < 0 ? -1.0 : 0.0;
}

// One-sided three-point end slope that keeps monotonicity (Fritsch & Butland; as in Moler's pchip).
double end_slope(double h0, double h1, double d0, double d1) {
  const double s = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
  if (sign(s) != sign(d0)) return 0.0;
  if (sign(d0) != sign(d1) && std::abs(s) > 3.0 * std::abs(d0)) return 3.0 * d0;
  return s;
}

}  // namespace

PiecewiseCubic::PiecewiseCubic(std::span<const double> x, std::span<const double> y,
                               std::vector<double> slope)
    : x_(x.begin(), x.end()),
      y_(y.begin(), y.end()),
      slope_(std::move(slope)),
      c2_(x.size() - 1),
      c3_(x.size() - 1) {
  for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
    const double h = x_[i + 1] - x_[i];
    const double d = (y_[i + 1] - y_[i]) / h;
    c2_[i] = (3.0 * d - 2.0 * slope_[i] - slope_[i + 1]) / h;
    c3_[i] = (slope_[i] + slope_[i + 1] - 2.0 * d) / (h * h);
  }
}

PiecewiseCubic PiecewiseCubic::hermite(std::span<const double> x, std::span<const double> y,
                                       std::span<const double> slope) {
  check_knots(x, y);
  if (slope.size() != x.size())
    throw InputError("bad-curve", "a Hermite curve needs one slope for each point");
  return PiecewiseCubic(x, y, {slope.begin(), slope.end()});
}

PiecewiseCubic PiecewiseCubic::monotone(std::span<const double> x, std::span<const double> y) {
  check_knots(x, y);
  const std::size_t n = x.size();
  std::vector<double> h(n - 1), d(n - 1), s(n);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    h[i] = x[i + 1] - x[i];
    d[i] = (y[i + 1] - y[i]) / h[i];
  }
  if (n == 2) {
    s = {d[0], d[0]};
    return PiecewiseCubic(x, y, std::move(s));
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    if (sign(d[i - 1]) * sign(d[i]) <= 0.0) {
      s[i] = 0.0;
    } else {
      const double w1 = 2.0 * h[i] + h[i - 1], w2 = h[i] + 2.0 * h[i - 1];
      s[i] = (w1 + w2) / (w1 / d[i - 1] + w2 / d[i]);
    }
  }
  s[0] = end_slope(h[0], h[1], d[0], d[1]);
  s[n - 1] = end_slope(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
  return PiecewiseCubic(x, y, std::move(s));
}

PiecewiseCubic PiecewiseCubic::forsythe(std::span<const double> x, std::span<const double> y) {
  check_knots(x, y);
  const std::size_t n = x.size();
  if (n == 2) {
    const double d = (y[1] - y[0]) / (x[1] - x[0]);
    return PiecewiseCubic(x, y, {d, d});
  }
  // Tridiagonal system for c (half the second derivative over 3), Forsythe, Malcolm & Moler 1977, ch. 4.
  std::vector<double> b(n), c(n), d(n);
  d[0] = x[1] - x[0];
  c[1] = (y[1] - y[0]) / d[0];
  for (std::size_t i = 1; i + 1 < n; ++i) {
    d[i] = x[i + 1] - x[i];
    b[i] = 2.0 * (d[i - 1] + d[i]);
    c[i + 1] = (y[i + 1] - y[i]) / d[i];
    c[i] = c[i + 1] - c[i];
  }
  b[0] = -d[0];
  b[n - 1] = -d[n - 2];
  c[0] = 0.0;
  c[n - 1] = 0.0;
  if (n > 3) {
    c[0] = c[2] / (x[3] - x[1]) - c[1] / (x[2] - x[0]);
    c[n - 1] = c[n - 2] / (x[n - 1] - x[n - 3]) - c[n - 3] / (x[n - 2] - x[n - 4]);
    c[0] = c[0] * d[0] * d[0] / (x[3] - x[0]);
    c[n - 1] = -c[n - 1] * d[n - 2] * d[n - 2] / (x[n - 1] - x[n - 4]);
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double t = d[i - 1] / b[i - 1];
    b[i] -= t * d[i - 1];
    c[i] -= t * c[i - 1];
  }
  c[n - 1] /= b[n - 1];
  for (std::size_t k = n - 1; k-- > 0;) c[k] = (c[k] - d[k] * c[k + 1]) / b[k];
  std::vector<double> s(n);
  for (std::size_t i = 0; i + 1 < n; ++i) s[i] = (y[i + 1] - y[i]) / d[i] - d[i] * (c[i + 1] + 2.0 * c[i]);
  s[n - 1] = (y[n - 1] - y[n - 2]) / d[n - 2] + d[n - 2] * (c[n - 2] + 2.0 * c[n - 1]);
  return PiecewiseCubic(x, y, std::move(s));
}

std::size_t PiecewiseCubic::interval(double x) const {
  const auto it = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  return static_cast<std::size_t>(it - x_.begin()) - 1;
}

CurveValue PiecewiseCubic::operator()(double x) const {
  if (x < x_.front()) return {y_.front() + slope_.front() * (x - x_.front()), slope_.front()};
  if (x > x_.back()) return {y_.back() + slope_.back() * (x - x_.back()), slope_.back()};
  const std::size_t i = interval(x);
  const double t = x - x_[i];
  return {y_[i] + t * (slope_[i] + t * (c2_[i] + t * c3_[i])),
          slope_[i] + t * (2.0 * c2_[i] + t * 3.0 * c3_[i])};
}

double PiecewiseCubic::curvature(double x) const {
  if (x < x_.front() || x > x_.back()) return 0.0;
  const std::size_t i = interval(x);
  return 2.0 * c2_[i] + 6.0 * c3_[i] * (x - x_[i]);
}

}  // namespace brachium::data
