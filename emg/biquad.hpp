#pragma once
/// Second-order sections and the loops that run them over many channels at once.
///
/// | symbol     | identifier     | unit | meaning                                       |
/// |------------|----------------|------|-----------------------------------------------|
/// | b0, b1, b2 | b0, b1, b2     | 1    | numerator of H(z)                             |
/// | a1, a2     | a1, a2         | 1    | denominator of H(z), a0 = 1                   |
/// | x, y       | x, y           | V    | input and output of a section                 |
///
/// y(k) = ((b0 x(k) + b1 x(k-1)) + (b2 x(k-2) - a2 y(k-2))) - a1 y(k-1)     (direct form I)
/// In this form one multiplication and one subtraction lie between y(k-1) and y(k), all else can be done
/// ahead; the outputs of a section are the inputs of the next, so that a cascade keeps two values a section
/// and two more. Channels lie side by side in vector lanes. Every lane does the same additions and
/// multiplications in the same order whatever the number of lanes, and no fused multiply-add is used: results
/// are identical to the last bit for any grouping of channels, any number of threads and any machine.

#include <cstddef>
#include <span>
#include <vector>

namespace brachium::emg {

struct Biquad {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0;
  double a1 = 0.0, a2 = 0.0;
};

/// Levels of a cascade that has settled on the constant input 1: its input and the output of each section. A
/// filter whose past inputs and outputs have these values is in the state that scipy calls sosfilt_zi.
std::vector<double> steady_levels(std::span<const Biquad> sections);

/// Channels that go through the loops together. A caller with several filters runs them all over this many
/// channels before it takes the next, so that samples are still near when the next filter reads them.
inline constexpr std::size_t channels_at_once = 8;

/// Filters channels in place. Applied to each sample before the first section, in this order:
struct Preparation {
  std::span<const double> subtract;  ///< one value per channel (its offset), or empty
  bool rectify = false;              ///< absolute value
};

/// Number of samples by which each end is extended before zero-lag filtering: 3 (m + 1), m the number of
/// poles, which is the default of scipy.signal.sosfiltfilt.
std::size_t padding(std::span<const Biquad> sections);

/// Forward, then backward, each from the steady state of its first sample, with odd extension at both ends:
/// the default of scipy.signal.sosfiltfilt. All channels have one length, which must exceed
/// padding(sections).
void filter_zero_lag(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
                     const Preparation& preparation = {});

/// Forward, from the steady state of the first sample.
void filter_causal(std::span<const Biquad> sections, std::span<const std::span<double>> channels,
                   const Preparation& preparation = {});

}  // namespace brachium::emg
