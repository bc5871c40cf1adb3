#include "pipelines/report/view3d.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pipelines/report/colour_map.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr double kPositionSteps = 262143.0;  // 2^18 - 1
constexpr unsigned kValueSteps = 4094, kNoValue = 4095;
constexpr int kColours = 64;
constexpr std::size_t kMostPoints = 262144;  // an index has three digits

void check(const View3d& view) {
  const auto fail = [&](const std::string& what) {
    throw std::logic_error("view `" + view.title + "`: " + what);
  };
  if (view.states.empty()) fail("it has no state");
  const std::size_t n = view.states.front().positions.size() / 3;
  const auto placed = [&](const std::vector<double>& x, const std::string& what) {
    if (x.size() != 3 * n) fail(what + " has positions of another number of points");
    if (!std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); }))
      fail(what + " has positions that are not finite");
  };
  for (const ViewState& state : view.states) placed(state.positions, "state `" + state.label + "`");
  if (!view.reference.empty()) placed(view.reference, "the reference");
  for (const ViewField& field : view.fields) {
    if (field.values.size() != view.states.size())
      fail("field `" + field.label + "` has not one entry a state");
    for (const std::vector<double>& values : field.values) {
      if (values.size() != n) fail("field `" + field.label + "` has not one value a point");
    }
  }
  const auto exists = [&](int p) { return p >= 0 && static_cast<std::size_t>(p) < n; };
  for (const ViewRegion& region : view.regions) {
    for (const auto& t : region.triangles) {
      if (!std::all_of(t.begin(), t.end(), exists))
        fail("region `" + region.name + "` has a triangle of missing points");
    }
    for (const auto& e : region.edges) {
      if (!std::all_of(e.begin(), e.end(), exists))
        fail("region `" + region.name + "` has an edge of missing points");
    }
  }
}

/// A text as a JSON string that cannot end the script it stands in: everything HTML escapes is a \u escape.
std::string json_text(std::string_view text) {
  std::string out = "\"";
  const std::string html = escape(text);  // control characters and broken UTF-8 are gone
  for (std::size_t i = 0; i < html.size(); ++i) {
    if (html[i] == '&') {
      const std::size_t end = html.find(';', i);
      const std::string name = html.substr(i, end - i);
      out += name == "&amp;" || name == "&amp" ? "\\u0026"
             : name == "&lt"                   ? "\\u003c"
             : name == "&gt"                   ? "\\u003e"
             : name == "&quot"                 ? "\\u0022"
                                               : "\\u0027";
      i = end;
    } else if (html[i] == '\\') {
      out += "\\\\";
    } else if (html[i] == '\n' || html[i] == '\t') {
      out += ' ';
    } else {
      out += html[i];
    }
  }
  return out + "\"";
}

std::string json_number(double value) {
  return fmt::format("{:.9g}", value);
}

struct Box {
  double low[3] = {1e300, 1e300, 1e300};
  double side = 0.0;  ///< longest
};

Box box_of(const View3d& view) {
  Box box;
  double high[3] = {-1e300, -1e300, -1e300};
  const auto include = [&](const std::vector<double>& x) {
    for (std::size_t i = 0; i < x.size(); ++i) {
      box.low[i % 3] = std::min(box.low[i % 3], x[i]);
      high[i % 3] = std::max(high[i % 3], x[i]);
    }
  };
  include(view.reference);
  for (const ViewState& state : view.states) include(state.positions);
  for (int a = 0; a < 3; ++a) box.side = std::max(box.side, high[a] - box.low[a]);
  if (!(box.side > 0.0)) box.side = 1.0;
  return box;
}

std::string positions_text(const std::vector<double>& x, const Box& box) {
  std::string out;
  out.reserve(3 * x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    append_digits(out,
                  static_cast<unsigned>(std::lround(kPositionSteps * (x[i] - box.low[i % 3]) / box.side)), 3);
  }
  return out;
}

std::string values_text(const std::vector<double>& values, const ColourRange& range) {
  std::string out;
  out.reserve(2 * values.size());
  for (const double v : values) {
    const double t = std::clamp((v - range.lower) / (range.upper - range.lower), 0.0, 1.0);
    append_digits(out, std::isnan(v) ? kNoValue : static_cast<unsigned>(std::lround(kValueSteps * t)), 2);
  }
  return out;
}

std::string data_text(const View3d& view) {
  const Box box = box_of(view);
  std::string out = fmt::format("{{\"unit\":{},\"low\":[{},{},{}],\"side\":{},\"look\":[",
                                json_text(typeset_unit(view.length_unit)), json_number(box.low[0]),
                                json_number(box.low[1]), json_number(box.low[2]), json_number(box.side));
  const std::array<double, 9> look = first_look(view);
  for (std::size_t k = 0; k < 9; ++k) out += (k ? "," : "") + json_number(look[k]);
  out += "],\"map\":\"";
  for (int k = 0; k < kColours; ++k)
    out += hex(scale_colour(static_cast<double>(k) / (kColours - 1))).substr(1);
  out += "\",\"fields\":[";
  std::vector<ColourRange> ranges;
  for (const ViewField& field : view.fields) {
    ranges.push_back(colour_range(field));
    out += fmt::format("{}{{\"label\":{},\"low\":{},\"high\":{},\"cut\":{}}}", ranges.size() > 1 ? "," : "",
                       json_text(typeset_label(plain_text(field.label))), json_number(ranges.back().lower),
                       json_number(ranges.back().upper),
                       (ranges.back().cut_below ? 1 : 0) + (ranges.back().cut_above ? 2 : 0));
  }
  out += "],\n\"regions\":[";
  for (const ViewRegion& region : view.regions) {
    out += fmt::format("{}{{\"name\":{},\"t\":\"", &region == &view.regions.front() ? "" : ",",
                       json_text(region.name));
    for (const auto& t : region.triangles) {
      for (const int p : t) append_digits(out, static_cast<unsigned>(p), 3);
    }
    out += "\",\"e\":\"";
    for (const auto& e : region.edges) {
      for (const int p : e) append_digits(out, static_cast<unsigned>(p), 3);
    }
    out += "\"}";
  }
  out += fmt::format("],\n\"reference\":\"{}\",\n\"states\":[", positions_text(view.reference, box));
  for (std::size_t s = 0; s < view.states.size(); ++s) {
    out += fmt::format("{}{{\"label\":{},\"x\":\"{}\",\"v\":[", s ? ",\n" : "",
                       json_text(plain_text(view.states[s].label)),
                       positions_text(view.states[s].positions, box));
    for (std::size_t f = 0; f < view.fields.size(); ++f)
      out += fmt::format("{}\"{}\"", f ? "," : "", values_text(view.fields[f].values[s], ranges[f]));
    out += "]}";
  }
  return out + "]}";
}

}  // namespace

void append_digits(std::string& out, unsigned value, int count) {
  for (int k = count - 1; k >= 0; --k) out += kDigits[(value >> (6 * k)) & 63u];
}

ColourRange colour_range(const ViewField& field) {
  std::vector<double> all;
  for (const std::vector<double>& values : field.values) {
    for (const double v : values) {
      if (std::isfinite(v)) all.push_back(v);
    }
  }
  if (all.empty()) return {};
  std::sort(all.begin(), all.end());
  const double least = all.front(), most = all.back();
  const std::size_t tail = all.size() / 200;
  const double low = all[tail], high = all[all.size() - 1 - tail];
  ColourRange range{least, most, false, false};
  if (high > low && most - least > 1.5 * (high - low)) {
    range.cut_below = low - least > 0.1 * (high - low);
    range.cut_above = most - high > 0.1 * (high - low);
    if (range.cut_below) range.lower = low;
    if (range.cut_above) range.upper = high;
  }
  const double room = 1e-6 * std::max({std::abs(range.lower), std::abs(range.upper), 1e-300});
  if (!(range.upper - range.lower > room)) {  // constant: rounding errors are no pattern
    const double middle = 0.5 * (range.lower + range.upper);
    const double half = middle == 0.0 ? 1.0 : 0.01 * std::abs(middle);
    range = {middle - half, middle + half, false, false};
  }
  return range;
}

std::array<double, 9> first_look(const View3d& view) {
  const std::vector<double>& x = view.reference.empty() ? view.states.front().positions : view.reference;
  double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
  for (std::size_t i = 0; i < x.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], x[i]);
    high[i % 3] = std::max(high[i % 3], x[i]);
  }
  const double extent[3] = {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
  // The longest axis runs to the right; z points up where it is not the longest.
  const int right = extent[2] > extent[0] && extent[2] > extent[1] ? 2 : extent[1] > extent[0] ? 1 : 0;
  const int up = right == 2 ? 1 : 2, third = 3 - right - up;
  const double sign = (right + 1) % 3 == up ? 1.0 : -1.0;  // towards the reader = right x up
  double r[3] = {}, u[3] = {}, t[3] = {};
  r[right] = 1.0;
  u[up] = 1.0;
  t[third] = sign;
  // Turned by 25 degrees about the upright axis, then seen from 22 degrees above.
  const double a = -0.44, b = 0.38;
  std::array<double, 9> look{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double turned = std::cos(a) * t[k] - std::sin(a) * r[k];
    look[k] = std::cos(a) * r[k] + std::sin(a) * t[k];
    look[3 + k] = std::cos(b) * u[k] - std::sin(b) * turned;
    look[6 + k] = std::sin(b) * u[k] + std::cos(b) * turned;
  }
  return look;
}

std::string draw_view3d(const View3d& wanted) {
  check(wanted);
  const View3d view = fitted_view(wanted);
  if (view.states.front().positions.size() / 3 > kMostPoints)
    throw std::logic_error("view `" + view.title + "`: more points than an index can hold");
  std::string out = "<figure class=\"view3d\">\n<figcaption>" + inline_markup(view.title) + "</figcaption>\n";
  const bool empty = std::all_of(view.regions.begin(), view.regions.end(),
                                 [](const ViewRegion& r) { return r.triangles.empty(); });
  if (empty) {
    out += "<p class=\"none\">There is no surface to show.</p>\n";
  } else {
    out += draw_poster(view) + "\n<script type=\"application/json\">" + data_text(view) + "</script>\n";
  }
  if (!view.note.empty()) out += "<p class=\"note\">" + inline_markup(view.note) + "</p>\n";
  return out + "</figure>\n";
}

}  // namespace brachium::pipelines::report
