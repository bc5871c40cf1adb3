#include "emg/quality.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::emg {
namespace {

void check(std::size_t count, double rate_hz, const std::string& trial, const std::string& channel,
           const QualityOptions& o) {
  std::vector<data::Diagnostic> list;
  const auto positive = [&](const char* name, double value) {
    if (!(value > 0.0)) {
      list.push_back({data::Severity::error,
                      "out-of-range",
                      fmt::format("`{}` = {} must be > 0", name, value),
                      std::nullopt,
                      {}});
    }
  };
  positive("rate_hz", rate_hz);
  positive("dropout_s", o.dropout_s);
  positive("baseline_window_s", o.baseline_window_s);
  positive("activity_window_s", o.activity_window_s);
  positive("welch_s", o.welch_s);
  if (!(o.line_hz >= 0.0)) {
    list.push_back({data::Severity::error,
                    "out-of-range",
                    fmt::format("`line_hz` = {} must be >= 0", o.line_hz),
                    std::nullopt,
                    {}});
  }
  if (!list.empty()) throw data::InputError(std::move(list));
  const double needed = std::max({2.0 * o.welch_s, 2.0 * o.baseline_window_s, 4.0 * o.activity_window_s});
  if (static_cast<double>(count) < needed * rate_hz) {
    throw data::InputError(
        "trial-too-short",
        fmt::format("channel `{}` of trial `{}` has {:.4g} s; judging its quality needs {:.4g} s", channel,
                    trial, static_cast<double>(count) / rate_hz, needed));
  }
}

// Runs of one repeated value: at the extremes they are clipping (from two samples on), elsewhere dropouts if long.
void measure_runs(std::span<const double> x, double rate_hz, const QualityOptions& o, ChannelQuality& q) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const auto shortest = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(o.dropout_s * rate_hz)));
  std::size_t clipped = 0, dropped = 0, longest = 0;
  for (std::size_t k = 0; k < x.size();) {
    std::size_t end = k + 1;
    while (end < x.size() && x[end] == x[k]) ++end;
    const std::size_t length = end - k;
    if (length >= 2 && (x[k] == *low || x[k] == *high)) {
      clipped += length;
    } else if (length >= shortest) {
      dropped += length;
      ++q.dropouts;
      longest = std::max(longest, length);
    }
    k = end;
  }
  q.clipped_fraction = static_cast<double>(clipped) / static_cast<double>(x.size());
  q.dropout_fraction = static_cast<double>(dropped) / static_cast<double>(x.size());
  q.longest_dropout_s = static_cast<double>(longest) / rate_hz;
}

// The baseline: means of consecutive windows. Its range, and the RMS about it.
void measure_baseline(std::span<const double> x, double rate_hz, const QualityOptions& o, ChannelQuality& q) {
  const std::size_t width = std::max<std::size_t>(1, static_cast<std::size_t>(o.baseline_window_s * rate_hz));
  double low = 0.0, high = 0.0, total = 0.0, power = 0.0;
  std::size_t used = 0;
  for (std::size_t first = 0; first + width <= x.size(); first += width) {
    double mean = 0.0;
    for (const double v : x.subspan(first, width)) mean += v;
    mean /= static_cast<double>(width);
    for (const double v : x.subspan(first, width)) power += (v - mean) * (v - mean);
    low = used == 0 ? mean : std::min(low, mean);
    high = used == 0 ? mean : std::max(high, mean);
    total += mean * static_cast<double>(width);
    used += width;
  }
  q.mean = total / static_cast<double>(used);
  q.rms = std::sqrt(power / static_cast<double>(used));
  q.baseline_drift = q.rms > 0.0 ? (high - low) / q.rms : 0.0;
}

// 5th and 95th percentile of the RMS in windows that overlap by half.
void measure_activity(std::span<const double> x, double rate_hz, const QualityOptions& o, ChannelQuality& q) {
  const std::size_t width = std::max<std::size_t>(2, static_cast<std::size_t>(o.activity_window_s * rate_hz));
  std::vector<double> rms;
  for (std::size_t first = 0; first + width <= x.size(); first += width / 2) {
    double mean = 0.0, power = 0.0;
    for (const double v : x.subspan(first, width)) mean += v;
    mean /= static_cast<double>(width);
    for (const double v : x.subspan(first, width)) power += (v - mean) * (v - mean);
    rms.push_back(std::sqrt(power / static_cast<double>(width)));
  }
  std::sort(rms.begin(), rms.end());
  const auto percentile = [&](double p) {
    return rms[static_cast<std::size_t>(std::lround(p * static_cast<double>(rms.size() - 1)))];
  };
  const double rest = percentile(0.05), activity = percentile(0.95);
  // A rest of exact zeros (a gated recording) has no measurable noise: 200 dB stands for "no noise seen".
  q.snr_db =
      activity > 0.0 ? (rest > 0.0 ? std::min(200.0, 20.0 * std::log10(activity / rest)) : 200.0) : 0.0;
}

// Power that stands out at a line frequency and its harmonics, as a share of all power: the bins within the Hann
// window's main lobe minus the median of the bins 3 to 7 away on both sides.
double line_share(const Periodogram& p, double line_hz, int harmonics) {
  double total = 0.0, line = 0.0;
  for (std::size_t k = 1; k < p.density.size(); ++k) total += p.density[k];
  for (int i = 1; i <= harmonics; ++i) {
    const auto centre = static_cast<std::ptrdiff_t>(std::lround(i * line_hz / p.resolution_hz));
    const auto size = static_cast<std::ptrdiff_t>(p.density.size());
    if (centre + 2 >= size) break;
    std::vector<double> around;
    for (std::ptrdiff_t d = 3; d <= 7; ++d) {
      if (centre - d > 0) around.push_back(p.density[static_cast<std::size_t>(centre - d)]);
      if (centre + d < size) around.push_back(p.density[static_cast<std::size_t>(centre + d)]);
    }
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
    std::nth_element(around.begin(), middle, around.end());
    for (std::ptrdiff_t d = -2; d <= 2; ++d) {
      if (centre + d > 0) line += std::max(0.0, p.density[static_cast<std::size_t>(centre + d)] - *middle);
    }
  }
  return total > 0.0 ? line / total : 0.0;
}

void measure_spectrum(std::span<const double> x, double rate_hz, const QualityOptions& o, ChannelQuality& q) {
  const Periodogram p = welch(x, rate_hz, o.welch_s);
  q.median_hz = median_frequency(p, 5.0, 0.5 * rate_hz);
  for (const double line : {50.0, 60.0}) {
    const double f = o.line_hz > 0.0 ? o.line_hz : line;
    const double share = line_share(p, f, o.line_harmonics);
    if (q.line_hz == 0.0 || share > q.line_ratio) {
      q.line_ratio = share;
      q.line_hz = f;
    }
  }
}

void judge(const QualityOptions& o, ChannelQuality& q) {
  const auto reason = [&](bool bad, std::string text) {
    if (bad) q.reasons.push_back(std::move(text));
  };
  reason(q.clipped_fraction > o.clipping_fraction,
         fmt::format("clipping: {:.3g} % of the samples lie at the range's ends (limit {:.3g} %)",
                     100.0 * q.clipped_fraction, 100.0 * o.clipping_fraction));
  reason(q.dropout_fraction > 0.5,
         fmt::format("flat line: {:.3g} % of the trial repeats one value", 100.0 * q.dropout_fraction));
  reason(
      q.dropout_fraction > o.dropout_fraction,
      fmt::format("dropouts: {} runs of one repeated value, {:.3g} % of the trial, the longest {:.3g} s "
                  "(limit {:.3g} %)",
                  q.dropouts, 100.0 * q.dropout_fraction, q.longest_dropout_s, 100.0 * o.dropout_fraction));
  reason(q.line_ratio > o.line_ratio,
         fmt::format("line noise: {:.3g} % of the power at {} Hz and its harmonics (limit {:.3g} %)",
                     100.0 * q.line_ratio, q.line_hz, 100.0 * o.line_ratio));
  reason(q.snr_db < o.snr_db,
         fmt::format("activity is only {:.3g} dB above rest (limit {:.3g} dB)", q.snr_db, o.snr_db));
  reason(q.baseline_drift > o.baseline_drift,
         fmt::format("baseline drift: the baseline moves by {:.3g} x the EMG's RMS (limit {:.3g})",
                     q.baseline_drift, o.baseline_drift));
  reason(q.median_hz < o.median_low_hz || q.median_hz > o.median_high_hz,
         fmt::format("median frequency {:.3g} Hz is not that of surface EMG ({:.3g}-{:.3g} Hz)", q.median_hz,
                     o.median_low_hz, o.median_high_hz));
}

}  // namespace

ChannelQuality assess(std::span<const double> samples, double rate_hz, const std::string& trial,
                      const std::string& channel, const QualityOptions& options) {
  check(samples.size(), rate_hz, trial, channel, options);
  ChannelQuality q;
  q.trial = trial;
  q.channel = channel;
  q.not_finite_samples = static_cast<std::size_t>(
      std::count_if(samples.begin(), samples.end(), [](double x) { return !std::isfinite(x); }));
  q.finite = q.not_finite_samples == 0;
  if (!q.finite) {
    q.reasons.push_back(fmt::format("{} samples are not finite", q.not_finite_samples));
    return q;
  }
  q.constant = std::all_of(samples.begin(), samples.end(), [&](double x) { return x == samples.front(); });
  if (q.constant) {
    q.mean = samples.front();
    q.reasons.push_back(fmt::format("constant: every sample is {:.6g}", samples.front()));
    return q;
  }
  measure_runs(samples, rate_hz, options, q);
  measure_baseline(samples, rate_hz, options, q);
  measure_activity(samples, rate_hz, options, q);
  measure_spectrum(samples, rate_hz, options, q);
  judge(options, q);
  return q;
}

}  // namespace brachium::emg
