#pragma once
/// The range an axis shows and where a value lies on it.

#include <optional>
#include <vector>

#include "pipelines/report/document.hpp"
#include "pipelines/report/ticks.hpp"

namespace brachium::pipelines::report {

struct Axis {
  double lower = 0.0, upper = 1.0;  ///< lower < upper; both > 0 if log
  bool log = false;

  /// 0 at `lower`, 1 at `upper`; NaN for what the axis cannot show (not finite, or <= 0 on a logarithmic
  /// axis).
  double position(double value) const;
  std::vector<Tick> ticks(int intervals) const;
};

/// Smallest and largest of the values an axis can show, and how many it cannot.
class Extent {
 public:
  explicit Extent(bool log) : log_(log) {}
  void include(double value);
  bool empty() const { return !(lower_ <= upper_); }
  double lower() const { return lower_; }
  double upper() const { return upper_; }
  std::size_t left_out() const {
    return left_out_;
  }  ///< infinite, or <= 0 on a logarithmic axis; NaN is a wanted gap

 private:
  bool log_;
  double lower_ = 1.0, upper_ = 0.0;
  std::size_t left_out_ = 0;
};

/// An axis around an extent, with `margin` of its length free on both sides; bounds that are given stand as
/// they are. What is nowhere negative gets no negative room. A constant gets room on both sides; nothing at
/// all gives [0, 1], or [1, 10] if log.
Axis make_axis(const Extent& extent, bool log, double margin, std::optional<double> lower,
               std::optional<double> upper);

/// Extents of what one panel draws: series (with the baseline of bars and areas), levels.
Extent x_extent(const Plot& plot, bool log);
Extent y_extent(const Plot& plot);

}  // namespace brachium::pipelines::report
