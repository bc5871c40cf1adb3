#pragma once
/// A band-limited signal at a lower rate.
///
/// | symbol | identifier | unit | meaning                                  |
/// |--------|------------|------|------------------------------------------|
/// | r      | ratio      | 1    | input samples per output sample, r >= 1  |
/// | β      | -          | 1    | shape of the Kaiser window               |

#include <cstddef>
#include <span>

namespace brachium::emg {

/// Output sample k is the signal at input position k ratio, written over the front of `samples`. Whole ratios pick
/// samples; others interpolate with a sinc of 48 neighbours under a Kaiser window (β = 12), which is exact to about
/// 1e-6 for content below 0.3 of the input's rate; beyond the ends the signal goes on by odd reflection.
/// The caller has made sure that the signal has nothing above half the output rate.
void resample_in_place(std::span<double> samples, double ratio, std::size_t output_count);

}  // namespace brachium::emg
