#include "optimise/excitation_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

TEST(EnvelopeNoise, CoefficientOfVariationEqualsMonteCarlo) {  // reference_envelope_cv.py, 33 min of noise
  EXPECT_NEAR(envelope_coefficient_of_variation(20.0, 450.0, 3.0), 0.0631, 0.02 * 0.0631);
  EXPECT_NEAR(envelope_coefficient_of_variation(20.0, 450.0, 6.0), 0.0886, 0.02 * 0.0886);
  EXPECT_NEAR(envelope_coefficient_of_variation(20.0, 450.0, 12.0), 0.1250, 0.02 * 0.1250);
}

TEST(EnvelopeNoise, HasUnitVarianceAndTheLowPassSpectrum) {
  const double rate = 200.0, cutoff = 6.0;
  const std::vector<double> x = envelope_noise(120000, rate, cutoff, 4, 0);
  double square = 0.0;
  for (double v : x) square += v * v / static_cast<double>(x.size());
  EXPECT_NEAR(square, 1.0, 0.05);
  // Autocorrelation at 1 / (4 f_c) against the integral of the filter's power.
  const std::size_t lag = 8;
  double lagged = 0.0, filter = 0.0, total = 0.0;
  for (std::size_t i = 0; i + lag < x.size(); ++i)
    lagged += x[i] * x[i + lag] / static_cast<double>(x.size() - lag);
  for (int b = 0; b < 20000; ++b) {
    const double f = (b + 0.5) * 0.005, s = f * std::pow(std::sqrt(2.0) - 1.0, 0.25) / cutoff;
    const double p = std::pow(1.0 + s * s * s * s, -2.0);
    total += p;
    filter += p * std::cos(2.0 * M_PI * f * static_cast<double>(lag) / rate);
  }
  EXPECT_NEAR(lagged, filter / total, 0.03);
}

TEST(EnvelopeNoise, IsNamedBySeedAndStream) {
  EXPECT_EQ(envelope_noise(100, 200.0, 6.0, 1, 2), envelope_noise(100, 200.0, 6.0, 1, 2));
  EXPECT_NE(envelope_noise(100, 200.0, 6.0, 1, 2), envelope_noise(100, 200.0, 6.0, 1, 3));
}

TEST(EnvelopeNoise, RefusesAnImpossibleBand) {
  try {
    envelope_coefficient_of_variation(450.0, 20.0, 6.0);
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message, "band 450 to 20 Hz with cut-off 6 Hz is not possible");
  }
}

}  // namespace
}  // namespace brachium::optimise
