#include "pipelines/report/ticks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "pipelines/report/axis.hpp"

namespace brachium::pipelines::report {
namespace {

std::vector<std::string> labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> out;
  for (const Tick& tick : ticks) out.push_back(tick.label);
  return out;
}

/// 1, 2 or 5 times a power of ten.
bool is_nice(double step) {
  const double mantissa = step / std::pow(10.0, std::floor(std::log10(step) + 1e-9));
  return std::abs(mantissa - 1.0) < 1e-6 || std::abs(mantissa - 2.0) < 1e-6 ||
         std::abs(mantissa - 5.0) < 1e-6;
}

TEST(ReportTicks, AreThoseOneWouldWriteByHand) {
  EXPECT_EQ(labels(linear_ticks(0.0, 30.0, 6)),
            (std::vector<std::string>{"0", "5", "10", "15", "20", "25", "30"}));
  EXPECT_EQ(labels(linear_ticks(-0.31, 0.52, 4)), (std::vector<std::string>{"0", "0.5"}));
  EXPECT_EQ(labels(linear_ticks(-8.0, 16.0, 5)), (std::vector<std::string>{"−5", "0", "5", "10", "15"}));
  EXPECT_EQ(labels(linear_ticks(0.0, 3e-6, 3)),
            (std::vector<std::string>{"0", "1×10⁻⁶", "2×10⁻⁶", "3×10⁻⁶"}));
  EXPECT_EQ(labels(log_ticks(0.008, 250.0, 6)), (std::vector<std::string>{"0.01", "0.1", "1", "10", "100"}));
  EXPECT_EQ(labels(log_ticks(1.5, 30.0, 6)), (std::vector<std::string>{"2", "5", "10", "20"}));
}

TEST(ReportTicks, AreNiceNumbersWithinTheAxisWhateverItsRange) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0), position(-3.0, 3.0);
  for (int trial = 0; trial < 5000; ++trial) {
    const double span = std::pow(10.0, exponent(generator));
    const double lower = span * position(generator);
    const double upper = lower + span;
    const std::vector<Tick> ticks = linear_ticks(lower, upper, 5);
    ASSERT_GE(ticks.size(), 2u) << lower << ' ' << upper;
    ASSERT_LE(ticks.size(), 11u) << lower << ' ' << upper;
    std::set<std::string> distinct;
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      ASSERT_GE(ticks[i].value, lower - 1e-6 * span);
      ASSERT_LE(ticks[i].value, upper + 1e-6 * span);
      ASSERT_TRUE(distinct.insert(ticks[i].label).second)
          << ticks[i].label << " twice in " << lower << ' ' << upper;
      if (i > 0) {
        ASSERT_TRUE(is_nice(ticks[i].value - ticks[i - 1].value)) << ticks[i].value - ticks[i - 1].value;
      }
    }
  }
}

TEST(ReportTicks, LabelsSayTheValueTheyStandAt) {
  for (const Tick& tick : linear_ticks(-0.4, 0.7, 5)) {
    std::string text = tick.label;
    if (text.starts_with("−")) text.replace(0, std::string("−").size(), "-");
    EXPECT_NEAR(std::stod(text), tick.value, 1e-12);
  }
}

TEST(ReportTicks, LogarithmicAxesOverManyDecadesAreThinned) {
  const std::vector<Tick> ticks = log_ticks(1e-12, 1e12, 6);
  EXPECT_LE(ticks.size(), 8u);
  EXPECT_GE(ticks.size(), 4u);
}

TEST(ReportAxis, ConstantsEmptyDataAndForeignBoundsStillGiveARange) {
  Extent constant(false);
  constant.include(42.0);
  const Axis around = make_axis(constant, false, 0.05, {}, {});
  EXPECT_LT(around.lower, 42.0);
  EXPECT_GT(around.upper, 42.0);
  const Axis nothing = make_axis(Extent(false), false, 0.05, {}, {});
  EXPECT_EQ(nothing.lower, 0.0);
  EXPECT_EQ(nothing.upper, 1.0);
  const Axis beyond = make_axis(constant, false, 0.05, 100.0, {});
  EXPECT_EQ(beyond.lower, 100.0);
  EXPECT_GT(beyond.upper, 100.0);
  Extent zero(false);
  zero.include(0.0);
  const Axis about_zero = make_axis(zero, false, 0.05, {}, {});
  EXPECT_LT(about_zero.lower, about_zero.upper);
}

TEST(ReportAxis, WhatIsNowhereNegativeGetsNoNegativeRoom) {
  Extent extent(false);
  extent.include(0.0);
  extent.include(10.0);
  const Axis axis = make_axis(extent, false, 0.05, {}, {});
  EXPECT_EQ(axis.lower, 0.0);
  EXPECT_GT(axis.upper, 10.0);
}

TEST(ReportAxis, CountsWhatItCannotShowButNotGaps) {
  Extent extent(true);
  for (const double v : {1.0, 10.0, 0.0, -1.0, HUGE_VAL, std::nan("")}) extent.include(v);
  EXPECT_EQ(extent.left_out(), 3u);
  EXPECT_EQ(extent.lower(), 1.0);
  EXPECT_EQ(extent.upper(), 10.0);
  const Axis axis{.lower = 1.0, .upper = 100.0, .log = true};
  EXPECT_NEAR(axis.position(10.0), 0.5, 1e-15);
  EXPECT_TRUE(std::isnan(axis.position(0.0)));
}

}  // namespace
}  // namespace brachium::pipelines::report
