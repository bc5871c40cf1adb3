#pragma once
/// Is a recording worth using? Measures per channel and trial, thresholds, and a verdict with its reasons.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "emg/welch.hpp"

namespace brachium::emg {

/// Thresholds. A check is switched off by an infinite threshold (median_low_hz: 0).
/// Sources: SENIAM and ISEK recommendations ask for baseline noise, line interference and electrode movement to be
/// inspected but give no numbers for these; the numbers are ours, chosen so that the recordings listed in the README
/// pass and each disturbance of the synthetic EMG fails at a size that moves its envelope by more than about 10 %.
/// Median frequency of surface EMG: 50-150 Hz (De Luca 1997, doi:10.1123/jab.13.2.135), with a margin.
struct QualityOptions {
  double line_hz = 50.0;  ///< line frequency; 0 looks at both 50 and 60 Hz and takes the worse
  int line_harmonics = 5;
  double clipping_fraction = 1e-3;  ///< samples at the extremes, in runs of two or more
  double dropout_s = 0.02;  ///< a run of one repeated value (0 or other) of at least this length is a dropout
  double dropout_fraction = 5e-3;  ///< share of the trial in dropouts
  double line_ratio = 0.2;      ///< share of the power that stands above its surroundings at line frequencies
  double snr_db = 10.0;         ///< activity to rest
  double baseline_drift = 1.0;  ///< movement of the baseline / RMS of the EMG
  double median_low_hz = 30.0;  ///< plausible median frequency of surface EMG
  double median_high_hz = 200.0;
  double baseline_window_s = 0.5;  ///< of the moving mean that is the baseline
  double activity_window_s =
      0.25;              ///< of the moving RMS whose 5th and 95th percentiles are rest and activity
  double welch_s = 0.5;  ///< segment of the periodogram; 50 % overlap, Hann
};

struct ChannelQuality {
  std::string trial, channel;
  bool constant = false;  ///< every sample the same
  bool finite = true;     ///< no NaN, no Inf; where false nothing else is measured
  std::size_t not_finite_samples = 0;
  double clipped_fraction = 0.0;
  std::size_t dropouts = 0;
  double dropout_fraction = 0.0;
  double longest_dropout_s = 0.0;
  double line_ratio = 0.0;
  double line_hz = 0.0;  ///< which line frequency that was
  double snr_db = 0.0;
  double baseline_drift = 0.0;
  double median_hz = 0.0;
  double mean = 0.0;                 ///< offset [unit of the signal]
  double rms = 0.0;                  ///< about the baseline [unit of the signal]
  std::vector<std::string> reasons;  ///< why it is bad; empty: good
  bool good() const { return reasons.empty(); }
};

/// Throws data::InputError("out-of-range") for bad options, ("trial-too-short") below two Welch segments.
ChannelQuality assess(std::span<const double> samples, double rate_hz, const std::string& trial,
                      const std::string& channel, const QualityOptions& options);

/// One row per channel and trial.
data::Table quality_table(std::span<const ChannelQuality> rows);

}  // namespace brachium::emg
