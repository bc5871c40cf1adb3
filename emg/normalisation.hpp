#pragma once
/// What an envelope of 1 means: division by the envelope of a maximum voluntary contraction (MVC), by the largest
/// value of a given list of trials, or by nothing (the gain is fitted in the calibration).
///
/// The maximum is that of a moving-window mean, not of one sample: the envelope of a perfectly constant contraction
/// still varies by some 10 %, so that its largest sample overestimates it (expected_bias).

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::emg {

enum class Normalisation {
  mvc,             ///< maximum over all named MVC trials
  trials_maximum,  ///< maximum over all given trials, with a warning: not comparable between days or people
  none             ///< reference 1: the gain is fitted in the calibration
};
std::string to_string(Normalisation normalisation);
Normalisation parse_normalisation(const std::string& name);  ///< throws InputError("unknown-normalisation")

struct NormalisationOptions {
  Normalisation method = Normalisation::mvc;
  double window_s = 0.5;        ///< of the moving mean; 0: the single largest sample
  double lowpass_hz = 6.0;      ///< edge of the envelope filter, for expected_bias only
  double plateau_s = 3.0;       ///< duration of an MVC's plateau, for expected_bias only
  double bandwidth_hz = 190.0;  ///< statistical bandwidth of the raw EMG, for expected_bias only
};

/// One trial's envelope of one channel.
struct EnvelopeView {
  std::string trial;
  std::span<const double> samples;
  double rate_hz = 0.0;
  double start_time_s = 0.0;
};

struct NormalisationReference {
  std::string channel;
  Normalisation method = Normalisation::mvc;
  double value = 1.0;   ///< [unit of the envelope] divides the envelope
  std::string trial;    ///< where it was found
  double time_s = 0.0;  ///< centre of the window on the trial's clock
  double window_s = 0.0;
  std::size_t trials = 0;      ///< number of trials searched
  double expected_bias = 0.0;  ///< by which `value` is expected to exceed the plateau's true mean, e.g. 0.065
  std::vector<data::Diagnostic> diagnostics;  ///< warnings
};

/// Largest moving-window mean. Throws InputError: "mvc-absent" when no trial is given to `mvc` or `trials_maximum`,
/// "trial-too-short" for a trial shorter than the window, "constant-channel" when the maximum is not above 0.
NormalisationReference find_reference(const std::string& channel, std::span<const EnvelopeView> envelopes,
                                      const NormalisationOptions& options);

/// The same one trial at a time, for sessions larger than memory: take trial after trial, then finish.
class ReferenceSearch {
 public:
  ReferenceSearch(std::string channel, NormalisationOptions options);
  void take(const EnvelopeView& envelope);
  NormalisationReference finish() const;

 private:
  NormalisationOptions options_;
  NormalisationReference best_;
};

struct WindowMaximum {
  double value = 0.0;
  std::size_t first = 0;  ///< first sample of the window
  std::size_t width = 0;  ///< samples in it
};
WindowMaximum moving_window_maximum(std::span<const double> samples, double rate_hz, double window_s);

/// What chance does to the envelope of a perfectly constant contraction, whose raw EMG is Gaussian noise.
///   W   bandwidth_hz  [Hz]  statistical bandwidth (∫P df)^2/∫P^2 df of the raw EMG: 420 for white noise of 30-450 Hz,
///                           about 190 for the spectrum of synthetic_emg.hpp
///   f_c lowpass_hz    [Hz]  -3 dB edge of the zero-lag envelope filter, effective order 4
///   T   window_s      [s]   moving mean
/// Variation: CV^2 = 1.05 B/(2 W), B = ∫ |G|^2 sinc^2(f T) df the noise bandwidth of filter and window (the rectified
/// Gaussian's covariance is ρ^2 (1 + ρ^2/12 + ...)/π; 1.05 stands for the series).
double envelope_variation(double window_s, double lowpass_hz, double bandwidth_hz);
/// Relative excess of the largest window mean over the true mean: CV (c + 0.5772/c), c = sqrt(2 ln N), N the expected
/// number of up-crossings of the mean in all plateaus (Davenport 1964, doi:10.1680/iicep.1964.10112).
double expected_bias(double window_s, double lowpass_hz, double plateau_s, std::size_t trials,
                     double bandwidth_hz);

/// Excitation above 1 is information (a poor MVC): counted and time-stamped, never clamped.
struct Excess {
  std::size_t samples = 0;  ///< above 1
  double maximum = 0.0;
  double maximum_time_s = 0.0;
  struct Interval {
    double from_s = 0.0, to_s = 0.0, maximum = 0.0;
  };
  std::vector<Interval> intervals;  ///< runs above 1, in order of time
};

/// Divides in place and reports what exceeds 1.
Excess normalise(std::span<double> envelope, double reference, double rate_hz, double start_time_s);

}  // namespace brachium::emg
