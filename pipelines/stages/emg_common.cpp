#include "pipelines/stages/emg_common.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "data/model/parallel.hpp"
#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {

std::vector<std::size_t> emg_channels(const data::TrialInfo& trial, const std::vector<std::string>& patterns,
                                      const std::vector<std::string>& excluded) {
  const std::vector<std::size_t> all = signals_of(trial, data::Quantity::emg);
  const std::vector<std::string> chosen =
      select(patterns, names_of(trial, all), fmt::format("EMG signal of trial `{}`", trial.name));
  std::vector<std::size_t> wanted;
  for (const std::size_t s : all) {
    const std::string& name = trial.signals[s].name;
    const bool in = std::find(chosen.begin(), chosen.end(), name) != chosen.end();
    const bool out = std::find(excluded.begin(), excluded.end(), name) != excluded.end();
    if (in && !out) wanted.push_back(s);
  }
  if (wanted.empty()) {
    throw data::InputError("missing-signal",
                           fmt::format("trial `{}` has no EMG channel to work on", trial.name),
                           all.empty() ? "no signal has the quantity `emg`: set it in the session description"
                                       : "all channels are excluded or left out by `channels`");
  }
  return wanted;
}

std::vector<std::string> excluded_channels(const StageData* quality) {
  std::vector<std::string> names;
  if (!quality) return names;
  const auto found = quality->attributes.find("excluded_channels");
  if (found == quality->attributes.end()) return names;
  std::istringstream list(found->second);
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

std::size_t threads_within_budget(std::size_t threads, const data::SessionInfo& session,
                                  const std::vector<std::string>& trials) {
  std::size_t longest = 1;
  for (const data::TrialInfo& trial : session.trials) {
    if (std::find(trials.begin(), trials.end(), trial.name) == trials.end()) continue;
    for (const std::size_t s : signals_of(trial, data::Quantity::emg))
      longest = std::max(longest, trial.signals[s].count * sizeof(double));
  }
  return std::clamp<std::size_t>(sample_budget_bytes / longest, 1, data::thread_count(threads));
}

std::vector<OptionSpec> conditioning_option_specs() {
  const emg::ConditioningOptions d;
  return {
      flag_option("remove_offset", d.remove_offset,
                  "take off the trial's mean first: an offset left in shifts the envelope"),
      number_option("highpass_hz", "Hz", d.highpass_hz, at_least(0),
                    "lower edge of the band; 0: none (CEINMS manual 30; SENIAM 10-20; ISEK 5)"),
      number_option("band_high_hz", "Hz", d.band_high_hz, at_least(0),
                    "upper edge of the band; 0: high-pass only (SENIAM, ISEK 500)"),
      integer_option("band_order", d.band_order, between(1, 10),
                     "order of one pass of the band or high-pass filter"),
      number_option("notch_hz", "Hz", d.notch_hz, at_least(0),
                    "line frequency to notch out with its harmonics; 0: off"),
      integer_option("notch_harmonics", d.notch_harmonics, between(1, 20), "number of notches"),
      number_option("notch_width_hz", "Hz", d.notch_width_hz, above(0), "distance of a notch's -3 dB edges"),
      choice_option("phase", "zero_lag", {"zero_lag", "causal"},
                    "zero_lag: forward and backward; causal: one pass, its delay reported"),
      choice_option("cutoff", "after_all_passes", {"after_all_passes", "per_pass"},
                    "whether stated edges are the true -3 dB edges, or those of one pass as scipy's and "
                    "MATLAB's filtfilt take them"),
  };
}

emg::ConditioningOptions conditioning_options(const Options& o) {
  emg::ConditioningOptions c;
  c.remove_offset = o.boolean("remove_offset");
  c.highpass_hz = o.number("highpass_hz");
  c.band_high_hz = o.number("band_high_hz");
  c.band_order = static_cast<int>(o.integer("band_order"));
  c.notch_hz = o.number("notch_hz");
  c.notch_harmonics = static_cast<int>(o.integer("notch_harmonics"));
  c.notch_width_hz = o.number("notch_width_hz");
  c.phase = emg::parse_phase(o.text("phase"));
  c.cutoff = emg::parse_cutoff_convention(o.text("cutoff"));
  return c;
}

void add_emg_stages(Catalogue& catalogue) {
  add_emg_quality(catalogue);
  add_emg_envelope(catalogue);
  add_emg_onset(catalogue);
  add_emg_activation(catalogue);
}

}  // namespace brachium::pipelines
