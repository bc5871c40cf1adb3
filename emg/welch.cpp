#include "emg/welch.hpp"

#include <fmt/format.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_fft_real.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

#include "data/model/error.hpp"

namespace brachium::emg {
namespace {

struct Free {
  void operator()(gsl_fft_real_wavetable* p) const { gsl_fft_real_wavetable_free(p); }
  void operator()(gsl_fft_real_workspace* p) const { gsl_fft_real_workspace_free(p); }
};

// Adds |X_k|^2 of a real signal to `power`; GSL packs x as (re 0, re 1, im 1, re 2, im 2, ...).
void add_power(std::span<const double> packed, std::span<double> power) {
  const std::size_t n = packed.size();
  power[0] += packed[0] * packed[0];
  for (std::size_t k = 1; k < power.size(); ++k) {
    const double re = packed[2 * k - 1];
    const double im = 2 * k < n ? packed[2 * k] : 0.0;
    power[k] += re * re + im * im;
  }
}

}  // namespace

Periodogram welch(std::span<const double> samples, double rate_hz, double segment_s) {
  const auto n = static_cast<std::size_t>(std::lround(segment_s * rate_hz));
  if (n < 8 || samples.size() < n) {
    throw data::InputError(
        "trial-too-short",
        fmt::format("a periodogram of `{}` s segments at {} Hz needs at least {} samples, there are {}",
                    segment_s, rate_hz, std::max<std::size_t>(n, 8), samples.size()));
  }
  const std::unique_ptr<gsl_fft_real_wavetable, Free> table(gsl_fft_real_wavetable_alloc(n));
  const std::unique_ptr<gsl_fft_real_workspace, Free> workspace(gsl_fft_real_workspace_alloc(n));
  if (!table || !workspace) throw std::bad_alloc();

  std::vector<double> window(n), segment(n);
  double window_power = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    window[i] =
        0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n));
    window_power += window[i] * window[i];
  }

  Periodogram result;
  result.resolution_hz = rate_hz / static_cast<double>(n);
  result.density.assign(n / 2 + 1, 0.0);
  std::size_t segments = 0;
  for (std::size_t first = 0; first + n <= samples.size(); first += n - n / 2) {
    double mean = 0.0;
    for (const double x : samples.subspan(first, n)) mean += x;
    mean /= static_cast<double>(n);
    for (std::size_t i = 0; i < n; ++i) segment[i] = (samples[first + i] - mean) * window[i];
    if (gsl_fft_real_transform(segment.data(), 1, n, table.get(), workspace.get()) != GSL_SUCCESS) {
      throw std::logic_error("welch: the transform failed");
    }
    add_power(segment, result.density);
    ++segments;
  }
  const double scale = 1.0 / (rate_hz * window_power * static_cast<double>(segments));
  for (std::size_t k = 0; k < result.density.size(); ++k) {
    const bool single = k == 0 || (n % 2 == 0 && k == n / 2);  // these have no mirror image
    result.density[k] *= single ? scale : 2.0 * scale;
  }
  return result;
}

double median_frequency(const Periodogram& p, double low_hz, double high_hz) {
  const double h = p.resolution_hz;
  // Bin k covers (k - 1/2) h to (k + 1/2) h.
  const auto covered = [&](std::size_t k) {
    const double from = std::max(low_hz, (static_cast<double>(k) - 0.5) * h);
    const double to = std::min(high_hz, (static_cast<double>(k) + 0.5) * h);
    return std::pair{from, std::max(from, to)};
  };
  double total = 0.0;
  for (std::size_t k = 0; k < p.density.size(); ++k) {
    const auto [from, to] = covered(k);
    total += p.density[k] * (to - from);
  }
  if (!(total > 0.0)) return 0.0;
  double below = 0.0;
  for (std::size_t k = 0; k < p.density.size(); ++k) {
    const auto [from, to] = covered(k);
    const double here = p.density[k] * (to - from);
    if (below + here >= 0.5 * total) return from + (0.5 * total - below) / p.density[k];
    below += here;
  }
  return high_hz;
}

}  // namespace brachium::emg
