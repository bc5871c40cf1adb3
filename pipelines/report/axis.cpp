#include "pipelines/report/axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brachium::pipelines::report {
namespace {

constexpr double kLargest = 1e300;    // beyond it the length of an axis may overflow
constexpr double kSmallest = 1e-300;  // below it the ratio of a logarithmic axis may

bool can_show(double value, bool log) {
  return std::abs(value) < kLargest && (!log || value > kSmallest);
}

}  // namespace

double Axis::position(double value) const {
  if (!can_show(value, log)) return std::numeric_limits<double>::quiet_NaN();
  if (log) return std::log(value / lower) / std::log(upper / lower);
  return (value - lower) / (upper - lower);
}

std::vector<Tick> Axis::ticks(int intervals) const {
  return log ? log_ticks(lower, upper, intervals) : linear_ticks(lower, upper, intervals);
}

void Extent::include(double value) {
  if (std::isnan(value)) return;
  if (!can_show(value, log_)) {
    ++left_out_;
    return;
  }
  const bool first = empty();
  lower_ = first ? value : std::min(lower_, value);
  upper_ = first ? value : std::max(upper_, value);
}

Axis make_axis(const Extent& extent, bool log, double margin, std::optional<double> lower,
               std::optional<double> upper) {
  Axis axis{.lower = log ? 1.0 : 0.0, .upper = log ? 10.0 : 1.0, .log = log};
  if (!extent.empty()) {
    axis.lower = extent.lower();
    axis.upper = extent.upper();
    if (log) {
      const double factor = axis.upper > axis.lower ? std::pow(axis.upper / axis.lower, margin) : 3.0;
      axis.lower /= factor;
      axis.upper *= factor;
    } else {
      // A range that rounding alone may have made is a constant.
      const double size = std::max(std::abs(axis.lower), std::abs(axis.upper));
      const double span = axis.upper - axis.lower;
      const bool constant = !(span > 1e-12 * size);
      const double room = constant ? (size > 0.0 ? 0.1 * size : 1.0) : margin * span;
      axis.lower = axis.lower >= 0.0 ? std::max(0.0, axis.lower - room) : axis.lower - room;
      axis.upper = axis.upper <= 0.0 && !constant ? std::min(0.0, axis.upper + room) : axis.upper + room;
    }
  }
  if (lower && can_show(*lower, log)) axis.lower = *lower;
  if (upper && can_show(*upper, log)) axis.upper = *upper;
  if (!(axis.lower < axis.upper)) {  // one bound was given beyond all data
    const double room = std::max(1.0, std::abs(axis.lower));
    if (lower) {
      axis.upper = log ? axis.lower * 10.0 : axis.lower + room;
    } else {
      axis.lower = log ? axis.upper / 10.0 : axis.upper - room;
    }
  }
  return axis;
}

Extent x_extent(const Plot& plot, bool log) {
  Extent extent(log);
  for (const Series& series : plot.series) {
    for (const double x : series.x) extent.include(x);
  }
  for (std::size_t k = 0; k < plot.categories.size(); ++k) extent.include(static_cast<double>(k));
  return extent;
}

Extent y_extent(const Plot& plot) {
  Extent extent(plot.log_y);
  for (const Series& series : plot.series) {
    for (const double y : series.y) extent.include(y);
    for (const double y : series.y_lower) extent.include(y);
    const bool from_zero =
        series.style == Style::bars || (series.style == Style::area && series.y_lower.empty());
    if (from_zero && !plot.log_y && !extent.empty()) extent.include(0.0);
  }
  for (const Level& level : plot.levels) extent.include(level.y);
  return extent;
}

}  // namespace brachium::pipelines::report
