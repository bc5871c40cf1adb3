/// The static picture of a view: painter's algorithm, far triangles first, shaded by the angle to the light.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "pipelines/report/colour_map.hpp"
#include "pipelines/report/number.hpp"
#include "pipelines/report/path.hpp"
#include "pipelines/report/text.hpp"
#include "pipelines/report/ticks.hpp"
#include "pipelines/report/view3d.hpp"

namespace brachium::pipelines::report {
namespace {

using Vec = std::array<double, 3>;

constexpr double kWidth = 960.0, kHeight = 440.0;  // [px]
constexpr double kMargin = 30.0, kFoot = 64.0;     // [px] of the body; room for the scale at the bottom
constexpr std::size_t kMostPoints = 2600;          // of a picture on paper
constexpr double kAmbient = 0.58, kDiffuse = 0.42;
const Vec kLight{-0.36, 0.50, 0.79};  // in screen axes, unit length to 1e-2; the script has the same

Vec minus(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Points of one state in screen axes [px], y downwards, z towards the reader.
struct Screen {
  std::vector<Vec> points;
  double scale = 1.0;  ///< px per unit of length
};

Screen project(const View3d& view) {
  const std::array<double, 9> look = first_look(view);
  const auto turned = [&](const std::vector<double>& x, std::size_t p) {
    const Vec v{x[3 * p], x[3 * p + 1], x[3 * p + 2]};
    return Vec{dot({look[0], look[1], look[2]}, v), -dot({look[3], look[4], look[5]}, v),
               dot({look[6], look[7], look[8]}, v)};
  };
  const std::vector<double>& last = view.states.back().positions;
  Vec low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  Screen screen;
  for (std::size_t p = 0; p < last.size() / 3; ++p) {
    screen.points.push_back(turned(last, p));
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], screen.points.back()[a]);
      high[a] = std::max(high[a], screen.points.back()[a]);
    }
  }
  const double height = kHeight - kFoot - 2.0 * kMargin;
  screen.scale = std::min((kWidth - 2.0 * kMargin) / std::max(high[0] - low[0], 1e-300),
                          height / std::max(high[1] - low[1], 1e-300));
  for (Vec& v : screen.points) {
    v = {kWidth / 2.0 + screen.scale * (v[0] - 0.5 * (low[0] + high[0])),
         kMargin + height / 2.0 + screen.scale * (v[1] - 0.5 * (low[1] + high[1])), screen.scale * v[2]};
  }
  return screen;
}

std::string shaded(double value, const ColourRange& range, double light) {
  Rgb c = scale_colour((value - range.lower) / (range.upper - range.lower));
  const double l = kAmbient + kDiffuse * std::max(light, 0.0);
  const auto dim = [&](std::uint8_t v) { return static_cast<std::uint8_t>(std::lround(l * v)); };
  return hex({dim(c.red), dim(c.green), dim(c.blue)});
}

std::string draw_body(const View3d& view, const ColourRange& range) {
  const Screen screen = project(view);
  const std::vector<double>* values = view.fields.empty() ? nullptr : &view.fields.front().values.back();
  struct Face {
    const std::array<int, 3>* corners;
    const std::set<std::array<int, 2>>* edges;
    double depth, light;
  };
  std::vector<std::set<std::array<int, 2>>> edges(view.regions.size());
  std::vector<Face> faces;
  for (std::size_t r = 0; r < view.regions.size(); ++r) {
    for (const std::array<int, 2>& e : view.regions[r].edges)
      edges[r].insert({std::min(e[0], e[1]), std::max(e[0], e[1])});
    for (const std::array<int, 3>& t : view.regions[r].triangles) {
      const Vec &a = screen.points[static_cast<std::size_t>(t[0])],
                &b = screen.points[static_cast<std::size_t>(t[1])],
                &c = screen.points[static_cast<std::size_t>(t[2])];
      Vec n = cross(minus(c, a), minus(b, a));  // y points downwards, so the order of corners is turned
      const double size = std::sqrt(dot(n, n));
      if (!(n[2] > 0.0) || !(size > 0.0)) continue;
      faces.push_back({&t, &edges[r], a[2] + b[2] + c[2],
                       (n[0] * kLight[0] - n[1] * kLight[1] + n[2] * kLight[2]) / size});
    }
  }
  std::stable_sort(faces.begin(), faces.end(),
                   [](const Face& a, const Face& b) { return a.depth < b.depth; });
  std::string out = "<g class=\"body\">";
  for (const Face& face : faces) {
    PathWriter path, lines;
    double mean = 0.0;
    for (int k = 0; k < 3; ++k) {
      const int p = (*face.corners)[static_cast<std::size_t>(k)],
                q = (*face.corners)[static_cast<std::size_t>((k + 1) % 3)];
      const Vec &a = screen.points[static_cast<std::size_t>(p)],
                &b = screen.points[static_cast<std::size_t>(q)];
      k == 0 ? path.move_to(a[0], a[1]) : path.line_to(a[0], a[1]);
      if (values) mean += (*values)[static_cast<std::size_t>(p)] / 3.0;
      if (!face.edges->contains({std::min(p, q), std::max(p, q)})) continue;
      lines.move_to(a[0], a[1]);
      lines.line_to(b[0], b[1]);
    }
    path.close();
    if (!values) mean = std::nan("");
    out += "<path color=\"" + shaded(mean, range, face.light) + "\" d=\"" + path.text() + "\"/>";
    if (!lines.empty()) out += "<path class=\"e\" d=\"" + lines.text() + "\"/>";
  }
  return out + "</g>";
}

std::string draw_scale(const ViewField& field, const ColourRange& range) {
  constexpr double left = 30.0, width = 300.0, top = kHeight - 40.0, height = 10.0;
  constexpr int parts = 50;
  std::string out = fmt::format("<text x=\"{}\" y=\"{}\">{}</text>", pixels(left), pixels(top - 7.0),
                                escape(typeset_label(field.label)));
  for (int k = 0; k < parts; ++k) {
    out += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"{}\"/>",
                       pixels(left + width * k / parts), pixels(top), pixels(width / parts + 0.3),
                       pixels(height), hex(scale_colour((k + 0.5) / parts)));
  }
  for (const Tick& tick : linear_ticks(range.lower, range.upper, 5)) {
    const double x = left + width * (tick.value - range.lower) / (range.upper - range.lower);
    out += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", pixels(x),
                       pixels(top + height + 14.0), escape(tick.label));
  }
  return out;
}

std::string draw_ruler(double scale, const std::string& unit) {
  const double length = nice_step(140.0 / scale, 1), right = kWidth - 30.0, y = kHeight - 30.0;
  const double left = right - std::min(length * scale, 400.0);
  return fmt::format(
      "<path class=\"ruler\" d=\"M{} {}V{}H{}V{}\"/><text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
      pixels(left), pixels(y - 5.0), pixels(y), pixels(right), pixels(y - 5.0), pixels(0.5 * (left + right)),
      pixels(y + 15.0), escape(quantity(length, unit, 1)));
}

}  // namespace

std::string draw_poster(const View3d& view) {
  const View3d small = coarsened_view(view, kMostPoints);
  const ColourRange range = view.fields.empty() ? ColourRange{} : colour_range(view.fields.front());
  std::string out = fmt::format(
      "<svg class=\"poster\" viewBox=\"0 0 {} {}\" role=\"img\"><title>{}</title><desc>{}{}.</desc>",
      pixels(kWidth), pixels(kHeight), escape(plain_text(view.title)),
      escape("The body in its last state, " + view.states.back().label),
      view.fields.empty() ? "" : escape(", coloured by " + plain_text(view.fields.front().label)));
  out += draw_body(small, range);
  if (!view.fields.empty()) out += draw_scale(view.fields.front(), range);
  return out + draw_ruler(project(small).scale, view.length_unit) + "</svg>";
}

}  // namespace brachium::pipelines::report
