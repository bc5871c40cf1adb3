#pragma once
/// What an electrode shows when the muscle is at rest, and how it is taken off an envelope.
///
/// | symbol | identifier | unit | meaning                                           |
/// |--------|------------|------|---------------------------------------------------|
/// | e      | envelope   | V    | linear envelope of EMG and noise together         |
/// | r      | rest       | V    | mean of the envelope at rest                      |
///
/// EMG and sensor noise are independent, so their variances add, and a linear envelope is proportional to the standard
/// deviation of what it envelops: e^2 = s^2 + r^2, hence s = sqrt(e^2 - r^2). At 20 dB an excitation of 0 otherwise reads as
/// 0.1. Where a fluctuation brings e below r, s is 0, and such samples are counted.

#include <cstddef>
#include <span>

namespace brachium::emg {

/// Takes `rest` off in place; returns the number of samples at or below it, which become 0.
/// Throws data::InputError("out-of-range") for a rest that is not finite or below 0.
std::size_t remove_rest(std::span<double> envelope, double rest);

}  // namespace brachium::emg
