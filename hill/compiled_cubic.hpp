#pragma once
/// A data::PiecewiseCubic laid out for inner loops: the same numbers to the last bit, without the binary
/// search.
///
/// A uniform grid over a window that holds the knots maps an argument to the first piece it can lie in; from
/// there at most a few knots are stepped over. The tails beyond the first and the last knot are pieces like
/// the others.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "data/model/curve.hpp"

namespace brachium::hill {

class CompiledCubic {
 public:
  CompiledCubic() = default;
  /// `window` should hold the closely spaced knots; any non-empty window is correct.
  CompiledCubic(const data::PiecewiseCubic& curve, data::Domain window);

  data::CurveValue operator()(double x) const { return find(x)->evaluate(x); }

  /// The same, trying the piece of the call before first: in a smooth sequence of arguments the processor
  /// predicts that branch and need not wait for the look-up. `hint` starts at 0 and belongs to one curve.
  data::CurveValue at(double x, std::uint32_t& hint) const {
    const Piece* p = pieces_.data() + hint;
    if (!(x >= p[0].start && x < p[1].start)) {
      p = find(x);
      hint = static_cast<std::uint32_t>(p - pieces_.data());
    }
    return p->evaluate(x);
  }

  data::Domain domain() const { return domain_; }

 private:
  static constexpr double kCells = 512.0;
  struct Piece {
    double start;            // where the piece begins
    double x, y, s, c2, c3;  // y + s t + c2 t² + c3 t³, t = argument - x

    data::CurveValue evaluate(double at) const {
      const double t = at - x;
      return {y + t * (s + t * (c2 + t * c3)), s + t * (2.0 * c2 + t * 3.0 * c3)};
    }
  };

  const Piece* find(double x) const {
    // In this order of arguments NaN becomes cell 0.
    const double cell = std::max(0.0, std::min((x - lower_) * cells_per_unit_, kCells));
    const Piece* p = pieces_.data() + first_[static_cast<std::size_t>(static_cast<std::int32_t>(cell))];
    while (x >= p[1].start) ++p;
    return p;
  }

  std::vector<Piece> pieces_;         // the last one only marks the end, at infinity
  std::vector<std::uint16_t> first_;  // per cell, and one for everything above the window
  double lower_ = 0.0, cells_per_unit_ = 0.0;
  data::Domain domain_{0.0, 0.0};
};

}  // namespace brachium::hill
