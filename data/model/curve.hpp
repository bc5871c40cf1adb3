#pragma once
/// Scalar curves of one variable and the piecewise cubics they are often made of.

#include <cstddef>
#include <span>
#include <vector>

namespace brachium::data {

/// A curve's value and its derivative with respect to the argument.
struct CurveValue {
  double value = 0.0;
  double slope = 0.0;
};

/// Where a curve may be evaluated.
struct Domain {
  double lower;
  double upper;
  bool contains(double x) const { return x >= lower && x <= upper; }
};

/// A continuously differentiable piecewise cubic through knots (x_i, y_i), x strictly increasing.
/// Outside [x_0, x_n] it continues linearly with the end slope; ask domain() where that matters.
class PiecewiseCubic {
 public:
  /// Monotone interpolant: no overshoot between data (Fritsch & Carlson 1980, doi:10.1137/0717021, with the
  /// slopes of Fritsch & Butland 1984, doi:10.1137/0905021, as in scipy's PchipInterpolator). Needs >= 2 knots.
  static PiecewiseCubic monotone(std::span<const double> x, std::span<const double> y);
  /// Twice continuously differentiable spline with the end condition of Forsythe, Malcolm & Moler 1977
  /// (`spline`): the third derivative at each end is that of the cubic through the four end points. >= 2 knots.
  static PiecewiseCubic forsythe(std::span<const double> x, std::span<const double> y);
  /// Cubic Hermite with given knot slopes.
  static PiecewiseCubic hermite(std::span<const double> x, std::span<const double> y,
                                std::span<const double> slope);

  CurveValue operator()(double x) const;
  /// Second derivative (piecewise; right-continuous at knots).
  double curvature(double x) const;
  Domain domain() const { return {x_.front(), x_.back()}; }
  std::span<const double> knots() const { return x_; }
  std::span<const double> knot_values() const { return y_; }
  std::span<const double> knot_slopes() const { return slope_; }

 private:
  PiecewiseCubic(std::span<const double> x, std::span<const double> y, std::vector<double> slope);
  std::size_t interval(double x) const;

  std::vector<double> x_, y_, slope_, c2_, c3_;  // y + s dx + c2 dx^2 + c3 dx^3 on each interval
};

}  // namespace brachium::data
