/// Views that fit into a page: fewer states, merged points.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "pipelines/report/view3d.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr std::size_t kFewStates = 8;  // a load programme still reads as one

std::size_t point_count(const View3d& view) {
  return view.states.empty() ? view.reference.size() / 3 : view.states.front().positions.size() / 3;
}

const std::vector<double>& undeformed(const View3d& view) {
  return view.reference.empty() ? view.states.front().positions : view.reference;
}

/// `count` of the states, first and last among them.
View3d with_states(const View3d& view, std::size_t count) {
  View3d out = view;
  out.states.clear();
  for (ViewField& field : out.fields) field.values.clear();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i =
        count == 1 ? view.states.size() - 1 : (k * (view.states.size() - 1) + (count - 1) / 2) / (count - 1);
    out.states.push_back(view.states[i]);
    for (std::size_t f = 0; f < out.fields.size(); ++f)
      out.fields[f].values.push_back(view.fields[f].values[i]);
  }
  return out;
}

using CellKey = std::tuple<long, long, long>;

/// Cell of a grid of pitch `h` for each point.
std::vector<CellKey> cells_of(const std::vector<double>& x, double h) {
  std::vector<CellKey> keys(x.size() / 3);
  for (std::size_t p = 0; p < keys.size(); ++p) {
    keys[p] = {static_cast<long>(std::floor(x[3 * p] / h)), static_cast<long>(std::floor(x[3 * p + 1] / h)),
               static_cast<long>(std::floor(x[3 * p + 2] / h))};
  }
  return keys;
}

std::size_t distinct(std::vector<CellKey> keys) {
  std::sort(keys.begin(), keys.end());
  return static_cast<std::size_t>(std::unique(keys.begin(), keys.end()) - keys.begin());
}

double longest_side(const std::vector<double>& x) {
  double longest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = x[axis], high = x[axis];
    for (std::size_t i = axis; i < x.size(); i += 3) {
      low = std::min(low, x[i]);
      high = std::max(high, x[i]);
    }
    longest = std::max(longest, high - low);
  }
  return longest;
}

/// The view on the points `kept` (new index -> old); `place`: old index -> new.
View3d on_points(const View3d& view, const std::vector<int>& kept, const std::vector<int>& place) {
  View3d out = view;
  const auto pick = [&](const std::vector<double>& x) {
    std::vector<double> y;
    y.reserve(3 * kept.size());
    for (const int p : kept) {
      for (std::size_t axis = 0; axis < 3; ++axis) y.push_back(x[3 * static_cast<std::size_t>(p) + axis]);
    }
    return y;
  };
  if (!view.reference.empty()) out.reference = pick(view.reference);
  for (ViewState& state : out.states) state.positions = pick(state.positions);
  for (ViewField& field : out.fields) {
    for (std::vector<double>& values : field.values) {
      std::vector<double> picked;
      picked.reserve(kept.size());
      for (const int p : kept) picked.push_back(values[static_cast<std::size_t>(p)]);
      values = std::move(picked);
    }
  }
  for (ViewRegion& region : out.regions) {
    std::vector<std::array<int, 3>> triangles;
    std::set<std::array<int, 3>> seen;
    for (std::array<int, 3> t : region.triangles) {
      for (int& p : t) p = place[static_cast<std::size_t>(p)];
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      std::array<int, 3> sorted = t;
      std::rotate(sorted.begin(), std::min_element(sorted.begin(), sorted.end()), sorted.end());
      if (seen.insert(sorted).second) triangles.push_back(t);
    }
    region.triangles = std::move(triangles);
    region.edges.clear();
  }
  return out;
}

}  // namespace

std::size_t view_bytes(const View3d& view) {
  const std::size_t n = point_count(view);
  std::size_t bytes = view.reference.empty() ? 0 : 9 * n;
  for (const ViewRegion& region : view.regions)
    bytes += 9 * region.triangles.size() + 6 * region.edges.size() + region.name.size() + 40;
  for (const ViewState& state : view.states)
    bytes += 9 * n + view.fields.size() * (2 * n + 4) + state.label.size() + 30;
  return bytes + 2000;
}

View3d coarsened_view(const View3d& view, std::size_t points) {
  const std::vector<double>& x = undeformed(view);
  const std::size_t n = x.size() / 3;
  if (n <= points || points == 0) return view;
  // The smallest pitch that leaves few enough points, to 2 %.
  double low = 0.0, high = longest_side(x);
  if (!(high > 0.0)) return view;
  while (distinct(cells_of(x, high)) > points) high *= 2.0;
  for (int k = 0; k < 24 && high - low > 0.02 * high; ++k) {
    const double middle = 0.5 * (low + high);
    (distinct(cells_of(x, middle)) > points ? low : high) = middle;
  }
  // Each cell keeps the point nearest to the mean of its points, so that the surface does not shrink.
  const std::vector<CellKey> keys = cells_of(x, high);
  std::map<CellKey, std::vector<int>> members;
  for (std::size_t p = 0; p < n; ++p) members[keys[p]].push_back(static_cast<int>(p));
  std::vector<int> kept, place(n, 0);
  for (const auto& [key, list] : members) {
    std::array<double, 3> mean{};
    for (const int p : list) {
      for (std::size_t a = 0; a < 3; ++a)
        mean[a] += x[3 * static_cast<std::size_t>(p) + a] / static_cast<double>(list.size());
    }
    const auto distance = [&](int p) {
      const std::size_t i = 3 * static_cast<std::size_t>(p);
      return std::hypot(x[i] - mean[0], x[i + 1] - mean[1], x[i + 2] - mean[2]);
    };
    for (const int p : list) place[static_cast<std::size_t>(p)] = static_cast<int>(kept.size());
    kept.push_back(
        *std::min_element(list.begin(), list.end(), [&](int a, int b) { return distance(a) < distance(b); }));
  }
  return on_points(view, kept, place);
}

View3d fitted_view(const View3d& view) {
  View3d out = view;
  if (view.states.empty() || view_bytes(view) <= view.limit_bytes) return out;
  const std::size_t states = view.states.size(), points = point_count(view);
  const auto fits = [&] { return view_bytes(out) <= view.limit_bytes; };
  for (std::size_t count = states; count-- > std::min(kFewStates, states) && !fits();)
    out = with_states(view, count);
  const View3d fewer = out;
  std::size_t left = points;
  while (!fits() && left > 400) {
    left = std::max<std::size_t>(400, left * 4 / 5);
    out = coarsened_view(fewer, left);
  }
  const View3d coarse = out;
  for (std::size_t count = coarse.states.size(); count-- > 1 && !fits();) out = with_states(coarse, count);
  if (out.states.size() < states)
    out.note +=
        fmt::format("{}{} of {} states are shown.", out.note.empty() ? "" : " ", out.states.size(), states);
  if (point_count(out) < points) {
    out.note += fmt::format(
        "{}The surface is drawn with {} of its {} points, and without the cells' edges, to keep the page "
        "small; the "
        "field files have all of them.",
        out.note.empty() ? "" : " ", point_count(out), points);
  }
  return out;
}

}  // namespace brachium::pipelines::report
