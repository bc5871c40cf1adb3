#pragma once
/// A plot as a static picture. Its height and its lettering are fixed in pixels; its width is whatever the
/// page gives: positions along x are fractions of the width, so that nothing shrinks on a narrow screen or on
/// paper.

#include <string>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// What the page decides about a plot.
struct PlotFrame {
  double width_px = 960.0;  ///< likely width, paddings included: how many ticks, how far a series is thinned
  double left_px =
      0.0;             ///< at least this much room for the numbers of the y axis, so that neighbours line up
  bool legend = true;  ///< false: the row has one for all
};

/// Room that the numbers of the y axes need [px].
double left_padding(const Plot& plot);

/// The plot as an HTML <figure>. Throws std::logic_error where the plot contradicts itself (see html.hpp).
std::string draw_plot(const Plot& plot, const PlotFrame& frame);

}  // namespace brachium::pipelines::report
