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

  // Sums in pairs (Estrin), so that fewer operations wait for one another.
  static double value(const std::array<double, 6>& c, double u) {
    const double u2 = u * u;
    return (c[0] + c[1] * u) + u2 * ((c[2] + c[3] * u) + u2 * (c[4] + c[5] * u));
  }
  static double value(const std::array<double, 5>& c, double u) {
    const double u2 = u * u;
    return (c[0] + c[1] * u) + u2 * ((c[2] + c[3] * u) + u2 * c[4]);
  }
  static double value(const std::array<double, 4>& c, double u) {
    return (c[0] + c[1] * u) + u * u * (c[2] + c[3] * u);
  }

  struct Piece {
    double x_start, x_end, inverse_cell;
    std::array<double, 6> x, y;    // x(u), y(u) in powers of u
    std::array<double, 5> dx, dy;  // their slopes
    std::array<double, 4> ddx;
    // u in powers of the place inside a cell of a uniform grid in x: the cubic that meets u and du/dx at both borders.
    // One cell more than there are, for rounding in the cell's number.
    std::array<std::array<double, 4>, kCells + 1> guess;

    data::CurveValue evaluate(double at) const {
      const double cell = (at - x_start) * inverse_cell;
      const std::size_t k = static_cast<std::size_t>(cell);
      double u = value(guess[k], cell - static_cast<double>(k));
      // Chebyshev's step of third order. The guess is within 4e-6 for the curves of Millard et al. and one step leaves
      // rounding; it is repeated where a curve bends more.
      double step;
      int count = 0;
      do {
        const double per_slope = 1.0 / value(dx, u);
        step = (at - value(x, u)) * per_slope;
        u += step - 0.5 * step * step * value(ddx, u) * per_slope;
      } while (std::abs(step) > 1e-5 && ++count < 8);
      return {value(y, u), value(dy, u) / value(dx, u)};
    }
  };

  Knot first_{0.0, 0.0, 0.0}, last_{0.0, 0.0, 0.0};
  std::vector<Piece> pieces_;
};

}  // namespace brachium::hill
