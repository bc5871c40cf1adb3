#pragma once
/// What the curves and markers of a plot are called; set above the plot, where it covers no data.

#include <string>
#include <vector>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// Colours of all series of a plot and the panels below it, in drawing order: given indices as they are,
/// others the next index that no series was given.
std::vector<int> assign_colours(const Plot& plot);

/// A marker's name stands in the plot if it is the only one of that name, else in the legend.
bool is_repeated(const Marker& marker, const std::vector<Marker>& markers);

/// A tone as a CSS class: "plain", "good", "warning", "bad".
std::string tone_class(Tone tone);

/// The legend as HTML; empty where the title already says everything.
std::string draw_legend(const Plot& plot);

}  // namespace brachium::pipelines::report
