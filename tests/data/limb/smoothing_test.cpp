#include "data/limb/smoothing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "data/model/error.hpp"

namespace {
using namespace brachium;

constexpr double pi = std::numbers::pi;

TEST(Smoothing, EqualsScipysZeroLagFilter) {
  std::vector<double> x(1000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i) / 200.0;
    x[i] = std::sin(2 * pi * t) + 0.3 * std::cos(2 * pi * 7 * t) + t * t;
  }
  const std::vector<double> y = limb::smooth(x, {3.0, 200.0}, "x");
  // inverse_dynamics_reference.py, scipy 1.10
  EXPECT_NEAR(y[0], 0.3000000658432631, 1e-11);
  EXPECT_NEAR(y[1], 0.30198174659970317, 1e-11);
  EXPECT_NEAR(y[137], -0.4376436260686933, 1e-11);
  EXPECT_NEAR(y[500], 6.227680726984098, 1e-11);
  EXPECT_NEAR(y[999], 25.21138802069532, 1e-11);
}

TEST(Smoothing, GainOfBothPassesAtTheCutoffIsHalfPowerAndThereIsNoLag) {
  for (const double cutoff : {1.0, 6.0, 20.0}) {
    std::vector<double> x(20000);
    for (std::size_t i = 0; i < x.size(); ++i)
      x[i] = std::sin(2 * pi * cutoff * static_cast<double>(i) / 200.0);
    const std::vector<double> y = limb::smooth(x, {cutoff, 200.0}, "x");
    for (std::size_t i = 9900; i < 10100; ++i) EXPECT_NEAR(y[i], x[i] / std::numbers::sqrt2, 1e-10);
  }
}

TEST(Smoothing, DerivativeIsOfFourthOrderUpToTheEnds) {
  const auto worst = [](std::size_t n) {
    const double rate = static_cast<double>(n - 1);
    std::vector<double> x(n);
    for (std::size_t i = 0; i < n; ++i) x[i] = std::sin(3.0 * static_cast<double>(i) / rate);
    const std::vector<double> d = limb::derivative(x, rate);
    double error = 0.0;
    for (std::size_t i = 0; i < n; ++i)
      error = std::max(error, std::abs(d[i] - 3.0 * std::cos(3.0 * static_cast<double>(i) / rate)));
    return error;
  };
  EXPECT_NEAR(std::log2(worst(101) / worst(201)), 4.0, 0.1);
}

std::string message_of(const std::vector<double>& x, limb::Smoothing s) {
  try {
    limb::smooth(x, s, "the elbow angle");
  } catch (const data::InputError& e) {
    return e.diagnostics().front().code + ": " + e.what();
  }
  return "nothing was thrown";
}

TEST(Smoothing, RefusesWhatItCannotSmooth) {
  std::vector<double> x(200, 1.0);
  EXPECT_EQ(message_of(x, {120.0, 200.0}),
            "cutoff-above-nyquist: the cut-off 120 Hz for the elbow angle must lie above 0 and below 0.45 of "
            "its rate 200 Hz");
  EXPECT_EQ(message_of(x, {1.0, 200.0}),
            "trial-too-short: the elbow angle has 200 samples; smoothing at 1 Hz needs more than 400");
  x[50] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(message_of(x, {10.0, 200.0}),
            "not-finite: the elbow angle is not a finite number at sample 50 (0.25 s)");
}

}  // namespace
