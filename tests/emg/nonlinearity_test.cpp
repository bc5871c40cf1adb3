#include "emg/nonlinearity.hpp"

#include <functional>

#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::input_error;

TEST(Exponential, EqualsItsDefinition) {
  for (const double A : {-3.0, -1.5, -0.1, -1e-2}) {
    for (const double u : {0.0, 0.1, 0.5, 0.9, 1.0, 1.3}) {
      EXPECT_NEAR(ShapedNonlinearity(Nonlinearity::exponential, A)(u),
                  (std::exp(A * u) - 1.0) / (std::exp(A) - 1.0), 1e-13);
    }
  }
}

TEST(Exponential, PassesSmoothlyThroughTheRemovableSingularityAtZeroShape) {
  // a = u + A u (u - 1)/2 + A^2 u (u - 1)(2u - 1)/12 + O(A^3)
  for (const double A : {0.0, -1e-300, -1e-16, -1e-12, -1e-8, -1e-5, -1e-4}) {
    for (const double u : {0.2, 0.7, 1.0}) {
      const NonlinearityValue a = ShapedNonlinearity(Nonlinearity::exponential, A).with_derivatives(u);
      const double second = u * (u - 1.0) * (2.0 * u - 1.0) / 12.0;
      EXPECT_NEAR(a.value, u + A * u * (u - 1.0) / 2.0 + A * A * second, 1e-12);
      EXPECT_NEAR(a.dshape, u * (u - 1.0) / 2.0 + 2.0 * A * second, 2e-9);
      EXPECT_NEAR(a.slope, 1.0 + A * (u - 0.5), 2e-9);
    }
  }
}

TEST(Exponential, HasNoStepWhereTheEvaluationSwitches) {
  for (const double u : {0.3, 0.8}) {
    const double below = ShapedNonlinearity(Nonlinearity::exponential, -1e-3 * (1 + 1e-12))(u);
    const double above = ShapedNonlinearity(Nonlinearity::exponential, -1e-3 * (1 - 1e-12))(u);
    EXPECT_NEAR(below, above, 1e-14);
  }
}

// Manal & Buchanan: the two pieces meet in value and slope at the node, and a(0) = 0, a(1) = 1.
TEST(Piecewise, MeetsItsConditionsForEveryShape) {
  for (const double A : {1e-10, 1e-4, 0.01, 0.06, 0.12}) {
    const ShapedNonlinearity f(Nonlinearity::piecewise, A);
    const double u0 = 0.3085 - A / std::sqrt(2.0), a0 = 0.3085 + A / std::sqrt(2.0);
    EXPECT_EQ(f(0.0), 0.0);
    EXPECT_NEAR(f(1.0), 1.0, 1e-15);
    EXPECT_NEAR(f(u0), a0, 1e-13);
    EXPECT_NEAR(f(u0 * (1 - 1e-12)), a0, 1e-11);
    EXPECT_NEAR(f.with_derivatives(u0 * (1 - 1e-12)).slope, f.with_derivatives(u0).slope, 1e-9);
  }
}

TEST(Piecewise, IsALogarithmBelowTheNode) {
  // α and β from two points, then a third point must lie on α ln(β u + 1).
  const ShapedNonlinearity f(Nonlinearity::piecewise, 0.1);
  double low = 1e-3, high = 1e3;
  for (int i = 0; i < 200; ++i) {
    const double beta = std::sqrt(low * high);
    (std::log1p(0.2 * beta) / std::log1p(0.1 * beta) > f(0.2) / f(0.1) ? low : high) = beta;
  }
  const double alpha = f(0.1) / std::log1p(0.1 * low);
  EXPECT_NEAR(f(0.05), alpha * std::log1p(0.05 * low), 1e-12);
  EXPECT_NEAR(f(0.15), alpha * std::log1p(0.15 * low), 1e-12);
}

TEST(Piecewise, TendsToTheStraightLineAsTheShapeTendsToZero) {
  for (const double u : {0.1, 0.3, 0.5}) {
    EXPECT_EQ(ShapedNonlinearity(Nonlinearity::piecewise, 0.0)(u), u);
    EXPECT_NEAR(ShapedNonlinearity(Nonlinearity::piecewise, 1e-12)(u), u, 1e-11);
  }
}

double worst_derivative_error(Nonlinearity kind, double A, double u, double wrong = 1.0) {
  const NonlinearityValue a = ShapedNonlinearity(kind, A).with_derivatives(u);
  const double h = 1e-5;
  const ShapedNonlinearity f(kind, A);
  const double slope = (f(u + h) - f(u - h)) / (2 * h);
  const double dshape = (ShapedNonlinearity(kind, A + h)(u) - ShapedNonlinearity(kind, A - h)(u)) / (2 * h);
  return std::max(std::abs(a.slope * wrong - slope), std::abs(a.dshape * wrong - dshape));
}

TEST(Nonlinearity, DerivativesEqualFiniteDifferencesAndAWrongTwinIsCaught) {
  for (const double u : {-0.01, 0.05, 0.15, 0.29, 0.6, 1.0, 1.2}) {
    for (const double A : {-2.9, -1.5, -0.6, -0.4, -0.01, -2e-5}) {
      EXPECT_LT(worst_derivative_error(Nonlinearity::exponential, A, u), 2e-9) << A << " " << u;
    }
    for (const double A : {2e-5, 0.001, 0.01, 0.06, 0.119}) {
      EXPECT_LT(worst_derivative_error(Nonlinearity::piecewise, A, u), 2e-8) << A << " " << u;
    }
  }
  EXPECT_GT(worst_derivative_error(Nonlinearity::exponential, -1.5, 0.5, 1.001), 1e-4);
  EXPECT_GT(worst_derivative_error(Nonlinearity::piecewise, 0.06, 0.15, 1.001), 1e-4);
}

TEST(Nonlinearity, NegativeActivationIsContinuedNotClamped) {
  EXPECT_LT(ShapedNonlinearity(Nonlinearity::piecewise, 0.1)(-0.01), 0.0);
  EXPECT_LT(ShapedNonlinearity(Nonlinearity::exponential, -1.5)(-0.01), 0.0);
  EXPECT_GT(ShapedNonlinearity(Nonlinearity::exponential, -1.5)(1.2), 1.0);
}

TEST(Nonlinearity, ShapesOutsideTheRangeAreRefused) {
  EXPECT_EQ(input_error([] { ShapedNonlinearity(Nonlinearity::exponential, 0.1); }),
            "out-of-range: `shape` = 0.1 is outside [-3, 0], the range of the exponential nonlinearity");
  EXPECT_EQ(input_error([] { ShapedNonlinearity(Nonlinearity::piecewise, std::nan("")); }),
            "out-of-range: `shape` = nan is outside [0, 0.12], the range of the piecewise nonlinearity");
  EXPECT_EQ(input_error([] { (void)parse_nonlinearity("exponental"); }),
            "unknown-nonlinearity: `exponental` is not an activation nonlinearity");
}

}  // namespace
}  // namespace brachium::emg
