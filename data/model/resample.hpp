#pragma once
/// Signals of different rates brought onto common time stamps, each from its own.
///
/// | symbol | identifier     | unit | meaning                                                    |
/// |--------|----------------|------|------------------------------------------------------------|
/// | f_p    | passband_hz    | Hz   | up to here the gain is 1 within the ripple                 |
/// | f_s    | stopband_hz    | Hz   | from here on the gain is below the attenuation             |
/// | A      | attenuation_db | dB   | stopband attenuation; also the passband ripple, 10^(-A/20) |
/// | beta   | beta           | 1    | shape of the Kaiser window                                 |
/// | h      | half_width_s   | s    | half the kernel's length                                   |

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "data/model/signal.hpp"

namespace brachium::data {

/// Band-limited interpolation: a sinc low-pass under a Kaiser window, evaluated at each output's own time.
struct ResampleOptions {
  double passband = 0.9;          ///< f_p as a fraction of half the lower of the two rates, in (0, 1)
  double attenuation_db = 100.0;  ///< A, 30 to 160
};

/// The filter that ResampleOptions mean for two rates
/// (Kaiser & Schafer 1980, doi:10.1109/TASSP.1980.1163349; Oppenheim & Schafer, Discrete-Time Signal
/// Processing, 7.5).
struct ResampleFilter {
  double passband_hz = 0.0;
  double stopband_hz = 0.0;  ///< half the lower rate
  double attenuation_db = 0.0;
  double beta = 0.0;
  double half_width_s = 0.0;
};
ResampleFilter design_resampling(double from_hz, double to_hz, const ResampleOptions& options = {});

/// Time stamps start_s + i / rate_hz, i = 0 ... count - 1.
struct TimeGrid {
  double rate_hz = 0.0;
  double start_s = 0.0;
  std::size_t count = 0;
  double time_s(std::size_t i) const { return start_s + static_cast<double>(i) / rate_hz; }
};

/// The signal on `grid`, which must lie within the signal's own time span (to 1e-6 of a sample period).
/// Beyond its ends the signal is continued by point reflection, so that the first and last half_width_s lean
/// on that assumption; the attribute "resampled" says so, with rates, filter and edges. A grid that coincides
/// with the signal's own samples copies them and adds no attribute. Throws InputError: "outside-signal",
/// "bad-rate", "too-short" (fewer than 2 samples), "bad-option".
Signal resample(const Signal& signal, const TimeGrid& grid, const ResampleOptions& options = {});

/// The longest grid of `rate_hz` within the time spans of all signals, starting at the latest start.
/// Throws InputError("no-common-window") naming the two signals that do not overlap.
TimeGrid common_grid(std::span<const SignalInfo> signals, double rate_hz);

/// All signals on their common grid.
std::vector<Signal> align(std::span<const Signal> signals, double rate_hz,
                          const ResampleOptions& options = {});

enum class Interpolation {
  linear,
  cubic  ///< four-point Lagrange, third order; for signals that are smooth at their rate (angles), no
         ///< anti-aliasing
};
/// Values at arbitrary times within the signal's span. Throws InputError("outside-signal" | "too-short").
std::vector<double> evaluate_at(const Signal& signal, std::span<const double> times_s,
                                Interpolation interpolation = Interpolation::cubic);

}  // namespace brachium::data
