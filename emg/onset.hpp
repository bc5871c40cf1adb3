#pragma once
/// When does a muscle switch on and off?
///
/// threshold  Detector d = |x|, low-passed (Hodges & Bui 1996, doi:10.1016/S0921-884X(96)95190-5).
/// tkeo       Detector d = |ψ|, ψ_k = x_k^2 - x_(k-1) x_(k+1), the Teager-Kaiser operator, which is large where amplitude
///            and frequency are (Li, Zhou & Aruin 2007, doi:10.1007/s10439-007-9320-z), low-passed, h = 15
///            (Solnik et al. 2010, doi:10.1007/s00421-010-1521-8).
/// With the threshold T = mean + h SD of d at rest, a muscle switches on at the first sample where d and the mean of d
/// over the window that follows exceed T, and off at the first where both do not. (Asking for the window's mean alone
/// would date the onset of a strong burst too early by up to the window.) A second threshold in time: shorter bursts
/// and shorter gaps do not count; gaps are closed first.

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace brachium::emg {

enum class OnsetMethod { threshold, tkeo };
std::string to_string(OnsetMethod method);
OnsetMethod parse_onset_method(const std::string& name);  ///< throws InputError("unknown-onset-method")

struct OnsetOptions {
  OnsetMethod method = OnsetMethod::tkeo;
  double factor = 0.0;             ///< h; 0: 3 for threshold, 15 for tkeo
  double lowpass_hz = 50.0;        ///< smoothing of the detector signal, zero lag
  double window_s = 0.025;         ///< of the mean that must exceed the threshold (Hodges & Bui: 25 ms)
  double minimum_active_s = 0.05;  ///< shorter bursts are dropped
  double minimum_gap_s = 0.05;     ///< shorter gaps are closed
  double baseline_from_s =
      0.0;  ///< rest on the trial's clock; from == to: the quietest baseline_length_s is found
  double baseline_to_s = 0.0;
  double baseline_length_s = 0.5;
};

struct Burst {
  double onset_s = 0.0, offset_s = 0.0;           ///< on the trial's clock
  double mean_detector = 0.0;                     ///< mean of the detector signal over it / threshold
  bool cut_at_start = false, cut_at_end = false;  ///< active at the trial's first or last sample
};

struct OnsetResult {
  std::vector<Burst> bursts;
  double threshold = 0.0;  ///< in the detector's unit
  double baseline_mean = 0.0, baseline_sd = 0.0;
  double baseline_from_s = 0.0, baseline_to_s = 0.0;
};

/// samples: offset-free, band-passed EMG. Throws data::InputError: "out-of-range", "trial-too-short",
/// "not-finite", "constant-channel" when the baseline does not vary at all.
OnsetResult detect_onsets(std::span<const double> samples, double rate_hz, double start_time_s,
                          const std::string& channel, const OnsetOptions& options);

}  // namespace brachium::emg
