#pragma once
/// Curves y(x) made of quintic Bézier pieces with a C-shaped corner each (Millard, Uchida, Seth & Delp 2013,
/// doi:10.1115/1.4023390, appendix): second derivatives are zero where pieces meet, so the whole is C².
///
/// A piece runs from (x₀, y₀) with slope s₀ to (x₁, y₁) with slope s₁. Its tangents meet at (x_c, y_c); with
/// the curviness c in [0, 1] the six control points are P₀, Q₀, Q₀, Q₁, Q₁, P₁, Qᵢ = Pᵢ + (0.1 + 0.8 c)(P_c -
/// Pᵢ). y(x) = y(u(x)), and u(x) is the root of the monotone quintic x(u) = x.

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "data/model/curve.hpp"

namespace brachium::hill {

class QuinticBezier {
 public:
  struct Knot {
    double x, y, slope;
  };

  QuinticBezier() = default;
  /// Throws InputError("bad-curve") unless x increases strictly, 0 <= curviness <= 1, and the tangents of
  /// each piece meet between its ends.
  QuinticBezier(const std::vector<Knot>& knots, double curviness)
      : QuinticBezier(knots, std::vector<double>(knots.size() - 1, curviness)) {}
  /// One curviness for each piece.
  QuinticBezier(const std::vector<Knot>& knots, const std::vector<double>& curviness);

  /// Beyond the first and the last knot the curve goes on linearly.
  data::CurveValue operator()(double x) const {
    if (x <= first_.x) return {first_.y + first_.slope * (x - first_.x), first_.slope};
    if (x >= last_.x) return {last_.y + last_.slope * (x - last_.x), last_.slope};
    std::size_t i = 0;
    while (x >= pieces_[i].x_end) ++i;
    return pieces_[i].evaluate(x);
  }
  data::Domain domain() const { return {first_.x, last_.x}; }

 private:
  static constexpr std::size_t kCells = 128;

  struct Piece {
    double x_start, x_end, inverse_cell;
    std::array<double, 6> x, y;            // x(u), y(u) in powers of u
    std::array<double, kCells + 2> guess;  // u at the borders of a uniform grid in x

    data::CurveValue evaluate(double at) const {
      const double cell = (at - x_start) * inverse_cell;
      const std::size_t k = static_cast<std::size_t>(cell);
      double u = guess[k] + (cell - static_cast<double>(k)) * (guess[k + 1] - guess[k]);
      double rate = 1.0;
      // Newton's error squares: what is left after a step below 1e-9 is rounding. Two steps do nearly
      // everywhere, a third where a strong curviness makes x(u) flat.
      double step = 1.0;
      for (int i = 0; i < 8 && std::abs(step) > 1e-9; ++i) {
        const double value = ((((x[5] * u + x[4]) * u + x[3]) * u + x[2]) * u + x[1]) * u + x[0];
        rate = (((5.0 * x[5] * u + 4.0 * x[4]) * u + 3.0 * x[3]) * u + 2.0 * x[2]) * u + x[1];
        step = (value - at) / rate;
        u -= step;
      }
      rate = (((5.0 * x[5] * u + 4.0 * x[4]) * u + 3.0 * x[3]) * u + 2.0 * x[2]) * u + x[1];
      return {((((y[5] * u + y[4]) * u + y[3]) * u + y[2]) * u + y[1]) * u + y[0],
              ((((5.0 * y[5] * u + 4.0 * y[4]) * u + 3.0 * y[3]) * u + 2.0 * y[2]) * u + y[1]) / rate};
    }
  };

  Knot first_{0.0, 0.0, 0.0}, last_{0.0, 0.0, 0.0};
  std::vector<Piece> pieces_;
};

}  // namespace brachium::hill
