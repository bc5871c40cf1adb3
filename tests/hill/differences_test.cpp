#include "hill/differences.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/curve.hpp"

namespace brachium::hill {
namespace {

TEST(Differences, CentralOnesAreExactForQuartics) {
  const double h = 0.1;
  std::vector<double> y, exact, out(9);
  for (int k = 0; k < 9; ++k) {
    const double t = h * k;
    y.push_back(1.0 - 2.0 * t + t * t * t - 0.7 * t * t * t * t);
    exact.push_back(-2.0 + 3.0 * t * t - 2.8 * t * t * t);
  }
  central_differences(y, h, out);
  for (int k = 0; k < 9; ++k) EXPECT_NEAR(out[k], exact[k], 1e-13) << k;
}

TEST(Differences, CentralOnesHaveNoPhaseLag) {
  // The derivative of a cosine is a sine: in phase with the true one at any frequency, only smaller.
  const double h = 0.005, w = 2.0 * M_PI * 20.0;
  std::vector<double> y, out(400);
  for (int k = 0; k < 400; ++k) y.push_back(std::cos(w * h * k));
  central_differences(y, h, out);
  const double gain = (8.0 * std::sin(w * h) - std::sin(2.0 * w * h)) / (6.0 * w * h);
  for (int k = 2; k < 398; ++k) EXPECT_NEAR(out[k], -gain * w * std::sin(w * h * k), 1e-9);
}

TEST(Differences, BackwardOnesAreExactForParabolas) {
  const BackwardDifference d{0.1};
  std::vector<double> y;
  for (int k = 0; k < 6; ++k) y.push_back(3.0 + 2.0 * 0.1 * k - 5.0 * 0.01 * k * k);
  for (int k = 2; k < 6; ++k)
    EXPECT_NEAR(d.alpha(k) * y[k] + d.beta(k, y.data()), 2.0 - 10.0 * 0.1 * k, 1e-12);
  EXPECT_NEAR(d.alpha(1) * y[1] + d.beta(1, y.data()), (y[1] - y[0]) / 0.1, 1e-12);
}

TEST(Differences, SplineSlopesAreThoseOfThePiecewiseCubic) {
  for (const std::size_t n : {4u, 5u, 50u}) {
    std::vector<double> x, y, out(n);
    for (std::size_t k = 0; k < n; ++k) {
      x.push_back(0.005 * static_cast<double>(k));
      y.push_back(std::sin(3.0 * static_cast<double>(k * k)));
    }
    SplineSlopes slopes;
    slopes.prepare(n, 0.005);
    slopes.apply(y, out);
    const auto spline = data::PiecewiseCubic::forsythe(x, y);
    for (std::size_t k = 0; k < n; ++k) EXPECT_NEAR(out[k], spline.knot_slopes()[k], 1e-10) << n << ' ' << k;
  }
}

}  // namespace
}  // namespace brachium::hill
