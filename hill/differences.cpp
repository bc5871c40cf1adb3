#include "hill/differences.hpp"

#include <cassert>

namespace brachium::hill {

void central_differences(std::span<const double> y, double step_s, std::span<double> out) {
  const std::size_t n = y.size();
  assert(n >= kCentralFrames && out.size() == n);
  const double s = 1.0 / (12.0 * step_s);
  const auto first = [s](double a, double b, double c, double d, double e) {
    return s * (-25.0 * a + 48.0 * b - 36.0 * c + 16.0 * d - 3.0 * e);
  };
  const auto second = [s](double a, double b, double c, double d, double e) {
    return s * (-3.0 * a - 10.0 * b + 18.0 * c - 6.0 * d + e);
  };
  out[0] = first(y[0], y[1], y[2], y[3], y[4]);
  out[1] = second(y[0], y[1], y[2], y[3], y[4]);
  for (std::size_t k = 2; k + 2 < n; ++k) out[k] = s * (8.0 * (y[k + 1] - y[k - 1]) - (y[k + 2] - y[k - 2]));
  out[n - 2] = -second(y[n - 1], y[n - 2], y[n - 3], y[n - 4], y[n - 5]);
  out[n - 1] = -first(y[n - 1], y[n - 2], y[n - 3], y[n - 4], y[n - 5]);
}

void SplineSlopes::prepare(std::size_t n, double step_s) {
  assert(n >= 4);
  if (n == n_ && step_s == step_) return;
  n_ = n;
  step_ = step_s;
  // Forward elimination of the tridiagonal system of data::PiecewiseCubic::forsythe, all spacings h.
  const double h = step_s;
  factor_.resize(n);
  inverse_.resize(n);
  c_.resize(n);
  double b = -h;
  inverse_[0] = 1.0 / b;
  for (std::size_t i = 1; i < n; ++i) {
    factor_[i] = h / b;
    b = (i + 1 < n ? 4.0 * h : -h) - factor_[i] * h;
    inverse_[i] = 1.0 / b;
  }
}

void SplineSlopes::apply(std::span<const double> y, std::span<double> out) {
  const std::size_t n = n_;
  assert(y.size() == n && out.size() == n);
  const double h = step_, r = 1.0 / step_;
  std::vector<double>& c = c_;
  // Right-hand side: second differences inside; at the ends the third derivative of the cubic through four
  // points.
  for (std::size_t i = 1; i + 1 < n; ++i) c[i] = (y[i + 1] - y[i]) * r - (y[i] - y[i - 1]) * r;
  c[0] = (c[2] - c[1]) / 6.0;
  c[n - 1] = -(c[n - 2] - c[n - 3]) / 6.0;
  for (std::size_t i = 1; i < n; ++i) c[i] -= factor_[i] * c[i - 1];
  c[n - 1] *= inverse_[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) c[i] = (c[i] - h * c[i + 1]) * inverse_[i];
  for (std::size_t i = 0; i + 1 < n; ++i) out[i] = (y[i + 1] - y[i]) * r - h * (c[i + 1] + 2.0 * c[i]);
  out[n - 1] = (y[n - 1] - y[n - 2]) * r + h * (c[n - 2] + 2.0 * c[n - 1]);
}

}  // namespace brachium::hill
