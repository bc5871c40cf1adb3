#include "hill/compiled_cubic.hpp"

#include <cassert>
#include <cmath>
#include <limits>

namespace brachium::hill {

CompiledCubic::CompiledCubic(const data::PiecewiseCubic& curve, data::Domain window)
    : lower_(window.lower), cells_per_unit_(kCells / (window.upper - window.lower)), domain_(curve.domain()) {
  assert(window.upper > window.lower);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::span<const double> x = curve.knots(), y = curve.knot_values(), slope = curve.knot_slopes();
  const std::size_t n = x.size();
  pieces_.push_back({-kInfinity, x[0], y[0], slope[0], 0.0, 0.0});
  for (std::size_t i = 0; i + 1 < n; ++i) {
    // The expressions of data::PiecewiseCubic, in its order, so that both give the same bits.
    const double h = x[i + 1] - x[i];
    const double d = (y[i + 1] - y[i]) / h;
    pieces_.push_back({x[i], x[i], y[i], slope[i], (3.0 * d - 2.0 * slope[i] - slope[i + 1]) / h,
                       (slope[i] + slope[i + 1] - 2.0 * d) / (h * h)});
  }
  // The last knot itself belongs to the last cubic.
  pieces_.push_back({std::nextafter(x[n - 1], kInfinity), x[n - 1], y[n - 1], slope[n - 1], 0.0, 0.0});
  pieces_.push_back({kInfinity, 0.0, 0.0, 0.0, 0.0, 0.0});

  first_.push_back(0);
  for (double cell = 1.0; cell <= kCells; cell += 1.0) {
    // One cell of slack below covers rounding in the argument's cell number.
    const double from = window.lower + (cell - 1.0) / cells_per_unit_;
    std::size_t i = first_.back();
    while (from >= pieces_[i + 1].start) ++i;
    first_.push_back(static_cast<std::uint16_t>(i));
  }
}

}  // namespace brachium::hill
