#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "emg/conditioning.hpp"

namespace brachium::emg {
namespace {

constexpr std::size_t most_channels = 16;

// All channels of a trial must be sampled alike to be filtered side by side.
void check_alike(const data::TrialInfo& trial, std::span<const std::size_t> signals) {
  const data::SignalInfo& first = trial.signals.at(signals.front());
  std::vector<data::Diagnostic> list;
  for (const std::size_t s : signals) {
    const data::SignalInfo& info = trial.signals.at(s);
    if (info.rate_hz == first.rate_hz && info.count == first.count) continue;
    list.push_back(
        {data::Severity::error, "rate-mismatch",
         fmt::format("signals `{}` and `{}` of trial `{}` differ: {} samples at {} Hz, {} samples at {} Hz",
                     first.name, info.name, trial.name, first.count, first.rate_hz, info.count, info.rate_hz),
         std::nullopt, "condition them in two stages"});
  }
  if (!list.empty()) throw data::InputError(std::move(list));
}

}  // namespace

StreamResult condition_trial(const ConditioningOptions& options, const data::SessionSource& source,
                             std::size_t trial, std::span<const std::size_t> signals, data::SessionSink& sink,
                             std::size_t memory_budget_bytes) {
  StreamResult result;
  if (signals.empty()) return result;
  const data::TrialInfo& trial_info = source.info().trials.at(trial);
  check_alike(trial_info, signals);
  const data::SignalInfo& first = trial_info.signals.at(signals.front());
  result.chain = design_conditioning(options, first.rate_hz);
  result.layout = output_layout(result.chain, first.count, trial_info.name);

  const std::size_t affordable = memory_budget_bytes / std::max<std::size_t>(1, first.count * sizeof(double));
  const std::size_t group = std::clamp<std::size_t>(affordable, 1, most_channels);
  std::vector<std::vector<double>> memory(std::min(group, signals.size()));
  for (std::vector<double>& m : memory) m.resize(first.count);

  for (std::size_t begin = 0; begin < signals.size(); begin += group) {
    const std::size_t size = std::min(group, signals.size() - begin);
    std::vector<std::span<double>> channels;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < size; ++i) {
      source.read(trial, signals[begin + i], 0, memory[i]);
      channels.emplace_back(memory[i]);
      names.push_back(trial_info.signals[signals[begin + i]].name);
    }
    std::vector<double> offsets;
    condition(result.chain, channels, names, trial_info.name, nullptr, &offsets);
    for (std::size_t i = 0; i < size; ++i) {
      data::SignalInfo info = trial_info.signals[signals[begin + i]];
      info.rate_hz = result.chain.output_rate_hz;
      info.start_time_s += result.layout.start_shift_s;
      info.count = result.layout.count;
      for (auto& [key, value] : attributes(result.chain)) info.attributes[key] = value;
      info.attributes["emg.offset"] = fmt::format("{:.9g} {}", offsets[i], info.unit);
      result.offsets[info.name] = offsets[i];
      sink.begin_signal(trial_info.name, info);
      sink.write_samples(trial_info.name, info.name, 0, channels[i].first(result.layout.count));
    }
  }
  return result;
}

}  // namespace brachium::emg
