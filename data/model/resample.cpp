#include "data/model/resample.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>

#include "data/model/error.hpp"

namespace brachium::data {
namespace {

constexpr double grid_tolerance = 1e-6;    // [sample periods]
constexpr std::size_t most_phases = 4096;  // filters kept for one pair of rates

/// Modified Bessel function of the first kind and order 0, by its power series (all terms positive: no
/// cancellation).
double bessel_i0(double x) {
  double term = 1.0, sum = 1.0;
  for (int k = 1; term > 1e-18 * sum; ++k) {
    term *= (0.5 * x / k) * (0.5 * x / k);
    sum += term;
  }
  return sum;
}

/// The kernel sampled at the input's times around one output: weights of inputs first, first + 1, ...
struct Taps {
  std::ptrdiff_t offset = 0;  // of the first weight, relative to the input sample at or before the output
  std::vector<double> weights;
};

/// Weights for an output `fraction` (in [0, 1)) of a sample period behind an input sample.
///   w_k = sinc(2 f_c tau) I0(beta sqrt(1 - (tau/h)^2)),  tau = (k - fraction) / f_in,  sum w_k = 1
Taps taps_at(double fraction, double from_hz, const ResampleFilter& filter) {
  const double cutoff = 0.5 * (filter.passband_hz + filter.stopband_hz);
  const double half = filter.half_width_s * from_hz;  // [samples]
  const auto first = static_cast<std::ptrdiff_t>(std::ceil(fraction - half));
  const auto last = static_cast<std::ptrdiff_t>(std::floor(fraction + half));
  Taps taps{first, {}};
  double sum = 0.0;
  for (std::ptrdiff_t k = first; k <= last; ++k) {
    const double distance = static_cast<double>(k) - fraction;
    const double x = 2.0 * std::numbers::pi * cutoff * distance / from_hz;
    const double sinc = std::abs(x) < 1e-12 ? 1.0 : std::sin(x) / x;
    const double u = distance / half;
    const double w = sinc * bessel_i0(filter.beta * std::sqrt(std::max(0.0, 1.0 - u * u)));
    taps.weights.push_back(w);
    sum += w;
  }
  // Constants pass exactly, at every phase.
  for (double& w : taps.weights) w /= sum;
  return taps;
}

/// Sample i of a signal continued beyond both ends by point reflection: x(-i) = 2 x(0) - x(i).
double reflected(std::span<const double> x, std::ptrdiff_t i) {
  const auto n = static_cast<std::ptrdiff_t>(x.size());
  double sign = 1.0, shift = 0.0;
  while (i < 0 || i >= n) {
    const double end = i < 0 ? x.front() : x.back();
    shift += sign * 2.0 * end;
    sign = -sign;
    i = i < 0 ? -i : 2 * (n - 1) - i;
  }
  return shift + sign * x[static_cast<std::size_t>(i)];
}

double apply(const Taps& taps, std::span<const double> x, std::ptrdiff_t at) {
  const std::ptrdiff_t first = at + taps.offset;
  const auto n = static_cast<std::ptrdiff_t>(x.size()), m = static_cast<std::ptrdiff_t>(taps.weights.size());
  double sum = 0.0;
  if (first >= 0 && first + m <= n) {
    const double* from = x.data() + first;
    for (std::ptrdiff_t k = 0; k < m; ++k) sum += taps.weights[static_cast<std::size_t>(k)] * from[k];
    return sum;
  }
  for (std::ptrdiff_t k = 0; k < m; ++k)
    sum += taps.weights[static_cast<std::size_t>(k)] * reflected(x, first + k);
  return sum;
}

[[noreturn]] void outside(const SignalInfo& info, double from_s, double to_s) {
  throw InputError(
      "outside-signal",
      fmt::format("signal `{}` lasts from {:.6g} s to {:.6g} s; samples from {:.6g} s to {:.6g} s are wanted",
                  info.name, info.start_time_s, info.end_time_s(), from_s, to_s),
      "use the common time span of the signals");
}

void check_rate(double rate_hz) {
  if (!(rate_hz > 0.0) || !std::isfinite(rate_hz))
    throw InputError("bad-rate", fmt::format("a rate must be greater than 0, not {} Hz", rate_hz));
}

void check_samples(const Signal& signal, std::size_t least) {
  if (signal.samples.size() < least) {
    throw InputError("too-short", fmt::format("signal `{}` has {} samples, at least {} are needed",
                                              signal.info.name, signal.samples.size(), least));
  }
  const auto bad =
      std::find_if(signal.samples.begin(), signal.samples.end(), [](double v) { return !std::isfinite(v); });
  if (bad == signal.samples.end()) return;
  throw InputError("non-finite-sample",
                   fmt::format("signal `{}` has {} at {:.6g} s", signal.info.name, *bad,
                               signal.info.time_s(static_cast<std::size_t>(bad - signal.samples.begin()))));
}

/// Whole and fractional part of a position, where a position within tolerance of a sample is that sample.
std::pair<std::ptrdiff_t, double> split(double position) {
  const double nearest = std::round(position);
  if (std::abs(position - nearest) <= grid_tolerance) return {static_cast<std::ptrdiff_t>(nearest), 0.0};
  const double below = std::floor(position);
  return {static_cast<std::ptrdiff_t>(below), position - below};
}

}  // namespace

ResampleFilter design_resampling(double from_hz, double to_hz, const ResampleOptions& options) {
  check_rate(from_hz);
  check_rate(to_hz);
  const double a = options.attenuation_db;
  if (!(options.passband > 0.0 && options.passband < 1.0)) {
    throw InputError("bad-option", fmt::format("`passband` must lie in (0, 1), not be {}", options.passband));
  }
  if (!(a >= 30.0 && a <= 160.0))
    throw InputError("bad-option", fmt::format("`attenuation_db` must lie in [30, 160], not be {}", a));
  ResampleFilter filter;
  filter.stopband_hz = 0.5 * std::min(from_hz, to_hz);
  filter.passband_hz = options.passband * filter.stopband_hz;
  filter.attenuation_db = a;
  // Kaiser & Schafer's fits: beta(A), and N - 1 = (A - 7.95) / (2.285 delta_omega) taps.
  filter.beta = a > 50.0 ? 0.1102 * (a - 8.7) : 0.5842 * std::pow(a - 21.0, 0.4) + 0.07886 * (a - 21.0);
  const double transition = 2.0 * std::numbers::pi * (filter.stopband_hz - filter.passband_hz);  // [rad/s]
  filter.half_width_s = 0.5 * (a - 7.95) / (2.285 * transition);
  return filter;
}

Signal resample(const Signal& signal, const TimeGrid& grid, const ResampleOptions& options) {
  check_rate(grid.rate_hz);
  check_rate(signal.info.rate_hz);
  check_samples(signal, 2);
  const double from_hz = signal.info.rate_hz;
  const double origin =
      (grid.start_s - signal.info.start_time_s) * from_hz;  // position of output 0 [input samples]
  const double step = from_hz / grid.rate_hz;
  const double end = origin + step * (grid.count == 0 ? 0.0 : static_cast<double>(grid.count - 1));
  const auto last = static_cast<double>(signal.samples.size() - 1);
  if (grid.count == 0 || !(origin >= -grid_tolerance) || !(end <= last + grid_tolerance)) {
    outside(signal.info, grid.start_s, grid.count == 0 ? grid.start_s : grid.time_s(grid.count - 1));
  }
  Signal out{signal.info, std::vector<double>(grid.count)};
  out.info.rate_hz = grid.rate_hz;
  out.info.start_time_s = grid.start_s;
  out.info.count = grid.count;
  if (std::abs(end - origin - static_cast<double>(grid.count - 1)) <= grid_tolerance &&
      split(origin).second == 0.0) {
    std::copy_n(signal.samples.begin() + split(origin).first, grid.count, out.samples.begin());
    return out;
  }
  const ResampleFilter filter = design_resampling(from_hz, grid.rate_hz, options);
  // Outputs at the same fraction of an input period share their weights (polyphase).
  std::map<std::int64_t, Taps> phases;
  constexpr double resolution = 1e9;  // fractions closer than 1e-9 of a period count as the same
  for (std::size_t j = 0; j < grid.count; ++j) {
    const auto [at, fraction] = split(origin + step * static_cast<double>(j));
    const auto key = static_cast<std::int64_t>(std::llround(fraction * resolution));
    auto found = phases.find(key);
    if (found == phases.end()) {
      if (phases.size() >= most_phases) phases.clear();
      found = phases.emplace(key, taps_at(fraction, from_hz, filter)).first;
    }
    out.samples[j] = apply(found->second, signal.samples, at);
  }
  out.info.attributes["resampled"] = fmt::format(
      "from {:.9g} Hz to {:.9g} Hz by a Kaiser-windowed sinc (gain 1 up to {:.6g} Hz, -{:.6g} dB from {:.6g} "
      "Hz, beta {:.4g}, "
      "{:.4g} s to each side); point reflection at both ends",
      from_hz, grid.rate_hz, filter.passband_hz, filter.attenuation_db, filter.stopband_hz, filter.beta,
      filter.half_width_s);
  return out;
}

TimeGrid common_grid(std::span<const SignalInfo> signals, double rate_hz) {
  check_rate(rate_hz);
  if (signals.empty()) throw InputError("no-signals", "there is no signal to align");
  const SignalInfo* latest = &signals.front();
  const SignalInfo* earliest = &signals.front();
  for (const SignalInfo& s : signals) {
    if (s.start_time_s > latest->start_time_s) latest = &s;
    if (s.end_time_s() < earliest->end_time_s()) earliest = &s;
  }
  const double start = latest->start_time_s, end = earliest->end_time_s();
  // Rounding of time stamps must not cost a sample.
  const double steps = std::floor((end - start) * rate_hz + grid_tolerance);
  if (!(steps >= 0.0)) {
    throw InputError(
        "no-common-window",
        fmt::format("signals `{}` and `{}` do not overlap in time: one ends at {:.6g} s, the other begins at "
                    "{:.6g} s",
                    earliest->name, latest->name, end, start),
        "check the start times; `time_offset_s` of a session description moves a recorder's clock");
  }
  return {rate_hz, start, static_cast<std::size_t>(steps) + 1};
}

std::vector<Signal> align(std::span<const Signal> signals, double rate_hz, const ResampleOptions& options) {
  std::vector<SignalInfo> infos;
  for (const Signal& s : signals) {
    infos.push_back(s.info);
    infos.back().count = s.samples.size();
  }
  const TimeGrid grid = common_grid(infos, rate_hz);
  std::vector<Signal> out;
  for (const Signal& s : signals) out.push_back(resample(s, grid, options));
  return out;
}

std::vector<double> evaluate_at(const Signal& signal, std::span<const double> times_s,
                                Interpolation interpolation) {
  const std::size_t order = interpolation == Interpolation::cubic ? 3 : 1;
  check_samples(signal, order + 1);
  check_rate(signal.info.rate_hz);
  const std::vector<double>& x = signal.samples;
  const auto last = static_cast<double>(x.size() - 1);
  std::vector<double> out;
  out.reserve(times_s.size());
  for (const double t : times_s) {
    const double position = (t - signal.info.start_time_s) * signal.info.rate_hz;
    if (!(position >= -grid_tolerance && position <= last + grid_tolerance)) outside(signal.info, t, t);
    const double p = std::clamp(position, 0.0, last);  // by at most the tolerance just checked
    if (interpolation == Interpolation::linear) {
      const auto i = std::min(static_cast<std::size_t>(p), x.size() - 2);
      const double u = p - static_cast<double>(i);
      out.push_back(x[i] + u * (x[i + 1] - x[i]));
      continue;
    }
    // The four samples around p, shifted inwards at the ends.
    const auto below = static_cast<std::ptrdiff_t>(p);
    const auto i = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(below - 1, 0, static_cast<std::ptrdiff_t>(x.size()) - 4));
    const double u = p - static_cast<double>(i);  // in [0, 3]
    const double u1 = u - 1.0, u2 = u - 2.0, u3 = u - 3.0;
    out.push_back(-x[i] * u1 * u2 * u3 / 6.0 + x[i + 1] * u * u2 * u3 / 2.0 - x[i + 2] * u * u1 * u3 / 2.0 +
                  x[i + 3] * u * u1 * u2 / 6.0);
  }
  return out;
}

}  // namespace brachium::data
