#pragma once
/// Raw EMG to linear envelope: offset, high- or band-pass, notch, full-wave rectification, envelope, output rate.
///
/// All channels of a group are worked on together, in place, so that a channel needs its own memory and nothing more.

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/model/session.hpp"
#include "emg/butterworth.hpp"

namespace brachium::emg {

struct ConditioningOptions {
  bool remove_offset = true;  ///< mean of the trial, edges excluded: an offset left in shifts the envelope
  double offset_edge_s =
      0.1;                    ///< left out of that mean at either end (less in a trial shorter than 4 x that)
  double highpass_hz = 30.0;  ///< lower edge; 0: none (CEINMS manual: 30 Hz; SENIAM: 10-20 Hz; ISEK: 5 Hz)
  double band_high_hz = 0.0;  ///< upper edge; 0: high-pass only (SENIAM, ISEK: 500 Hz)
  int band_order = 2;         ///< of one pass
  double notch_hz = 0.0;      ///< line frequency; 0: off
  int notch_harmonics = 5;    ///< number of notches
  double notch_width_hz = 2.0;
  bool rectify = true;      ///< full wave
  double lowpass_hz = 6.0;  ///< envelope; 0: none
  int lowpass_order = 2;    ///< of one pass
  Phase phase = Phase::zero_lag;
  CutoffConvention cutoff = CutoffConvention::after_all_passes;
  double output_rate_hz = 0.0;  ///< 0: the input's rate
  bool trim_edges = true;       ///< leave out the samples that the filters' transients reach (FilterReport)
};

/// The chain, designed for one sampling rate.
struct ConditioningChain {
  ConditioningOptions options;
  double rate_hz = 0.0;
  double output_rate_hz = 0.0;
  std::vector<DesignedFilter> band;      ///< before rectification, in order
  std::vector<DesignedFilter> envelope;  ///< after it
  std::vector<FilterReport> filters;     ///< one per filter, in order
  FilterReport band_report;              ///< of all filters before rectification together: their true edges
  FilterReport envelope_report;
  double group_delay_s = 0.0;          ///< causal: sum; zero lag: 0
  std::size_t edge_start_samples = 0;  ///< input samples at the start that transients reach
  std::size_t edge_end_samples = 0;    ///< ... at the end (causal: 0)
  double gain_at_output_nyquist =
      0.0;  ///< of the filters at half a lower output rate; at most max_alias_gain
};
inline constexpr double max_alias_gain = 0.01;

/// Throws data::InputError listing every mistake: "cutoff-above-nyquist", "out-of-range", "output-rate-too-low".
ConditioningChain design_conditioning(const ConditioningOptions& options, double rate_hz);

/// Samples that a trial of `count` input samples gives, and the time of the first of them after input sample 0.
struct OutputLayout {
  std::size_t first = 0;  ///< first kept input sample
  std::size_t kept = 0;   ///< number of kept input samples
  std::size_t count = 0;  ///< number of output samples
  double start_shift_s = 0.0;
};
/// Throws InputError("trial-too-short") stating how many samples the filters need.
OutputLayout output_layout(const ConditioningChain& chain, std::size_t count, const std::string& trial);

/// The steps of one channel within a window, for reports: samples [first, first + count) of the input's grid.
struct ConditioningSteps {
  std::size_t channel = 0, first = 0, count = 0;  ///< wanted
  std::vector<double> raw, offset_removed, filtered, rectified,
      envelope;  ///< filled; envelope at the input's rate
};

/// Conditions channels of equal length in place. On return the first layout.count samples of each hold the envelope
/// at the output rate. Names are used in messages. Throws InputError: "not-finite" naming channel and time of the
/// first bad sample of every bad channel, "trial-too-short".
OutputLayout condition(const ConditioningChain& chain, std::span<const std::span<double>> channels,
                       std::span<const std::string> names, const std::string& trial,
                       ConditioningSteps* steps = nullptr, std::vector<double>* offsets = nullptr);

/// Reads signals of one trial from a source, a group of channels at a time so that the group's samples stay within
/// memory_budget_bytes (at least one channel, at most 16), and writes envelopes under the same
/// names (quantity emg, unit as read: they become excitations by normalisation) with what was done as attributes. All signals must have one rate and one length
/// (InputError "rate-mismatch"). The trial must have been begun in the sink.
struct StreamResult {
  ConditioningChain chain;
  OutputLayout layout;
  std::map<std::string, double> offsets;  ///< by signal [unit of the signal]
};
StreamResult condition_trial(const ConditioningOptions& options, const data::SessionSource& source,
                             std::size_t trial, std::span<const std::size_t> signals, data::SessionSink& sink,
                             std::size_t memory_budget_bytes = std::size_t{128} << 20);

/// What was done, for a signal's attributes and the report.
std::map<std::string, std::string> attributes(const ConditioningChain& chain);

}  // namespace brachium::emg
