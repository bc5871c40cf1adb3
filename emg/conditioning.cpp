#include "emg/conditioning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "emg/resampling.hpp"

namespace brachium::emg {
namespace {

// Sum in eight interleaved parts, so that additions need not wait for each other, in blocks, so that the
// rounding error does not grow with the length. The order of additions is fixed: the same bits everywhere.
double blocked_sum(std::span<const double> x) {
  double total = 0.0;
  for (std::size_t first = 0; first < x.size(); first += 4096) {
    const std::span<const double> block = x.subspan(first, std::min<std::size_t>(4096, x.size() - first));
    double part[8] = {};
    std::size_t k = 0;
    for (; k + 8 <= block.size(); k += 8) {
      for (std::size_t i = 0; i < 8; ++i) part[i] += block[k + i];
    }
    for (; k < block.size(); ++k) part[0] += block[k];
    total += ((part[0] + part[1]) + (part[2] + part[3])) + ((part[4] + part[5]) + (part[6] + part[7]));
  }
  return total;
}

// Sum of a channel's samples, edges of `edge` samples excluded, and whether it can be believed: a NaN or Inf
// among all samples makes it NaN or Inf, so that one pass over memory does for both.
struct Sum {
  double inner = 0.0;
  bool finite = true;
};
Sum sum_of(std::span<const double> x, std::size_t edge) {
  const double inner = blocked_sum(x.subspan(edge, x.size() - 2 * edge));
  return {inner, std::isfinite(inner + (blocked_sum(x.first(edge)) + blocked_sum(x.last(edge))))};
}

void check_samples(const ConditioningChain& chain, std::span<const std::span<double>> channels,
                   std::span<const Sum> sums, std::span<const std::string> names, const std::string& trial) {
  std::vector<data::Diagnostic> list;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (sums[c].finite) continue;
    const auto bad = [](double x) { return !std::isfinite(x); };
    const auto first = std::find_if(channels[c].begin(), channels[c].end(), bad);
    if (first == channels[c].end()) {
      list.push_back(
          {data::Severity::error, "not-finite",
           fmt::format("the sum of the samples of channel `{}` of trial `{}` is beyond the range of numbers",
                       names[c], trial),
           std::nullopt, "check the channel's unit and its file"});
      continue;
    }
    const auto count = std::count_if(channels[c].begin(), channels[c].end(), bad);
    const auto index = static_cast<std::size_t>(first - channels[c].begin());
    list.push_back(
        {data::Severity::error, "not-finite",
         fmt::format(
             "channel `{}` of trial `{}` has {} samples that are not finite, the first, {}, at {:.6g} s",
             names[c], trial, count, *first, static_cast<double>(index) / chain.rate_hz),
         std::nullopt, "cut the trial, or leave the channel out by name"});
  }
  if (!list.empty()) throw data::InputError(std::move(list));
}

// Samples at either end that the mean leaves out.
std::size_t offset_edge(const ConditioningChain& chain, std::size_t count) {
  return std::min(static_cast<std::size_t>(chain.options.offset_edge_s * chain.rate_hz), count / 4);
}

void apply(const DesignedFilter& filter, std::span<const std::span<double>> channels,
           const Preparation& preparation) {
  if (filter.spec.phase == Phase::zero_lag) {
    filter_zero_lag(filter.sections, channels, preparation);
  } else {
    filter_causal(filter.sections, channels, preparation);
  }
}

// What a filter would do on its way in, where there is no filter to do it.
void prepare(std::span<const std::span<double>> channels, const Preparation& preparation) {
  for (std::size_t c = 0; c < channels.size(); ++c) {
    for (double& x : channels[c]) {
      if (!preparation.subtract.empty()) x -= preparation.subtract[c];
      if (preparation.rectify) x = std::abs(x);
    }
  }
}

void run(std::span<const DesignedFilter> filters, std::span<const std::span<double>> channels,
         const Preparation& preparation) {
  if (filters.empty()) prepare(channels, preparation);
  for (std::size_t i = 0; i < filters.size(); ++i) {
    apply(filters[i], channels, i == 0 ? preparation : Preparation{});
  }
}

std::vector<double> window_of(const ConditioningSteps& steps, std::span<const std::span<double>> channels) {
  const auto from = channels[steps.channel].subspan(steps.first, steps.count);
  return {from.begin(), from.end()};
}

}  // namespace

OutputLayout condition(const ConditioningChain& chain, std::span<const std::span<double>> channels,
                       std::span<const std::string> names, const std::string& trial, ConditioningSteps* steps,
                       std::vector<double>* offsets) {
  if (channels.empty()) return {};
  if (names.size() != channels.size()) throw std::logic_error("condition: one name per channel");
  const std::size_t n = channels.front().size();
  for (std::size_t c = 0; c < channels.size(); ++c) {
    if (channels[c].size() != n) {
      throw data::InputError(
          "length-mismatch",
          fmt::format("channels `{}` and `{}` of trial `{}` differ in length: {} and {} samples", names[0],
                      names[c], trial, n, channels[c].size()));
    }
  }
  const OutputLayout layout = output_layout(chain, n, trial);
  const std::size_t edge = offset_edge(chain, n);
  std::vector<Sum> sums;
  for (const std::span<double>& channel : channels) sums.push_back(sum_of(channel, edge));
  check_samples(chain, channels, sums, names, trial);
  if (steps && (steps->channel >= channels.size() || steps->first + steps->count > n)) {
    throw std::logic_error("condition: the window of steps lies outside the trial");
  }

  std::vector<double> offset(channels.size(), 0.0);
  if (chain.options.remove_offset) {
    for (std::size_t c = 0; c < channels.size(); ++c)
      offset[c] = sums[c].inner / static_cast<double>(n - 2 * edge);
  }
  if (steps) {
    steps->raw = window_of(*steps, channels);
    steps->offset_removed = steps->raw;
    for (double& x : steps->offset_removed) x -= offset[steps->channel];
  }
  for (std::size_t first = 0; first < channels.size(); first += channels_at_once) {
    const std::size_t size = std::min(channels_at_once, channels.size() - first);
    const std::span<const std::span<double>> group = channels.subspan(first, size);
    const bool shown = steps && steps->channel >= first && steps->channel < first + size;
    const std::span<const double> subtract = std::span<const double>(offset).subspan(first, size);
    run(chain.band, group, {chain.options.remove_offset ? subtract : std::span<const double>{}, false});
    if (shown) {
      steps->filtered = window_of(*steps, channels);
      steps->rectified = steps->filtered;
      if (chain.options.rectify) {
        for (double& x : steps->rectified) x = std::abs(x);
      }
    }
    run(chain.envelope, group, {{}, chain.options.rectify});
    if (shown) steps->envelope = window_of(*steps, channels);
  }

  for (const std::span<double>& channel : channels) {
    if (layout.first > 0) {
      std::copy(channel.begin() + static_cast<std::ptrdiff_t>(layout.first),
                channel.begin() + static_cast<std::ptrdiff_t>(layout.first + layout.kept), channel.begin());
    }
    resample_in_place(channel.first(layout.kept), chain.rate_hz / chain.output_rate_hz, layout.count);
  }
  if (offsets) *offsets = std::move(offset);
  return layout;
}

}  // namespace brachium::emg
