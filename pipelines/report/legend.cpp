#include "pipelines/report/legend.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "pipelines/report/shapes.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

std::string marker_swatch(const Marker& marker) {
  const std::string shape = marker.to ? "<path class=\"span " : "<path class=\"mark ";
  const std::string d = marker.to ? "M2 0h20v12h-20z" : "M12 0v12";
  return "<svg class=\"k\" width=\"24\" height=\"12\" aria-hidden=\"true\">" + shape +
         tone_class(marker.tone) + "\" d=\"" + d + "\"/></svg>";
}

}  // namespace

std::vector<int> assign_colours(const Plot& plot) {
  std::vector<const Series*> all;
  for (const Series& series : plot.series) all.push_back(&series);
  for (const Plot& panel : plot.below) {
    for (const Series& series : panel.series) all.push_back(&series);
  }
  std::set<int> given;
  for (const Series* series : all) given.insert(series->colour);
  std::vector<int> colours;
  int next = 0;
  for (const Series* series : all) {
    if (series->colour >= 0) {
      colours.push_back(series->colour);
      continue;
    }
    while (given.contains(next)) ++next;
    colours.push_back(next++);
  }
  return colours;
}

bool is_repeated(const Marker& marker, const std::vector<Marker>& markers) {
  return std::count_if(markers.begin(), markers.end(), [&](const Marker& other) {
           return other.label == marker.label && other.tone == marker.tone;
         }) > 1;
}

std::string tone_class(Tone tone) {
  switch (tone) {
    case Tone::plain:
      return "plain";
    case Tone::good:
      return "good";
    case Tone::warning:
      return "warning";
    case Tone::bad:
      return "bad";
  }
  return "plain";
}

std::string draw_legend(const Plot& plot) {
  std::vector<std::string> entries;
  const auto add = [&](const std::string& swatch, const std::string& label) {
    const std::string entry = "<li>" + swatch + escape(typeset_label(label)) + "</li>";
    if (!label.empty() && std::find(entries.begin(), entries.end(), entry) == entries.end())
      entries.push_back(entry);
  };
  const std::vector<int> colours = assign_colours(plot);
  std::size_t k = 0;
  std::string only;
  const auto add_series = [&](const Series& series) {
    add(draw_swatch(series.style, colours[k++]), series.label);
    if (entries.size() == 1) only = series.label;
  };
  for (const Series& series : plot.series) add_series(series);
  for (const Plot& panel : plot.below) {
    for (const Series& series : panel.series) add_series(series);
  }
  for (const Marker& marker : plot.markers) {
    if (is_repeated(marker, plot.markers)) add(marker_swatch(marker), marker.label);
  }
  if (plot.equal_axes) {
    add("<svg class=\"k\" width=\"24\" height=\"12\" aria-hidden=\"true\"><path class=\"mark plain\" d=\"M1 "
        "11L23 1\"/></svg>",
        "identity");
  }
  if (entries.empty() || (entries.size() == 1 && only == plot.title)) return "";
  std::string out = "<ul class=\"legend\">";
  for (const std::string& entry : entries) out += entry;
  return out + "</ul>";
}

}  // namespace brachium::pipelines::report
