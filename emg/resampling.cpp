#include "emg/resampling.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace brachium::emg {
namespace {

constexpr std::ptrdiff_t half_width = 24;
constexpr double beta = 12.0;

// Modified Bessel function I0 by its series.
double bessel_i0(double x) {
  double term = 1.0, sum = 1.0;
  for (int k = 1; k <= 60; ++k) {
    term *= (x / (2.0 * k)) * (x / (2.0 * k));
    sum += term;
  }
  return sum;
}

double kernel(double t) {
  const double edge = t / half_width;
  if (!(std::abs(edge) < 1.0)) return 0.0;
  const double window = bessel_i0(beta * std::sqrt(1.0 - edge * edge)) / bessel_i0(beta);
  if (t == 0.0) return 1.0;
  return window * std::sin(std::numbers::pi * t) / (std::numbers::pi * t);
}

double reflected(std::span<const double> x, std::ptrdiff_t i) {
  const auto last = static_cast<std::ptrdiff_t>(x.size()) - 1;
  const auto at = [&](std::ptrdiff_t k) {
    return x[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(k, 0, last))];
  };
  if (i < 0) return 2.0 * x[0] - at(-i);
  if (i > last) return 2.0 * at(last) - at(2 * last - i);
  return at(i);
}

}  // namespace

void resample_in_place(std::span<double> samples, double ratio, std::size_t output_count) {
  const double whole = std::round(ratio);
  if (std::abs(ratio - whole) <= 1e-9 * ratio) {
    const auto step = static_cast<std::size_t>(whole);
    for (std::size_t k = 1; k < output_count && step > 1; ++k) samples[k] = samples[k * step];
    return;
  }
  // Not literally in place: an output may lie on input that its successors still need. The output is the shorter one.
  std::vector<double> output(output_count);
  for (std::size_t k = 0; k < output_count; ++k) {
    const double position = static_cast<double>(k) * ratio;
    const auto centre = static_cast<std::ptrdiff_t>(std::floor(position));
    double sum = 0.0, weight = 0.0;
    for (std::ptrdiff_t i = centre - half_width + 1; i <= centre + half_width; ++i) {
      const double w = kernel(position - static_cast<double>(i));
      weight += w;
      sum += w * reflected(samples, i);
    }
    output[k] = sum / weight;  // a constant stays that constant
  }
  std::copy(output.begin(), output.end(), samples.begin());
}

}  // namespace brachium::emg
