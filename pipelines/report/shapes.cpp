#include "pipelines/report/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipelines/report/number.hpp"
#include "pipelines/report/path.hpp"
#include "pipelines/report/thin.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr double kDense = 3.0;            // samples kept for each pixel column
constexpr std::size_t kManyPoints = 500;  // drawn smaller
constexpr double kFar = 1e5;  // [px] what lies this far outside the panel may be drawn anywhere outside

double bounded(double px) {
  return std::clamp(px, -kFar, kFar);
}  // NaN stays NaN

struct Pixels {
  std::vector<double> x, y;
};

Pixels to_pixels(const std::vector<double>& x, const std::vector<double>& y, const Panel& panel) {
  Pixels pixels;
  pixels.x.reserve(x.size());
  pixels.y.reserve(y.size());
  for (const double v : x) pixels.x.push_back(panel.px(v));
  for (const double v : y) pixels.y.push_back(panel.py(v));
  return pixels;
}

std::string element(const std::string& classes, const std::string& d) {
  return d.empty() ? "" : "<path class=\"" + classes + "\" d=\"" + d + "\"/>";
}

/// More than the eye can follow: a recording that fills its columns. Drawn lighter, so that what lies on it
/// is seen.
bool is_dense(const std::vector<std::size_t>& kept, const Panel& panel) {
  return static_cast<double>(kept.size()) > kDense * panel.width_px;
}

std::string line(const Pixels& at, const std::vector<std::size_t>& kept, bool step) {
  PathWriter path;
  std::size_t run = 0;  // samples since the last break
  double last_x = 0.0;
  double last_y = 0.0;
  const auto end_run = [&] {
    if (run == 1) {  // a sample between two gaps
      path.move_to(last_x - 1.0, last_y);
      path.line_to(last_x + 1.0, last_y);
    }
    run = 0;
  };
  for (const std::size_t i : kept) {
    const double x = at.x[i];
    const double y = at.y[i];
    if (std::isnan(x) || std::isnan(y)) {
      end_run();
      continue;
    }
    if (run == 1) path.move_to(last_x, last_y);
    if (run > 0) {
      if (step) path.line_to(x, last_y);
      path.line_to(x, y);
    }
    last_x = x;
    last_y = y;
    ++run;
  }
  end_run();
  return path.text();
}

std::string points(const Pixels& at) {
  PathWriter path;
  for (const std::size_t i : thin_points(at.x, at.y)) path.dot(at.x[i], at.y[i]);
  return path.text();
}

/// A band: there along the upper edge, back along the lower one, for each stretch without gaps.
std::string area(const Pixels& upper, const std::vector<double>& lower_y) {
  PathWriter path;
  const std::size_t n = upper.x.size();
  const auto broken = [&](std::size_t i) {
    return std::isnan(upper.x[i]) || std::isnan(upper.y[i]) || std::isnan(lower_y[i]);
  };
  for (std::size_t begin = 0; begin < n;) {
    if (broken(begin)) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < n && !broken(end)) ++end;
    const std::size_t count = end - begin;
    const std::span<const double> xs = std::span(upper.x).subspan(begin, count);
    const std::span<const double> tops = std::span(upper.y).subspan(begin, count);
    const std::span<const double> bottoms = std::span(lower_y).subspan(begin, count);
    path.move_to(xs[0], bottoms[0]);
    for (const std::size_t i : thin_line(xs, tops)) path.line_to(xs[i], tops[i]);
    const std::vector<std::size_t> back = thin_line(xs, bottoms);
    for (auto i = back.rbegin(); i != back.rend(); ++i) path.line_to(xs[*i], bottoms[*i]);
    path.close();
    begin = end;
  }
  return path.text();
}

/// Distance between neighbouring bars [px]: the smallest gap between different x.
double bar_pitch(const Pixels& at, const Panel& panel) {
  std::vector<double> x;
  std::copy_if(at.x.begin(), at.x.end(), std::back_inserter(x), [](double v) { return !std::isnan(v); });
  std::sort(x.begin(), x.end());
  double pitch = panel.width_px;
  for (std::size_t i = 1; i < x.size(); ++i) {
    if (x[i] > x[i - 1]) pitch = std::min(pitch, x[i] - x[i - 1]);
  }
  return x.size() < 2 ? panel.width_px / 3.0 : pitch;
}

std::string bars(const Pixels& at, const Panel& panel, int slot, int slots) {
  PathWriter path;
  const double group = 0.8 * bar_pitch(at, panel);
  const double width = group / slots;
  const double floor_value = panel.y.log ? panel.y.lower : 0.0;
  const double base = panel.py(floor_value);
  for (std::size_t i = 0; i < at.x.size(); ++i) {
    if (std::isnan(at.x[i]) || std::isnan(at.y[i])) continue;
    const double left = at.x[i] - group / 2.0 + slot * width;
    path.move_to(left, base);
    path.line_to(left, at.y[i]);
    path.line_to(left + width, at.y[i]);
    path.line_to(left + width, base);
    path.close();
  }
  return path.text();
}

}  // namespace

double Panel::px(double value) const {
  return bounded(width_px * x.position(value));
}
double Panel::py(double value) const {
  return bounded(height_px * (1.0 - y.position(value)));
}

std::string colour_class(int colour) {
  const int index = std::max(colour, 0);
  std::string classes = "c" + std::to_string(index % kColours);
  if (index >= kColours) classes += " r";  // round again: dashed on screen too
  return classes;
}

std::string draw_series(const Series& series, int colour, const Panel& panel, int bar_slot, int bar_slots) {
  const std::string classes = colour_class(colour);
  const Pixels at = to_pixels(series.x, series.y, panel);
  switch (series.style) {
    case Style::line:
    case Style::dashed:
    case Style::step: {
      const std::vector<std::size_t> kept = thin_line(at.x, at.y);
      const std::string kind = series.style == Style::dashed ? "l d "
                               : is_dense(kept, panel)       ? "l dense "
                                                             : "l ";
      return element(kind + classes, line(at, kept, series.style == Style::step));
    }
    case Style::points:
      return element((at.x.size() > kManyPoints ? "p many " : "p ") + classes, points(at));
    case Style::bars:
      return element("a " + classes, bars(at, panel, bar_slot, bar_slots));
    case Style::area: {
      std::vector<double> lower;
      const double base = panel.y.log ? panel.y.lower : 0.0;
      for (std::size_t i = 0; i < series.y.size(); ++i) {
        lower.push_back(panel.py(series.y_lower.empty() ? base : series.y_lower[i]));
      }
      return element("b " + classes, area(at, lower));
    }
  }
  return "";
}

std::string draw_swatch(Style style, int colour) {
  const std::string classes = colour_class(colour);
  std::string shape;
  switch (style) {
    case Style::line:
      shape = element("l " + classes, "M1 6h22");
      break;
    case Style::dashed:
      shape = element("l d " + classes, "M1 6h22");
      break;
    case Style::step:
      shape = element("l " + classes, "M1 10h8v-7h7v4h7");
      break;
    case Style::points:
      shape = element("p " + classes, "M4 8h0M12 4h0M20 7h0");
      break;
    case Style::bars:
      shape = element("a " + classes, "M3 11v-6h5v6zM10 11v-10h5v10zM17 11v-4h5v4z");
      break;
    case Style::area:
      shape = element("b " + classes, "M1 2h22v8h-22z");
      break;
  }
  return "<svg class=\"k\" width=\"24\" height=\"12\" aria-hidden=\"true\">" + shape + "</svg>";
}

}  // namespace brachium::pipelines::report
