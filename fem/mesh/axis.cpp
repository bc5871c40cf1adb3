#include "fem/mesh/axis.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "data/model/error.hpp"

namespace brachium::fem {

void check_option(const std::string& what, double value, double low, double high, bool above_low) {
  const bool holds = std::isfinite(value) && (above_low ? value > low : value >= low) && value <= high;
  if (holds) return;
  throw data::InputError(
      "bad-mesh-option", fmt::format("{} is {}, which no mesh can be made with", what, value),
      std::isfinite(high) ? fmt::format("allowed: {}{}, {}]", above_low ? "(" : "[", low, high)
                          : fmt::format("it must be {} {}", above_low ? "above" : "at least", low));
}

std::vector<double> positions(const Axis& axis, const std::string& what) {
  const double infinite = std::numeric_limits<double>::infinity();
  check_option(what + ": length_m", axis.length_m, 0.0, infinite, true);
  check_option(what + ": cells", axis.cells, 1.0, 1e6, false);
  check_option(what + ": grading", axis.grading, 1e-6, 1e6, false);
  const int n = axis.cells;
  // Sizes q^i; symmetric: the exponent rises from 0 at the ends to the middle, and q follows.
  const int top = axis.symmetric ? (n - 1) / 2 : n - 1;
  std::vector<double> at(static_cast<std::size_t>(n) + 1, 0.0);
  double sum = 0.0;
  for (int i = 0; i < n; ++i) {
    const double exponent = axis.symmetric ? std::min(i, n - 1 - i) : i;
    sum += top > 0 ? std::pow(axis.grading, exponent / top) : 1.0;
    at[static_cast<std::size_t>(i) + 1] = sum;
  }
  for (double& x : at) x *= axis.length_m / sum;
  at.back() = axis.length_m;
  return at;
}

}  // namespace brachium::fem
