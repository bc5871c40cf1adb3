#pragma once
/// Second-order sections and the loops that run them over many channels at once.
///
/// | symbol     | identifier     | unit | meaning                                       |
/// |------------|----------------|------|-----------------------------------------------|
/// | b0, b1, b2 | b0, b1, b2     | 1    | numerator of H(z)                             |
/// | a1, a2     | a1, a2         | 1    | denominator of H(z), a0 = 1                   |
/// | z1, z2     | state          | V    | state of the transposed direct form II        |
///
/// y = b0 x + z1,  z1 <- b1 x - a1 y + z2,  z2 <- b2 x - a2 y.
/// Channels lie side by side in vector lanes. Every lane does the same additions and multiplications in the same order
/// whatever the number of lanes, and no fused multiply-add is used: results are identical to the last bit for any
/// grouping of channels, any number of threads and any machine.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace brachium::emg {

struct Biquad {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0;
  double a1 = 0.0, a2 = 0.0;
};

/// State (z1, z2) of each section that has settled on the constant input 1: what scipy calls sosfilt_zi.
std::vector<std::array<double, 2>> steady_state(std::span<const Biquad> sections);

/// Filters channels in place. Applied to each sample before the first section, in this order:
struct Preparation {
  std::span<const double> subtract;  ///< one value per channel (its offset), or empty
  bool rectify = false;              ///< absolute value
};

/// Number of samples by which each end is extended before zero-lag filtering: 3 (m + 1), m the number of poles, which
/// is the default of scipy.signal.sosfiltfilt.
std::size_t padding(std::span<const Biquad> sections);

/// Forward, then backward, each from the steady state of its first sample, with odd extension at both ends: the
/// default of scipy.signal.sosfiltfilt. All channels have one length, which must exceed padding(sections).
void filter_zero_lag(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
                     const Preparation& preparation = {});

/// Forward, from the steady state of the first sample.
void filter_causal(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
                   const Preparation& preparation = {});

}  // namespace brachium::emg
