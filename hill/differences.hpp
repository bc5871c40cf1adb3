#pragma once
/// Derivatives in time of equally spaced samples. All are linear in the samples, so that the tangent of a
/// derivative is the same operator on the tangents.

#include <cstddef>
#include <span>
#include <vector>

namespace brachium::hill {

/// Fewest frames that central_differences() needs.
inline constexpr std::size_t kCentralFrames = 5;

/// Five-point differences of fourth order, exact for quartics: symmetric (no phase lag) but at the two frames
/// next to either end, where the same five points are used one-sidedly.
void central_differences(std::span<const double> y, double step_s, std::span<double> out);

/// Backward difference of second order, (3 y_k - 4 y_{k-1} + y_{k-2})/(2 h); of first order at frame 1.
struct BackwardDifference {
  double step_s;
  /// y'_k = alpha(k) y_k + beta(k, y); k >= 1.
  double alpha(std::size_t k) const { return k == 1 ? 1.0 / step_s : 1.5 / step_s; }
  double beta(std::size_t k, const double* y) const {
    return k == 1 ? -y[0] / step_s : (-2.0 * y[k - 1] + 0.5 * y[k - 2]) / step_s;
  }
};

/// Knot slopes of the cubic spline of Forsythe, Malcolm & Moler 1977 through equally spaced samples
/// (data::PiecewiseCubic::forsythe at its knots). Needs n >= 4. Factored once for a length, applied often.
class SplineSlopes {
 public:
  void prepare(std::size_t n, double step_s);  ///< keeps the factors if n and step are as before
  void apply(std::span<const double> y, std::span<double> out);

 private:
  std::size_t n_ = 0;
  double step_ = 0.0;
  std::vector<double> factor_, inverse_;
  std::vector<double> c_;
};

}  // namespace brachium::hill
