#include "emg/onset.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "data/model/error.hpp"
#include "emg/butterworth.hpp"
#include "emg/names.hpp"

namespace brachium::emg {
namespace {

constexpr std::array<std::pair<OnsetMethod, const char*>, 2> methods{
    {{OnsetMethod::threshold, "threshold"}, {OnsetMethod::tkeo, "tkeo"}}};

void check(std::span<const double> x, double rate_hz, const std::string& channel, const OnsetOptions& o) {
  std::vector<data::Diagnostic> list;
  const auto need = [&](bool good, const char* name, double value, const char* must) {
    if (!good || !std::isfinite(value)) {
      list.push_back({data::Severity::error,
                      "out-of-range",
                      fmt::format("`{}` = {} must be {}", name, value, must),
                      std::nullopt,
                      {}});
    }
  };
  need(rate_hz > 0.0, "rate_hz", rate_hz, "> 0");
  need(o.factor >= 0.0, "factor", o.factor, ">= 0");
  need(o.lowpass_hz > 0.0 && o.lowpass_hz < 0.5 * rate_hz, "lowpass_hz", o.lowpass_hz,
       "between 0 and half the rate");
  need(o.window_s > 0.0, "window_s", o.window_s, "> 0");
  need(o.minimum_active_s >= 0.0, "minimum_active_s", o.minimum_active_s, ">= 0");
  need(o.minimum_gap_s >= 0.0, "minimum_gap_s", o.minimum_gap_s, ">= 0");
  need(o.baseline_length_s > 0.0, "baseline_length_s", o.baseline_length_s, "> 0");
  if (!list.empty()) throw data::InputError(std::move(list));

  const double needed = std::max(o.window_s, o.baseline_length_s) + 0.05;
  if (static_cast<double>(x.size()) < needed * rate_hz) {
    throw data::InputError("trial-too-short",
                           fmt::format("channel `{}` has {:.4g} s; finding onsets needs at least {:.4g} s",
                                       channel, static_cast<double>(x.size()) / rate_hz, needed));
  }
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (std::isfinite(x[k])) continue;
    throw data::InputError("not-finite", fmt::format("channel `{}` is `{}` at sample {}", channel, x[k], k));
  }
}

std::vector<double> detector(std::span<const double> x, double rate_hz, const OnsetOptions& o) {
  std::vector<double> d(x.begin(), x.end());
  if (o.method == OnsetMethod::tkeo) {
    for (std::size_t k = 1; k + 1 < x.size(); ++k) d[k] = std::abs(x[k] * x[k] - x[k - 1] * x[k + 1]);
    d.front() = d[1];
    d.back() = d[d.size() - 2];
  }
  const DesignedFilter filter = design(FilterSpec::low_pass(o.lowpass_hz), rate_hz);
  const std::span<double> channel(d);
  filter_zero_lag(filter.sections, {&channel, 1}, {{}, true});
  return d;
}

struct Range {
  std::size_t first = 0, last = 0;  // [first, last)
};

// The samples that are taken as rest: those named, or the window of lowest mean.
Range baseline_range(std::span<const double> d, double rate_hz, double start_time_s,
                     const std::string& channel, const OnsetOptions& o) {
  if (o.baseline_from_s != o.baseline_to_s) {
    const double from = (o.baseline_from_s - start_time_s) * rate_hz;
    const double to = (o.baseline_to_s - start_time_s) * rate_hz;
    if (!(from >= -0.5 && to > from + 2.0 && to <= static_cast<double>(d.size()) + 0.5)) {
      throw data::InputError(
          "out-of-range",
          fmt::format("the baseline {} s to {} s of channel `{}` must lie inside the trial, {:.6g} s to "
                      "{:.6g} s, and hold more than two samples",
                      o.baseline_from_s, o.baseline_to_s, channel, start_time_s,
                      start_time_s + static_cast<double>(d.size()) / rate_hz));
    }
    return {static_cast<std::size_t>(std::max(0.0, std::round(from))),
            std::min(d.size(), static_cast<std::size_t>(std::round(to)))};
  }
  const auto width = std::max<std::size_t>(3, static_cast<std::size_t>(o.baseline_length_s * rate_hz));
  double lowest = 0.0;
  Range best;
  for (std::size_t first = 0; first + width <= d.size(); first += std::max<std::size_t>(1, width / 8)) {
    double sum = 0.0;
    for (const double v : d.subspan(first, width)) sum += v;
    if (best.last == 0 || sum < lowest) {
      lowest = sum;
      best = {first, first + width};
    }
  }
  return best;
}

// d above T here and on average over the window ahead switches on; both not, off.
std::vector<Range> active_ranges(std::span<const double> d, std::size_t window, double threshold) {
  std::vector<double> sums(d.size() + 1, 0.0);
  for (std::size_t k = 0; k < d.size(); ++k) sums[k + 1] = sums[k] + d[k];
  std::vector<Range> ranges;
  bool on = false;
  for (std::size_t k = 0; k < d.size(); ++k) {
    const std::size_t end = std::min(d.size(), k + window);
    const bool ahead = (sums[end] - sums[k]) / static_cast<double>(end - k) > threshold;
    const bool here = d[k] > threshold;
    if (!on && here && ahead) {
      ranges.push_back({k, d.size()});
      on = true;
    } else if (on && !here && !ahead) {
      ranges.back().last = k;
      on = false;
    }
  }
  return ranges;
}

std::vector<Range> merged(const std::vector<Range>& ranges, std::size_t shortest_gap, std::size_t shortest) {
  std::vector<Range> joined;
  for (const Range& r : ranges) {
    if (!joined.empty() && r.first - joined.back().last < shortest_gap) {
      joined.back().last = r.last;
    } else {
      joined.push_back(r);
    }
  }
  std::erase_if(joined, [&](const Range& r) { return r.last - r.first < shortest; });
  return joined;
}

}  // namespace

std::string to_string(OnsetMethod method) {
  return name_of(methods, method);
}
OnsetMethod parse_onset_method(const std::string& name) {
  return parse_name(methods, name, "unknown-onset-method", "a method of onset detection");
}

OnsetResult detect_onsets(std::span<const double> samples, double rate_hz, double start_time_s,
                          const std::string& channel, const OnsetOptions& o) {
  check(samples, rate_hz, channel, o);
  const std::vector<double> d = detector(samples, rate_hz, o);
  const auto time = [&](std::size_t k) { return start_time_s + static_cast<double>(k) / rate_hz; };

  OnsetResult result;
  const Range rest = baseline_range(d, rate_hz, start_time_s, channel, o);
  const auto n = static_cast<double>(rest.last - rest.first);
  for (std::size_t k = rest.first; k < rest.last; ++k) result.baseline_mean += d[k] / n;
  double variance = 0.0;
  for (std::size_t k = rest.first; k < rest.last; ++k)
    variance += std::pow(d[k] - result.baseline_mean, 2) / (n - 1.0);
  result.baseline_sd = std::sqrt(variance);
  result.baseline_from_s = time(rest.first);
  result.baseline_to_s = time(rest.last);
  if (!(result.baseline_sd > 0.0)) {
    throw data::InputError(
        "constant-channel",
        fmt::format("channel `{}` does not vary at rest ({:.6g} s to {:.6g} s): no threshold can be set",
                    channel, result.baseline_from_s, result.baseline_to_s),
        "name a baseline in which the channel was recording");
  }
  const double h = o.factor > 0.0 ? o.factor : o.method == OnsetMethod::tkeo ? 15.0 : 3.0;
  result.threshold = result.baseline_mean + h * result.baseline_sd;

  const auto samples_of = [&](double seconds) {
    return static_cast<std::size_t>(std::lround(seconds * rate_hz));
  };
  const std::vector<Range> raw =
      active_ranges(d, std::max<std::size_t>(1, samples_of(o.window_s)), result.threshold);
  for (const Range& r : merged(raw, samples_of(o.minimum_gap_s), samples_of(o.minimum_active_s))) {
    Burst burst;
    burst.onset_s = time(r.first);
    burst.offset_s = time(r.last);
    for (std::size_t k = r.first; k < r.last; ++k) burst.mean_detector += d[k];
    burst.mean_detector /= static_cast<double>(r.last - r.first) * result.threshold;
    burst.cut_at_start = r.first == 0;
    burst.cut_at_end = r.last == d.size();
    result.bursts.push_back(burst);
  }
  return result;
}

}  // namespace brachium::emg
