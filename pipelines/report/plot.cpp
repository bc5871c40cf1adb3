#include "pipelines/report/plot.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "pipelines/report/axis.hpp"
#include "pipelines/report/legend.hpp"
#include "pipelines/report/marks.hpp"
#include "pipelines/report/number.hpp"
#include "pipelines/report/shapes.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr double kYLabelHeight = 22.0;  // [px] line above a panel that names its y axis
constexpr double kLaneHeight = 13.0;    // [px] line of marker labels
constexpr double kTickHeight = 18.0;    // [px] numbers under the x axis
constexpr double kTickSize = 11.0;      // [px] lettering of numbers
constexpr double kXLabelHeight = 18.0;
constexpr double kPanelGap = 8.0;
constexpr double kRightPadding = 14.0;  // half of the last number of the x axis
constexpr double kNarrowest = 360.0;    // [px] width of a plot on a small screen
constexpr int kTypicalIntervals = 6;    // of an x axis
constexpr double kSquare = 300.0;       // [px] least side of a plot with equal axes

void check(const Plot& plot) {
  const auto fail = [&](const std::string& what) {
    throw std::logic_error("plot `" + plot.title + "`: " + what);
  };
  for (const Series& series : plot.series) {
    if (series.x.size() != series.y.size())
      fail("series `" + series.label + "` has x and y of different length");
    if (!series.y_lower.empty() && series.y_lower.size() != series.y.size()) {
      fail("series `" + series.label + "` has y and y_lower of different length");
    }
  }
}

int y_intervals(double height) {
  return std::clamp(static_cast<int>(height / 26.0), 3, 7);
}

/// Equal axes carry the same numbers.
int x_intervals(const Plot& plot, double width) {
  return plot.equal_axes ? y_intervals(width) : std::clamp(static_cast<int>(width / 85.0), 3, 8);
}

double side(const Plot& plot) {
  return plot.equal_axes ? std::max(plot.height_px, kSquare) : plot.height_px;
}

bool has(const Plot& plot, Style style) {
  return std::any_of(plot.series.begin(), plot.series.end(),
                     [&](const Series& s) { return s.style == style; });
}

double x_margin(const Plot& plot) {
  if (!plot.categories.empty() || has(plot, Style::bars))
    return 0.0;  // the bars' own half width is added instead
  return has(plot, Style::points) ? 0.03 : 0.0;
}

/// The x axis that all panels share.
Axis shared_x(const Plot& plot) {
  Extent extent = x_extent(plot, plot.log_x);
  for (const Plot& panel : plot.below) {
    const Extent other = x_extent(panel, plot.log_x);
    if (!other.empty()) {
      extent.include(other.lower());
      extent.include(other.upper());
    }
  }
  const bool bars = !plot.categories.empty() || has(plot, Style::bars);
  if (bars && !plot.log_x && !extent.empty()) {
    double pitch = plot.categories.empty() ? extent.upper() - extent.lower() : 1.0;
    for (const Series& series : plot.series) {
      std::vector<double> x = series.x;
      std::erase_if(x, [](double v) { return !std::isfinite(v); });
      std::sort(x.begin(), x.end());
      for (std::size_t i = 1; i < x.size(); ++i) {
        if (x[i] > x[i - 1]) pitch = std::min(pitch, x[i] - x[i - 1]);
      }
    }
    const double room = pitch > 0.0 ? 0.5 * pitch : 0.5;
    return make_axis(extent, false, 0.0, plot.x_min.value_or(extent.lower() - room),
                     plot.x_max.value_or(extent.upper() + room));
  }
  Axis axis = make_axis(extent, plot.log_x, x_margin(plot), plot.x_min, plot.x_max);
  if (!plot.log_x && !plot.x_max && !extent.empty()) {
    // A recording that ends a sample before a round number still shows that number.
    const double step = nice_step(axis.upper - axis.lower, kTypicalIntervals);
    const double round_end = std::ceil(axis.upper / step) * step;
    if (round_end - axis.upper < 0.01 * (axis.upper - axis.lower)) axis.upper = round_end;
  }
  return axis;
}

Axis y_axis(const Plot& plot) {
  return make_axis(y_extent(plot), plot.log_y, 0.05, plot.y_min, plot.y_max);
}

/// Both axes over the union of their ranges.
void make_equal(Axis& x, Axis& y) {
  x.lower = y.lower = std::min(x.lower, y.lower);
  x.upper = y.upper = std::max(x.upper, y.upper);
}

std::string percent_of(double fraction) {
  return fixed(100.0 * fraction, 2) + "%";
}

/// Names of categories that do not fit beside each other are turned and need more height [px], else 0.
double categories_height(const Plot& plot, double width) {
  double widest = 0.0;
  for (const std::string& name : plot.categories) widest = std::max(widest, text_width(name, kTickSize));
  const double slot =
      std::min(width, kNarrowest) / std::max(1.0, static_cast<double>(plot.categories.size()));
  return widest + 4.0 > slot ? 0.6 * widest : 0.0;  // sine of the angle
}

std::string x_ticks(const Plot& plot, const Axis& x, double width, double top) {
  std::string out;
  const auto text = [&](double value, const std::string& label) {
    out += "<text class=\"t\" text-anchor=\"middle\" x=\"" + percent_of(x.position(value)) + "\" y=\"" +
           pixels(top + 14.0) + "\">" + escape(label) + "</text>";
  };
  // A text that is turned needs a place of its own to turn about.
  const auto slanted = [&](double value, const std::string& label) {
    out +=
        "<svg x=\"" + percent_of(x.position(value)) + "\" y=\"" + pixels(top + 12.0) +
        "\" overflow=\"visible\"><text class=\"t\" text-anchor=\"end\" transform=\"rotate(-35)\" x=\"3\">" +
        escape(label) + "</text></svg>";
  };
  if (plot.categories.empty()) {
    for (const Tick& tick : x.ticks(x_intervals(plot, width))) text(tick.value, tick.label);
  }
  const bool crowded = categories_height(plot, width) > 0.0;
  for (std::size_t k = 0; k < plot.categories.size(); ++k) {
    const double at = static_cast<double>(k);
    crowded ? slanted(at, plot.categories[k]) : text(at, plot.categories[k]);
  }
  return out;
}

/// Grid, bands, curves and lines of one panel, clipped to its frame, plus the numbers at its left.
std::string draw_panel(const Plot& plot, const Plot& panel_plot, const Panel& panel,
                       std::span<const int> colours, double top) {
  const double w = panel.width_px;
  const double h = panel.height_px;
  std::string grid;
  std::string numbers;
  if (plot.categories.empty()) {
    for (const Tick& tick : panel.x.ticks(x_intervals(plot, w))) {
      grid += "M" + pixels(panel.px(tick.value)) + " 0v" + pixels(h);
    }
  }
  for (const Tick& tick : panel.y.ticks(y_intervals(h))) {
    const double y = panel.py(tick.value);
    grid += "M0 " + pixels(y) + "h" + pixels(w);
    numbers += "<text class=\"t\" text-anchor=\"end\" x=\"-7\" y=\"" + pixels(top + y + 4.0) + "\">" +
               escape(tick.label) + "</text>";
  }
  std::string out = "<svg class=\"panel\" y=\"" + pixels(top) + "\" width=\"100%\" height=\"" + pixels(h) +
                    "\" viewBox=\"0 0 " + pixels(w) + " " + pixels(h) + "\" preserveAspectRatio=\"none\"" +
                    axis_attributes(panel.x, panel.y) + ">";
  out += "<rect class=\"ground\" width=\"100%\" height=\"100%\"/>";
  for (const Marker& marker : plot.markers) out += draw_marker_area(marker, panel);
  out += "<path class=\"grid\" d=\"" + grid + "\"/>";
  if (!panel.y.log && panel.y.lower < 0.0 && panel.y.upper > 0.0) {
    out += "<path class=\"zero\" d=\"M0 " + pixels(panel.py(0.0)) + "h" + pixels(w) + "\"/>";
  }
  if (panel_plot.equal_axes) {
    out += "<path class=\"mark plain\" d=\"M0 " + pixels(h) + "L" + pixels(w) + " 0\"/>";
  }
  const int slots = static_cast<int>(std::count_if(panel_plot.series.begin(), panel_plot.series.end(),
                                                   [](const Series& s) { return s.style == Style::bars; }));
  int slot = 0;
  for (std::size_t k = 0; k < panel_plot.series.size(); ++k) {
    const Series& series = panel_plot.series[k];
    out += draw_series(series, colours[k], panel, slot, std::max(1, slots));
    if (series.style == Style::bars) ++slot;
  }
  for (const Marker& marker : plot.markers) out += draw_marker_line(marker, panel);
  for (const Level& level : panel_plot.levels) out += draw_level(level, panel);
  out += "<path class=\"frame\" d=\"M0 0V" + pixels(h) + "H" + pixels(w) + "\"/></svg>";
  if (y_extent(panel_plot).empty()) {
    out += "<text class=\"t\" text-anchor=\"middle\" x=\"50%\" y=\"" + pixels(top + h / 2.0) +
           "\">no data</text>";
  }
  return out + numbers + draw_level_labels(panel_plot.levels, panel, top);
}

/// Values that no axis can show are not dropped without a word.
std::string left_out_sentence(const Plot& plot) {
  std::size_t count = 0;
  const auto add = [&](const Plot& panel) {
    count += x_extent(panel, plot.log_x).left_out() + y_extent(panel).left_out();
  };
  add(plot);
  for (const Plot& panel : plot.below) add(panel);
  if (count == 0) return "";
  return std::to_string(count) + (count == 1 ? " value is" : " values are") + " not drawn: infinite" +
         (plot.log_x || plot.log_y ? ", or not positive on a logarithmic axis." : ".");
}

std::string description(const Plot& plot, const Axis& x, const Axis& y) {
  std::string names;
  for (const Series& series : plot.series) {
    if (!series.label.empty()) names += (names.empty() ? "" : ", ") + series.label;
  }
  std::string out = typeset_label(plot.y_label);
  if (!plot.x_label.empty()) out += " against " + typeset_label(plot.x_label);
  if (!names.empty()) out += (out.empty() ? "" : ": ") + names;
  if (!out.empty()) out += ". ";
  return out + "Shown from " + significant(x.lower, 3) + " to " + significant(x.upper, 3) + " and from " +
         significant(y.lower, 3) + " to " + significant(y.upper, 3) + ".";
}

}  // namespace

double left_padding(const Plot& plot) {
  double widest_px = 12.0;
  const auto measure = [&](const Plot& panel) {
    Axis y = y_axis(panel);
    if (panel.equal_axes) {
      Axis x = shared_x(panel);
      make_equal(x, y);
    }
    for (const Tick& tick : y.ticks(y_intervals(side(panel)))) {
      widest_px = std::max(widest_px, text_width(tick.label, kTickSize));
    }
  };
  measure(plot);
  for (const Plot& panel : plot.below) measure(panel);
  return std::ceil(widest_px + 12.0);
}

std::string draw_plot(const Plot& plot, const PlotFrame& frame) {
  check(plot);
  for (const Plot& panel : plot.below) {
    check(panel);
    if (!panel.below.empty())
      throw std::logic_error("plot `" + plot.title + "`: a panel below has panels below it");
  }
  const double left = std::max(frame.left_px, left_padding(plot));
  double right = std::max(kRightPadding, level_padding(plot.levels));
  for (const Plot& panel : plot.below) right = std::max(right, level_padding(panel.levels));
  const double width = plot.equal_axes ? side(plot) : std::max(120.0, frame.width_px - left - right);

  Axis x = shared_x(plot);
  Axis first_y = y_axis(plot);
  if (plot.equal_axes) make_equal(x, first_y);
  const std::vector<int> colours = assign_colours(plot);
  const MarkerLabels labels = place_marker_labels(plot.markers, x, width);

  std::string body;
  double top = 0.0;
  std::size_t drawn = 0;
  const auto add_panel = [&](const Plot& panel_plot, const Axis& y, bool first) {
    const std::string y_label = typeset_label(panel_plot.y_label);
    if (!y_label.empty()) {
      body += "<text class=\"yl\" x=\"" + pixels(-left) + "\" y=\"" + pixels(top + 11.0) + "\">" +
              escape(y_label) + "</text>";
      top += kYLabelHeight;
    } else {
      top += 8.0;  // half of the highest number
    }
    if (first) {
      body += draw_marker_labels(labels, top, kLaneHeight);
      top += labels.lanes * kLaneHeight;
    }
    const Panel panel{.x = x, .y = y, .width_px = width, .height_px = side(panel_plot)};
    body +=
        draw_panel(plot, panel_plot, panel, std::span(colours).subspan(drawn, panel_plot.series.size()), top);
    drawn += panel_plot.series.size();
    top += panel.height_px;
  };
  add_panel(plot, first_y, true);
  for (const Plot& panel : plot.below) {
    top += kPanelGap;
    add_panel(panel, y_axis(panel), false);
  }
  body += x_ticks(plot, x, width, top);
  top += kTickHeight + categories_height(plot, width);
  if (!plot.x_label.empty()) {
    body += "<text class=\"xl\" text-anchor=\"middle\" x=\"50%\" y=\"" + pixels(top + 12.0) + "\">" +
            escape(typeset_label(plot.x_label)) + "</text>";
    top += kXLabelHeight;
  }

  std::string out = "<figure class=\"plot\">";
  if (!plot.title.empty()) out += "<figcaption>" + inline_markup(plot.title) + "</figcaption>";
  if (frame.legend) out += draw_legend(plot);
  const std::string size = plot.equal_axes ? ";width:" + pixels(width + left + right) + "px" : "";
  out += "<svg class=\"plot\" role=\"img\" height=\"" + pixels(top) + "\" style=\"padding:0 " +
         pixels(right) + "px 0 " + pixels(left) + "px" + size + "\"><title>" +
         escape(plain_text(plot.title.empty() ? plot.y_label : plot.title)) + "</title><desc>" +
         escape(description(plot, x, first_y)) + "</desc>" + body + "</svg>";
  const std::string left_out = left_out_sentence(plot);
  if (!plot.note.empty() || !left_out.empty()) {
    out += "<p class=\"note\">" +
           inline_markup(plot.note + (plot.note.empty() || left_out.empty() ? "" : " ") + left_out) + "</p>";
  }
  return out + "</figure>\n";
}

}  // namespace brachium::pipelines::report
