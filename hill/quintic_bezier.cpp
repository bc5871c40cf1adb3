#include "hill/quintic_bezier.hpp"

#include <fmt/format.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::hill {
namespace {

using Knot = QuinticBezier::Knot;

// Control points of one coordinate to powers of u.
std::array<double, 6> powers(double p0, double q0, double q1, double p1) {
  // Σ_j binomial(5, j) (1 - u)^(5-j) u^j P_j with P = (p0, q0, q0, q1, q1, p1).
  const double d0 = q0 - p0, d1 = q1 - q0, d2 = p1 - q1;
  return {p0, 5.0 * d0, -10.0 * d0, 10.0 * (d0 + d1), -5.0 * d0 - 15.0 * d1, d0 + 6.0 * d1 + d2};
}

template <std::size_t n>
double horner(const std::array<double, n>& c, double u) {
  double sum = c[n - 1];
  for (std::size_t i = n - 1; i > 0; --i) sum = sum * u + c[i - 1];
  return sum;
}

template <std::size_t n>
std::array<double, n - 1> slope(const std::array<double, n>& c) {
  std::array<double, n - 1> out;
  for (std::size_t i = 1; i < n; ++i) out[i - 1] = static_cast<double>(i) * c[i];
  return out;
}

// Root of the increasing polynomial x(u) = at on [0, 1].
double bisect(const std::array<double, 6>& x, double at) {
  double lower = 0.0, upper = 1.0;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (lower + upper);
    (horner(x, middle) < at ? lower : upper) = middle;
  }
  return 0.5 * (lower + upper);
}

}  // namespace

QuinticBezier::QuinticBezier(const std::vector<Knot>& knots, const std::vector<double>& curviness) {
  if (knots.size() < 2 || curviness.size() + 1 != knots.size()) {
    throw data::InputError("bad-curve",
                           fmt::format("a Bézier curve needs at least two knots and one curviness per piece, "
                                       "got {} and {}",
                                       knots.size(), curviness.size()));
  }
  first_ = knots.front();
  last_ = knots.back();
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const Knot& a = knots[i];
    const Knot& b = knots[i + 1];
    const double cut = 0.1 + 0.8 * curviness[i];
    if (!(curviness[i] >= 0.0 && curviness[i] <= 1.0) || !(b.x > a.x)) {
      throw data::InputError("bad-curve",
                             fmt::format("piece {} of a Bézier curve: x must increase and the curviness lie "
                                         "in [0, 1], got x {} to {}, curviness {}",
                                         i, a.x, b.x, curviness[i]));
    }
    const bool parallel = std::abs(a.slope - b.slope) < 1e-8;
    const double xc =
        parallel ? 0.5 * (a.x + b.x) : (b.y - a.y - b.x * b.slope + a.x * a.slope) / (a.slope - b.slope);
    const double yc = (xc - b.x) * b.slope + b.y;
    if (!(xc > a.x && xc < b.x)) {
      throw data::InputError(
          "bad-curve", fmt::format("piece {} of a Bézier curve: its end tangents meet at x = {}, outside "
                                   "[{}, {}]",
                                   i, xc, a.x, b.x));
    }
    Piece piece;
    piece.x_start = a.x;
    piece.x_end = b.x;
    piece.inverse_cell = static_cast<double>(kCells) / (b.x - a.x);
    piece.x = powers(a.x, a.x + cut * (xc - a.x), b.x + cut * (xc - b.x), b.x);
    piece.y = powers(a.y, a.y + cut * (yc - a.y), b.y + cut * (yc - b.y), b.y);
    piece.dx = slope(piece.x);
    piece.dy = slope(piece.y);
    piece.ddx = slope(piece.dx);
    double u0 = 0.0;
    for (std::size_t k = 0; k < kCells; ++k) {
      const double u1 = bisect(piece.x, a.x + static_cast<double>(k + 1) / piece.inverse_cell);
      const double d0 = 1.0 / (piece.inverse_cell * horner(piece.dx, u0)),
                   d1 = 1.0 / (piece.inverse_cell * horner(piece.dx, u1));
      piece.guess[k] = {u0, d0, 3.0 * (u1 - u0) - 2.0 * d0 - d1, 2.0 * (u0 - u1) + d0 + d1};
      u0 = u1;
    }
    piece.guess[kCells] = {1.0, 0.0, 0.0, 0.0};
    pieces_.push_back(piece);
  }
}

}  // namespace brachium::hill
