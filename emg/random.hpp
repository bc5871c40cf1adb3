#pragma once
/// Random numbers that are the same on every machine: no library generator, no library distribution, no libm.

#include <array>
#include <cstdint>

namespace brachium::emg {

/// xoshiro256++ (Blackman & Vigna 2021, doi:10.1145/3460772), its state filled by splitmix64.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0);

  std::uint64_t bits();
  double uniform();  ///< in (0, 1), multiples of 2^-53 shifted by half a step: never 0, never 1
  double normal();   ///< standard normal, by inversion

 private:
  std::array<std::uint64_t, 4> state_{};
};

/// Quantile of the standard normal distribution, p in (0, 1): Wichura 1988, algorithm AS 241 (PPND16),
/// doi:10.2307/2347330; relative accuracy about 1e-16. Uses only +, -, *, / and sqrt.
double normal_quantile(double p);

}  // namespace brachium::emg
