#include "emg/conditioning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "emg/resampling.hpp"

namespace brachium::emg {
namespace {

void check_samples(const ConditioningChain& chain, std::span<const std::span<double>> channels,
                   std::span<const std::string> names, const std::string& trial) {
  std::vector<data::Diagnostic> list;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    double zero = 0.0;  // stays 0 unless a sample is NaN or Inf
    for (const double x : channels[c]) zero += 0.0 * x;
    if (zero == 0.0) continue;
    const auto bad = [](double x) { return !std::isfinite(x); };
    const auto first = std::find_if(channels[c].begin(), channels[c].end(), bad);
    const auto count = std::count_if(channels[c].begin(), channels[c].end(), bad);
    const auto index = static_cast<std::size_t>(first - channels[c].begin());
    list.push_back({data::Severity::error, "not-finite",
                    fmt::format("channel `{}` of trial `{}` has {} samples that are not finite, the first, {}, at {:.6g} s",
                                names[c], trial, count, *first, static_cast<double>(index) / chain.rate_hz),
                    std::nullopt, "cut the trial, or leave the channel out by name"});
  }
  if (!list.empty()) throw data::InputError(std::move(list));
}

// Mean without the edges, in blocks, so that the rounding error does not grow with the length.
double offset_of(std::span<const double> x, const ConditioningChain& chain) {
  const std::size_t edge = std::min(static_cast<std::size_t>(chain.options.offset_edge_s * chain.rate_hz), x.size() / 4);
  const std::span<const double> inner = x.subspan(edge, x.size() - 2 * edge);
  double total = 0.0;
  for (std::size_t first = 0; first < inner.size(); first += 1024) {
    double block = 0.0;
    for (const double v : inner.subspan(first, std::min<std::size_t>(1024, inner.size() - first))) block += v;
    total += block;
  }
  return total / static_cast<double>(inner.size());
}

void apply(const DesignedFilter& filter, std::span<const std::span<double>> channels, const Preparation& preparation) {
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
      throw data::InputError("length-mismatch",
                             fmt::format("channels `{}` and `{}` of trial `{}` differ in length: {} and {} samples",
                                         names[0], names[c], trial, n, channels[c].size()));
    }
  }
  const OutputLayout layout = output_layout(chain, n, trial);
  check_samples(chain, channels, names, trial);
  if (steps && (steps->channel >= channels.size() || steps->first + steps->count > n)) {
    throw std::logic_error("condition: the window of steps lies outside the trial");
  }

  std::vector<double> offset(channels.size(), 0.0);
  if (chain.options.remove_offset) {
    for (std::size_t c = 0; c < channels.size(); ++c) offset[c] = offset_of(channels[c], chain);
  }
  if (steps) {
    steps->raw = window_of(*steps, channels);
    steps->offset_removed = steps->raw;
    for (double& x : steps->offset_removed) x -= offset[steps->channel];
  }
  run(chain.band, channels, {chain.options.remove_offset ? std::span<const double>(offset) : std::span<const double>{}, false});
  if (steps) {
    steps->filtered = window_of(*steps, channels);
    steps->rectified = steps->filtered;
    if (chain.options.rectify) {
      for (double& x : steps->rectified) x = std::abs(x);
    }
  }
  run(chain.envelope, channels, {{}, chain.options.rectify});
  if (steps) steps->envelope = window_of(*steps, channels);

  for (const std::span<double>& channel : channels) {
    std::copy(channel.begin() + static_cast<std::ptrdiff_t>(layout.first),
              channel.begin() + static_cast<std::ptrdiff_t>(layout.first + layout.kept), channel.begin());
    resample_in_place(channel.first(layout.kept), chain.rate_hz / chain.output_rate_hz, layout.count);
  }
  if (offsets) *offsets = std::move(offset);
  return layout;
}

}  // namespace brachium::emg
