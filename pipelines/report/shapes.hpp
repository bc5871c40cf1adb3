#pragma once
/// The curves of one panel as SVG paths in the panel's own pixels.

#include <string>
#include <vector>

#include "pipelines/report/axis.hpp"
#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// The drawing area: axes, and its nominal size. The page may stretch the width; heights are true.
struct Panel {
  Axis x, y;
  double width_px = 0.0, height_px = 0.0;

  double px(double value) const;  ///< from the left; NaN where the axis cannot show it
  double py(double value) const;  ///< from the top
};

/// Number of colours; indices beyond it come again with another line style.
inline constexpr int kColours = 8;

/// CSS classes of a curve's colour and, beyond the first, its line style in print.
std::string colour_class(int colour);

/// The SVG elements of a series; `bar_slot` of `bar_slots`: which of several series of bars stands where in a
/// group.
std::string draw_series(const Series& series, int colour, const Panel& panel, int bar_slot, int bar_slots);

/// The small picture of a series in a legend, a complete <svg>.
std::string draw_swatch(Style style, int colour);

}  // namespace brachium::pipelines::report
