#pragma once
/// Power spectral density by Welch's method.

#include <span>
#include <vector>

namespace brachium::emg {

/// One-sided power spectral density [unit^2/Hz]; the frequency of bin k is k resolution_hz.
struct Periodogram {
  double resolution_hz = 0.0;
  std::vector<double> density;
};

/// Welch (1967, doi:10.1109/TAU.1967.1161901): Hann window (periodic), 50 % overlap, mean of each segment removed:
/// the defaults of scipy.signal.welch. Needs at least one segment of samples (InputError "trial-too-short").
Periodogram welch(std::span<const double> samples, double rate_hz, double segment_s);

/// Frequency that halves the power between two frequencies; linear within a bin.
double median_frequency(const Periodogram& periodogram, double low_hz, double high_hz);

}  // namespace brachium::emg
