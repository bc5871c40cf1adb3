#include "hill/compiled_cubic.hpp"

#include <algorithm>
#include <cassert>

namespace brachium::hill {

CompiledCubic::CompiledCubic(const data::PiecewiseCubic& curve, data::Domain window) : window_(window) {
  assert(window.upper > window.lower);
  const std::span<const double> x = curve.knots(), slope = curve.knot_slopes();
  const std::size_t n = x.size();
  for (std::size_t i = 0; i < n; ++i) {
    Piece p{x[i], curve(x[i]).value, slope[i], 0.0, 0.0};
    if (i + 1 < n) {
      // The expressions of data::PiecewiseCubic, in its order, so that both give the same bits.
      const double h = x[i + 1] - x[i];
      const double d = (curve(x[i + 1]).value - p.y) / h;
      p.c2 = (3.0 * d - 2.0 * slope[i] - slope[i + 1]) / h;
      p.c3 = (slope[i] + slope[i + 1] - 2.0 * d) / (h * h);
    }
    pieces_.push_back(p);
  }

  constexpr std::size_t kCells = 512;
  cells_ = kCells;
  inverse_cell_ = kCells / (window.upper - window.lower);
  for (std::size_t c = 0; c <= kCells; ++c) {
    // One cell of slack below covers rounding in the argument's cell number.
    const double from = c == 0 ? window.lower : window.lower + (static_cast<double>(c) - 1.0) / inverse_cell_;
    const auto above = std::upper_bound(x.begin() + 1, x.end() - 1, from);
    first_.push_back(static_cast<std::uint16_t>(above - x.begin() - 1));
  }
}

}  // namespace brachium::hill
