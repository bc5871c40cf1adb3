#include "pipelines/report/marks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipelines/report/legend.hpp"
#include "pipelines/report/number.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr double kSize = 10.5;          // [px] of marker and level names
constexpr double kLevelSpacing = 12.0;  // [px] between names of neighbouring levels
constexpr double kWidestLevel = 150.0;  // [px]

constexpr double kNarrowest =
    400.0;  // [px] a plot may be shown narrower than the page thinks: names are kept apart here

}  // namespace

double text_width(std::string_view text, double size_px) {
  // Continuation bytes of UTF-8 are no characters of their own.
  const auto characters = std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
  return 0.56 * size_px * static_cast<double>(characters);
}

std::string draw_marker_area(const Marker& marker, const Panel& panel) {
  if (!marker.to) return "";
  const double from = panel.px(marker.from);
  const double to = panel.px(*marker.to);
  if (std::isnan(from) || std::isnan(to)) return "";
  return "<path class=\"span " + tone_class(marker.tone) + "\" d=\"M" + pixels(std::min(from, to)) + " 0h" +
         pixels(std::abs(to - from)) + "v" + pixels(panel.height_px) + "h" + pixels(-std::abs(to - from)) +
         "z\"/>";
}

std::string draw_marker_line(const Marker& marker, const Panel& panel) {
  const double from = panel.px(marker.from);
  if (marker.to || std::isnan(from)) return "";
  return "<path class=\"mark " + tone_class(marker.tone) + "\" d=\"M" + pixels(from) + " 0v" +
         pixels(panel.height_px) + "\"/>";
}

std::string draw_level(const Level& level, const Panel& panel) {
  const double y = panel.py(level.y);
  if (std::isnan(y)) return "";
  return "<path class=\"mark " + tone_class(level.tone) + "\" d=\"M0 " + pixels(y) + "h" +
         pixels(panel.width_px) + "\"/>";
}

MarkerLabels place_marker_labels(const std::vector<Marker>& markers, const Axis& x, double width_px) {
  MarkerLabels labels;
  for (const Marker& marker : markers) {
    const double from = x.position(marker.from);
    const double to = marker.to ? x.position(*marker.to) : from;
    const double at = (std::clamp(from, 0.0, 1.0) + std::clamp(to, 0.0, 1.0)) / 2.0;
    const bool visible = std::max(from, to) >= 0.0 && std::min(from, to) <= 1.0;
    if (marker.label.empty() || !visible || is_repeated(marker, markers)) continue;
    labels.places.push_back({marker.label, at, 0, marker.tone});
  }
  std::stable_sort(labels.places.begin(), labels.places.end(),
                   [](const auto& a, const auto& b) { return a.x < b.x; });
  const double narrow = std::min(width_px, kNarrowest);
  std::vector<double> lane_end;  // [px] right end of the last name of each line
  for (MarkerLabels::Place& place : labels.places) {
    const double width = text_width(place.text, kSize);
    const double start = std::clamp(narrow * place.x - width / 2.0, 0.0, std::max(0.0, narrow - width));
    const auto free =
        std::find_if(lane_end.begin(), lane_end.end(), [&](double end) { return end + 6.0 <= start; });
    place.lane = static_cast<int>(free - lane_end.begin());
    if (free == lane_end.end()) lane_end.push_back(0.0);
    lane_end[static_cast<std::size_t>(place.lane)] = start + width;
  }
  labels.lanes = static_cast<int>(lane_end.size());
  return labels;
}

std::string draw_marker_labels(const MarkerLabels& labels, double top_px, double lane_px) {
  std::string out;
  for (const MarkerLabels::Place& place : labels.places) {
    const char* anchor = place.x < 0.12 ? "start" : place.x > 0.88 ? "end" : "middle";
    const double y = top_px + (labels.lanes - place.lane) * lane_px - 4.0;
    out +=
        fmt::format("<text class=\"ml {}\" text-anchor=\"{}\" x=\"{}%\" y=\"{}\">{}</text>",
                    tone_class(place.tone), anchor, fixed(100.0 * place.x, 2), pixels(y), escape(place.text));
  }
  return out;
}

double level_padding(std::span<const Level> levels) {
  double widest = 0.0;
  for (const Level& level : levels) {
    if (!level.label.empty()) widest = std::max(widest, text_width(level.label, kSize) + 12.0);
  }
  return std::min(widest, kWidestLevel);
}

std::string draw_level_labels(std::span<const Level> levels, const Panel& panel, double top_px) {
  struct Place {
    double y;
    const Level* level;
  };
  std::vector<Place> places;
  for (const Level& level : levels) {
    const double y = panel.py(level.y);
    if (!level.label.empty() && y >= 0.0 && y <= panel.height_px) places.push_back({y, &level});
  }
  std::stable_sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.y < b.y; });
  for (std::size_t i = 1; i < places.size(); ++i) {
    places[i].y = std::max(places[i].y, places[i - 1].y + kLevelSpacing);
  }
  // Pushed beyond the lower end: moved up again as one.
  double end = panel.height_px;
  for (auto place = places.rbegin(); place != places.rend(); ++place) {
    place->y = std::min(place->y, end);
    end = place->y - kLevelSpacing;
  }
  std::string out;
  for (const Place& place : places) {
    out += fmt::format("<text class=\"ml {}\" x=\"100%\" dx=\"6\" y=\"{}\">{}</text>",
                       tone_class(place.level->tone), pixels(top_px + place.y + 3.5),
                       escape(place.level->label));
  }
  return out;
}

std::string axis_attributes(const Axis& x, const Axis& y) {
  return fmt::format(" data-x=\"{:.9g} {:.9g} {:d}\" data-y=\"{:.9g} {:.9g} {:d}\"", x.lower, x.upper,
                     x.log ? 1 : 0, y.lower, y.upper, y.log ? 1 : 0);
}

}  // namespace brachium::pipelines::report
