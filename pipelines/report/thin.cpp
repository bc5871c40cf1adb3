#include "pipelines/report/thin.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

namespace brachium::pipelines::report {
namespace {

/// First, last, lowest and highest sample of [begin, end), each once, in order.
void keep_four(std::span<const double> y, std::size_t begin, std::size_t end,
               std::vector<std::size_t>& kept) {
  std::size_t low = begin;
  std::size_t high = begin;
  for (std::size_t i = begin; i < end; ++i) {
    if (y[i] < y[low]) low = i;
    if (y[i] > y[high]) high = i;
  }
  std::array<std::size_t, 4> four = {begin, low, high, end - 1};
  std::sort(four.begin(), four.end());
  const auto last = std::unique(four.begin(), four.end());
  kept.insert(kept.end(), four.begin(), last);
}

}  // namespace

std::vector<std::size_t> thin_line(std::span<const double> x_px, std::span<const double> y_px,
                                   double column_px) {
  const auto broken = [&](std::size_t i) { return std::isnan(x_px[i]) || std::isnan(y_px[i]); };
  const auto column = [&](std::size_t i) { return std::floor(x_px[i] / column_px); };
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < x_px.size();) {
    std::size_t end = i + 1;
    if (broken(i)) {
      kept.push_back(i);
      while (end < x_px.size() && broken(end)) ++end;
    } else {
      while (end < x_px.size() && !broken(end) && column(end) == column(i)) ++end;
      keep_four(y_px, i, end, kept);
    }
    i = end;
  }
  return kept;
}

std::vector<std::size_t> thin_points(std::span<const double> x_px, std::span<const double> y_px,
                                     double cell_px) {
  std::set<std::pair<std::int64_t, std::int64_t>> taken;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < x_px.size(); ++i) {
    if (std::isnan(x_px[i]) || std::isnan(y_px[i])) continue;
    const std::pair cell = {static_cast<std::int64_t>(std::floor(x_px[i] / cell_px)),
                            static_cast<std::int64_t>(std::floor(y_px[i] / cell_px))};
    if (taken.insert(cell).second) kept.push_back(i);
  }
  return kept;
}

}  // namespace brachium::pipelines::report
