#include "hill/lloyd_2003.hpp"

namespace brachium::hill {
namespace {

data::PiecewiseCubic interpolate(Lloyd2003::Interpolant kind, const Lloyd2003::Points& points) {
  return kind == Lloyd2003::Interpolant::monotone ? data::PiecewiseCubic::monotone(points.x, points.y)
                                                  : data::PiecewiseCubic::forsythe(points.x, points.y);
}

// The window without the far outer points, which only carry the curve's tails.
CompiledCubic compile(Lloyd2003::Interpolant kind, const Lloyd2003::Points& points) {
  const data::PiecewiseCubic curve = interpolate(kind, points);
  const std::size_t n = points.x.size();
  if (n < 5) return CompiledCubic(curve, curve.domain());
  // The widest gap in the upper half ends the window: behind it lie tail points only.
  std::size_t upper = n - 2;
  for (std::size_t i = n / 2; i + 1 < n; ++i) {
    if (points.x[i + 1] - points.x[i] > 0.5 * (points.x[i] - points.x[1])) {
      upper = i;
      break;
    }
  }
  return CompiledCubic(curve, {points.x[1], points.x[upper]});
}

}  // namespace

Lloyd2003::Lloyd2003(Interpolant interpolant, const Table& table)
    : interpolant_(interpolant),
      active_(compile(interpolant, table.active)),
      passive_(compile(interpolant, table.passive)),
      velocity_(compile(interpolant, table.velocity)),
      tendon_(compile(interpolant, table.tendon)) {}

Lloyd2003::Table Lloyd2003::published() {
  Table t;
  t.active.x = {-5,    0,      0.401,   0.402,   0.4035, 0.52725, 0.62875, 0.71875, 0.86125,
                1.045, 1.2175, 1.43875, 1.61875, 1.62,   1.621,   2.2,     5};
  t.active.y = {0, 0, 0, 0, 0, 0.226667, 0.636667, 0.856667, 0.95, 0.993333, 0.77, 0.246667, 0, 0, 0, 0, 0};
  t.passive.x = {-5, 0.998, 0.999, 1, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6, 1.601, 1.602, 5};
  t.passive.y = {0, 0, 0, 0, 0.035, 0.12, 0.26, 0.55, 1.17, 2, 2, 2, 2};
  t.velocity.x = {-10, -1, -0.6, -0.3, -0.1, 0, 0.1, 0.3, 0.6, 0.8, 10};
  t.velocity.y = {0, 0, 0.08, 0.2, 0.55, 1, 1.4, 1.6, 1.7, 1.75, 1.75};
  t.tendon.x = {-10,     -0.002, -0.001, 0,      0.00131, 0.00281, 0.00431, 0.00581, 0.00731,
                0.00881, 0.0103, 0.0118, 0.0123, 9.2,     9.201,   9.202,   20};
  t.tendon.y = {0,     0,     0,     0,     0.0108, 0.0257, 0.0435, 0.0652, 0.0915,
                0.123, 0.161, 0.208, 0.227, 345,    345,    345,    345};
  return t;
}

}  // namespace brachium::hill
