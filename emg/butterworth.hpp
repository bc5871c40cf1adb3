#pragma once
/// Butterworth and notch filters as cascades of second-order sections, designed so that the stated edges are the true
/// -3 dB edges, whatever the number of passes.
///
/// | symbol | identifier | unit | meaning                                                            |
/// |--------|------------|------|--------------------------------------------------------------------|
/// | n      | order      | 1    | order of the analogue low-pass prototype of one pass               |
/// | f      | low_hz ... | Hz   | edge                                                               |
/// | Ω      | -          | 1    | prewarped edge, Ω = tan(π f / rate)                                |
/// | C      | -          | 1    | edge correction for N passes, C = (2^(1/N) - 1)^(1/(2n))           |
///
/// Analogue prototype -> low-pass, high-pass or band-pass transform in Ω -> bilinear transform s = (z - 1)/(z + 1)
/// (Oppenheim & Schafer, Discrete-Time Signal Processing, ch. 7).
/// With N passes the gain at the design edge is 2^(-N/2), so that the -3 dB edge moves into the pass band.
/// `after_all_passes` designs for Ω/C (low-pass), Ω C (high-pass), bandwidth (Ω2 - Ω1)/C at fixed Ω1 Ω2 (band-pass),
/// bandwidth x C (notch); `per_pass` designs for the stated edges, which is what a user of scipy's sosfiltfilt or
/// MATLAB's filtfilt gets who passes the plain edges.

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "emg/biquad.hpp"

namespace brachium::emg {

enum class FilterKind { low_pass, high_pass, band_pass, notch };
enum class CutoffConvention { after_all_passes, per_pass };
enum class Phase {
  zero_lag,  ///< forward and backward over the whole signal: two passes, no delay
  causal     ///< one pass, as a real-time user would run it; delays the signal
};

std::string to_string(FilterKind kind);
std::string to_string(CutoffConvention convention);
std::string to_string(Phase phase);
FilterKind parse_filter_kind(const std::string& name);              ///< throws InputError("unknown-filter")
CutoffConvention parse_cutoff_convention(const std::string& name);  ///< throws InputError("unknown-cutoff")
Phase parse_phase(const std::string& name);                         ///< throws InputError("unknown-phase")

/// One filter as the user states it.
struct FilterSpec {
  FilterKind kind = FilterKind::low_pass;
  int order = 2;          ///< n, 1 to 10; a zero-lag filter has the effective order 2 n; unused by notch
  double low_hz = 0.0;    ///< lower edge: high_pass, band_pass
  double high_hz = 0.0;   ///< upper edge: low_pass, band_pass
  double line_hz = 50.0;  ///< notch: centre of the first notch
  int harmonics =
      1;  ///< notch: number of notches, at line_hz, 2 line_hz, ...; those at or above 98 % of Nyquist
          ///< are left out and said so
  double width_hz = 2.0;  ///< notch: distance of its -3 dB edges
  Phase phase = Phase::zero_lag;
  CutoffConvention cutoff = CutoffConvention::after_all_passes;

  int passes() const { return phase == Phase::zero_lag ? 2 : 1; }

  static FilterSpec low_pass(double edge_hz, int order = 2);
  static FilterSpec high_pass(double edge_hz, int order = 2);
  static FilterSpec band_pass(double low_hz, double high_hz, int order = 2);
  static FilterSpec notch(double line_hz, int harmonics, double width_hz = 2.0);
};

/// A designed filter: what one pass does, and how many passes there are.
struct DesignedFilter {
  FilterSpec spec;
  double rate_hz = 0.0;
  std::vector<Biquad> sections;     ///< of one pass
  std::vector<double> left_out_hz;  ///< notches too close to Nyquist

  /// Complex gain of one pass at a frequency, and |gain|^passes.
  std::complex<double> pass_response(double frequency_hz) const;
  double gain(double frequency_hz) const;
};

/// Throws data::InputError listing every mistake: "cutoff-above-nyquist", "out-of-range".
DesignedFilter design(const FilterSpec& spec, double rate_hz);

/// Gain of several filters in a row.
double gain(std::span<const DesignedFilter> cascade, double frequency_hz);

/// What is reported of a filter or a cascade.
struct FilterReport {
  std::string description;  ///< "low-pass Butterworth, effective order 4, zero lag, -3 dB at 6 Hz"
  int effective_order = 0;  ///< slope far outside the pass band [20 dB/decade], n x passes; notch: 2 x passes
  std::vector<double>
      edges_hz;  ///< every frequency where the gain crosses 1/sqrt(2) after all passes, ascending
  double group_delay_s = 0.0;  ///< causal: inside the pass band, at delay_at_hz; zero lag: 0
  double delay_at_hz = 0.0;    ///< low-pass and notch 0, band-pass the centre sqrt(low high), high-pass 2 low
  double transient_s =
      0.0;  ///< time after which what lies beyond an edge makes less than transient_level of the
            ///< output's RMS: the tail's share of the impulse response's energy is its square
};
inline constexpr double transient_level = 1e-3;

FilterReport describe(const DesignedFilter& filter);
/// Of filters that act one after the other: their common edges (they interact) and the sums of delays and transients.
FilterReport describe(std::span<const DesignedFilter> cascade);

}  // namespace brachium::emg
