#include "pipelines/report/number.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace brachium::pipelines::report {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(ReportNumber, SignificantDigitsCountFromTheFirstThatIsNotZero) {
  EXPECT_EQ(significant(0.123456, 4), "0.1235");
  EXPECT_EQ(significant(1.5, 3), "1.50");
  EXPECT_EQ(significant(0.0615, 4), "0.06150");
  EXPECT_EQ(significant(123456.0, 3), "123456");
  EXPECT_EQ(significant(0.0, 4), "0");
}

TEST(ReportNumber, RoundingUpToTheNextPowerOfTenKeepsTheNumberOfDigits) {
  EXPECT_EQ(significant(9.9996, 4), "10.00");
  EXPECT_EQ(significant(0.99996, 4), "1.000");
  EXPECT_EQ(significant(9999999.6, 4), "1.000×10⁷");
}

TEST(ReportNumber, VeryLargeAndSmallNumbersArePowersOfTen) {
  EXPECT_EQ(significant(1.2e-7, 2), "1.2×10⁻⁷");
  EXPECT_EQ(significant(-3.456e12, 3), "−3.46×10¹²");
  EXPECT_EQ(significant(1e-4, 1), "0.0001");
}

TEST(ReportNumber, WhatIsNoNumberSaysSo) {
  EXPECT_EQ(significant(kNan, 3), "–");
  EXPECT_EQ(significant(-kInf, 3), "−∞");
  EXPECT_EQ(fixed(kInf, 2), "∞");
  EXPECT_EQ(duration(kNan), "–");
}

TEST(ReportNumber, NothingIsMinusZero) {
  EXPECT_EQ(fixed(-0.004, 2), "0.00");
  EXPECT_EQ(fixed(-0.006, 2), "−0.01");
  EXPECT_EQ(tenths(0), "0");
}

TEST(ReportNumber, QuantitiesJoinNumberAndUnit) {
  EXPECT_EQ(quantity(1.5, "N m", 3), "1.50\u202FN\u202Fm");
  EXPECT_EQ(quantity(0.25, "1", 2), "0.25");
  EXPECT_EQ(quantity(90.0, "deg", 2), "90°");
  EXPECT_EQ(percent(0.0421, 2), "4.2\u202F%");
}

TEST(ReportNumber, DurationsReadAsAPersonSaysThem) {
  EXPECT_EQ(duration(0.0), "0\u202Fms");
  EXPECT_EQ(duration(0.0421), "42\u202Fms");
  EXPECT_EQ(duration(0.8), "0.8\u202Fs");
  EXPECT_EQ(duration(14.8), "15\u202Fs");
  EXPECT_EQ(duration(59.7), "1\u202Fmin 0\u202Fs");
  EXPECT_EQ(duration(192.0), "3\u202Fmin 12\u202Fs");
  EXPECT_EQ(duration(7500.0), "2\u202Fh 05\u202Fmin");
}

TEST(ReportNumber, PixelsAreRoundedToATenthAndWrittenShort) {
  EXPECT_EQ(pixels(12.34), "12.3");
  EXPECT_EQ(pixels(-0.46), "-.5");
  EXPECT_EQ(pixels(7.0), "7");
  EXPECT_EQ(pixels(0.04), "0");
  EXPECT_EQ(pixels(-10.0), "-10");
}

}  // namespace
}  // namespace brachium::pipelines::report
