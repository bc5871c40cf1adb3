#pragma once
/// A data::PiecewiseCubic laid out for inner loops: the same numbers to the last bit, without the binary search.
///
/// A uniform grid over a window that holds the knots maps an argument to the first interval it can lie in; from
/// there at most a few knots are stepped over. Outside the window the search walks outwards from its border.

#include <cstdint>
#include <vector>

#include "data/model/curve.hpp"

namespace brachium::hill {

class CompiledCubic {
 public:
  CompiledCubic() = default;
  /// `window` should hold the closely spaced knots; any non-empty window is correct.
  CompiledCubic(const data::PiecewiseCubic& curve, data::Domain window);

  data::CurveValue operator()(double x) const {
    const std::size_t last = pieces_.size() - 2;  // index of the last interval; pieces_ ends with the end point
    if (x < pieces_.front().x) return beyond(pieces_.front(), x);
    if (x > pieces_[last + 1].x) return beyond(pieces_[last + 1], x);
    std::size_t i = 0;
    if (x >= window_.lower) {
      const double cell = (x - window_.lower) * inverse_cell_;
      i = first_[cell < cells_ ? static_cast<std::size_t>(cell) : first_.size() - 1];
    }
    while (i < last && x >= pieces_[i + 1].x) ++i;
    const Piece& p = pieces_[i];
    const double t = x - p.x;
    return {p.y + t * (p.s + t * (p.c2 + t * p.c3)), p.s + t * (2.0 * p.c2 + t * 3.0 * p.c3)};
  }

  data::Domain domain() const { return {pieces_.front().x, pieces_.back().x}; }

 private:
  struct Piece {
    double x, y, s, c2, c3;
  };
  static data::CurveValue beyond(const Piece& end, double x) { return {end.y + end.s * (x - end.x), end.s}; }

  std::vector<Piece> pieces_;
  std::vector<std::uint16_t> first_;  // per cell, and one for everything above the window
  data::Domain window_{0.0, 0.0};
  double inverse_cell_ = 0.0;
  double cells_ = 0.0;
};

}  // namespace brachium::hill
