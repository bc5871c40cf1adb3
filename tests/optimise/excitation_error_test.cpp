#include "optimise/excitation_error.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"
#include "stochastic_twin.hpp"

namespace brachium::optimise {
namespace {

struct Moments {
  double mean = 0.0, deviation = 0.0;
};

Moments moments(const std::vector<double>& x) {
  Moments m;
  for (double v : x) m.mean += v / static_cast<double>(x.size());
  for (double v : x) m.deviation += (v - m.mean) * (v - m.mean) / static_cast<double>(x.size());
  m.deviation = std::sqrt(m.deviation);
  return m;
}

/// Five minutes of constant effort at 20 dB: envelopes of synthesised EMG with the level of rest taken off.
std::vector<double> synthesised(double effort, const emg::SyntheticEmgOptions& electrode) {
  data::Trial trial;
  trial.name = "hold";
  data::Signal s;
  s.info.quantity = data::Quantity::excitation;
  s.info.rate_hz = 200.0;
  s.samples.assign(60000, effort);
  trial.signals = {s};
  return tests::stochastic_envelopes(trial, electrode, 5, 77, 100.0)[0].samples;
}

TEST(EnvelopeNoise, IsThatOfSynthesisedEmgFromLittleToFullEffort) {
  emg::SyntheticEmgOptions electrode;
  electrode.snr_db = 20.0;
  const ExcitationNoise law = tests::stochastic_noise(electrode);
  ExcitationNoise quiet = law;  // as if the sensor's noise did not vary at rest
  quiet.rest_coefficient_of_variation = 0.0;
  for (double effort : {0.05, 0.1, 0.3, 1.0}) {
    const Moments emg = moments(synthesised(effort, electrode));
    const std::vector<double> constant(30000, effort);
    const Moments drawn = moments(with_envelope_noise(constant, 100.0, law, 3));
    EXPECT_NEAR(drawn.deviation, emg.deviation, 0.06 * emg.deviation) << effort;
    EXPECT_NEAR(drawn.mean, emg.mean, 0.04 * emg.deviation) << effort;
    if (effort > 0.07) continue;
    EXPECT_LT(moments(with_envelope_noise(constant, 100.0, quiet, 3)).deviation, 0.8 * emg.deviation);
  }
}

// What corrected scores rest on: one more dose shifts the mean by as much as the first did.
TEST(EnvelopeNoise, ASecondDoseShiftsTheMeanAsTheFirstDid) {
  ExcitationNoise law;
  law.coefficient_of_variation = 0.13;
  law.subtracted_floor = 0.1;
  law.overlapping_floor = 0.04;
  law.rest_coefficient_of_variation = 0.06;
  const double effort = 0.12;
  const auto mean_of_pair = [&](const std::vector<double>& x, const ExcitationNoise& noise, std::uint64_t k) {
    return 0.5 * (moments(with_envelope_noise(x, 100.0, noise, k)).mean +
                  moments(with_envelope_noise(x, 100.0, noise, k, -1.0)).mean);
  };
  const std::vector<double> constant(60000, effort), once = with_envelope_noise(constant, 100.0, law, 1);
  const double first = mean_of_pair(constant, law, 1) - effort,
               second = mean_of_pair(once, law, 2) - moments(once).mean;
  EXPECT_LT(first, -3e-4);
  EXPECT_NEAR(second, first, 0.2 * std::abs(first));
  ExcitationNoise afterwards = law;  // a dose that comes after the floor has been taken off
  afterwards.subtracted_floor = 0.0;
  EXPECT_LT(std::abs(mean_of_pair(once, afterwards, 2) - moments(once).mean), 0.2 * std::abs(first));
}

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
