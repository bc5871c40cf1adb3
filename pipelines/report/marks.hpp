#pragma once
/// Markers (vertical lines, shaded spans) and levels (horizontal lines) of a plot, and where their names
/// stand.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipelines/report/axis.hpp"
#include "pipelines/report/document.hpp"
#include "pipelines/report/shapes.hpp"

namespace brachium::pipelines::report {

/// Estimated width of a text [px] in the page's sans-serif at `size_px`.
double text_width(std::string_view text, double size_px);

std::string draw_marker_area(const Marker& marker, const Panel& panel);  ///< behind the curves
std::string draw_marker_line(const Marker& marker, const Panel& panel);  ///< in front of them
std::string draw_level(const Level& level, const Panel& panel);

/// Names of markers above the plot, in as few lines as keep them apart. Names that occur repeatedly are the
/// legend's.
struct MarkerLabels {
  struct Place {
    std::string text;
    double x = 0.0;  ///< fraction of the width
    int lane = 0;    ///< 0 is the lowest line
    Tone tone = Tone::plain;
  };
  std::vector<Place> places;
  int lanes = 0;
};
MarkerLabels place_marker_labels(const std::vector<Marker>& markers, const Axis& x, double width_px);
std::string draw_marker_labels(const MarkerLabels& labels, double top_px, double lane_px);

/// Names of levels stand right of the plot, moved apart where levels are close.
double level_padding(std::span<const Level> levels);
std::string draw_level_labels(std::span<const Level> levels, const Panel& panel, double top_px);

/// The axes as attributes from which the page's script reads values under the pointer.
std::string axis_attributes(const Axis& x, const Axis& y);

}  // namespace brachium::pipelines::report
