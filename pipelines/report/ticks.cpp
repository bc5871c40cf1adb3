#include "pipelines/report/ticks.hpp"

#include <algorithm>
#include <cmath>

#include "pipelines/report/number.hpp"

namespace brachium::pipelines::report {
namespace {

constexpr double kRounding = 1e-9;  // of a step: a multiple at the very end of the axis still counts

int floor_log10(double value) {
  return static_cast<int>(std::floor(std::log10(value) + kRounding));
}

/// Text of a multiple of `step` on an axis whose largest number is `largest`.
std::string label(double value, double step, double largest) {
  const int step_exponent = floor_log10(step);
  if (value == 0.0) return "0";
  if (largest >= 1e6 || largest < 1e-3) {
    const int digits = std::max(1, floor_log10(std::abs(value)) - step_exponent + 1);
    const int exponent = floor_log10(std::abs(value));
    if (exponent >= -4 && exponent < 7) return fixed(value, std::max(0, -step_exponent));
    return significant(value, digits);
  }
  return fixed(value, std::max(0, -step_exponent));
}

}  // namespace

double nice_step(double span, int intervals) {
  const double raw = span / intervals;
  const double magnitude = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * magnitude * (1.0 + kRounding)) return factor * magnitude;
  }
  return 10.0 * magnitude;
}

std::vector<Tick> linear_ticks(double lower, double upper, int intervals) {
  double step = nice_step(upper - lower, intervals);
  double first = std::ceil(lower / step - kRounding);
  double last = std::floor(upper / step + kRounding);
  // One number alone is no scale.
  for (int finer = 2; last - first < 1.0 && finer <= 16; finer *= 2) {
    step = nice_step(upper - lower, finer * intervals);
    first = std::ceil(lower / step - kRounding);
    last = std::floor(upper / step + kRounding);
  }
  const double largest = std::max(std::abs(lower), std::abs(upper));
  std::vector<Tick> ticks;
  for (double k = first; k <= last; k += 1.0) {
    const double value = k == 0.0 ? 0.0 : k * step;
    ticks.push_back({value, label(value, step, largest)});
  }
  return ticks;
}

std::vector<Tick> log_ticks(double lower, double upper, int intervals) {
  const int first = static_cast<int>(std::ceil(std::log10(lower) - kRounding));
  const int last = static_cast<int>(std::floor(std::log10(upper) + kRounding));
  const double decades = std::log10(upper / lower);
  std::vector<Tick> ticks;
  const int stride = std::max(1, static_cast<int>(std::ceil(decades / intervals)));
  for (int k = first - 1; k <= last; ++k) {
    const double power = std::pow(10.0, k);
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double value = factor * power;
      const bool within = value >= lower * (1.0 - kRounding) && value <= upper * (1.0 + kRounding);
      const bool wanted = factor == 1.0 ? (k % stride == 0) : decades < 2.0;
      if (within && wanted) ticks.push_back({value, significant(value, 1)});
    }
  }
  if (ticks.size() < 2) return linear_ticks(lower, upper, intervals);
  return ticks;
}

}  // namespace brachium::pipelines::report
