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
  double uniform();  ///< (k + 1/2) 2^-52, k < 2^52: never 0, never 1
  double normal();   ///< standard normal, by inversion

 private:
  std::array<std::uint64_t, 4> state_{};
};

/// Quantile of the standard normal distribution, p in (0, 1): Wichura 1988, algorithm AS 241 (PPND16),
/// doi:10.2307/2347330; relative accuracy about 1e-16. Uses only +, -, *, / and sqrt.
double normal_quantile(double p);

/// ln x, x > 0 normal, to about 1 ulp, by +, -, *, / alone.
double portable_log(double x);

}  // namespace brachium::emg
