#pragma once
/// What the EMG stages share: which channels they work on, and the options of the conditioning chain.

#include <string>
#include <vector>

#include "emg/conditioning.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// Indices of a trial's EMG signals that match the patterns (all of quantity emg where there are none), without the
/// excluded ones. Throws InputError("missing-signal") if none is left.
std::vector<std::size_t> emg_channels(const data::TrialInfo& trial, const std::vector<std::string>& patterns,
                                      const std::vector<std::string>& excluded);

/// Channels that an emg.quality output excludes.
std::vector<std::string> excluded_channels(const StageData* quality);

/// Bytes of samples that a stage may hold at any time, all threads together: two channels of an hour at 2 kHz.
inline constexpr std::size_t sample_budget_bytes = std::size_t{128} << 20;

/// As many of the threads as may each hold a channel of the named trials whole within that budget; at least one.
std::size_t threads_within_budget(std::size_t threads, const data::SessionInfo& session,
                                  const std::vector<std::string>& trials);

std::vector<OptionSpec> conditioning_option_specs();
emg::ConditioningOptions conditioning_options(const Options& options);

void add_emg_quality(Catalogue& catalogue);
void add_emg_envelope(Catalogue& catalogue);
void add_emg_onset(Catalogue& catalogue);
void add_emg_activation(Catalogue& catalogue);

}  // namespace brachium::pipelines
