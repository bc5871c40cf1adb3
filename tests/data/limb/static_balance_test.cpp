#include "data/limb/static_balance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "data/limb/chain.hpp"
#include "data/model/curve.hpp"
#include "data/model/error.hpp"

namespace {
using namespace brachium;

constexpr double degree = std::numbers::pi / 180.0;

TEST(StaticBalance, FindsAllRootsOfACosineWithTheirStability) {
  // M = cos(3 q) on [0, pi]: roots at 30, 90 and 150 deg; dM/dq = -3 sin(3 q).
  const limb::Balance b = limb::balance_of([](double q) { return std::cos(3.0 * q); }, 0.0, std::numbers::pi);
  ASSERT_EQ(b.equilibria.size(), 3u);
  const double wanted[] = {30.0, 90.0, 150.0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(b.equilibria[i].angle_rad / degree, wanted[i], 1e-7);
    EXPECT_EQ(b.equilibria[i].stable, i != 1);
    EXPECT_NEAR(b.equilibria[i].stiffness_N_m_per_rad, i == 1 ? 3.0 : -3.0, 1e-6);
  }
}

TEST(StaticBalance, FindsRootsBetweenScanPointsAndOnesThatOnlyTouch) {
  limb::BalanceOptions coarse;
  coarse.scan_points = 11;
  // Two roots 0.02 rad apart inside one step of 0.1 rad.
  const limb::Balance two =
      limb::balance_of([](double q) { return (q - 0.44) * (q - 0.46); }, 0.0, 1.0, coarse);
  ASSERT_EQ(two.equilibria.size(), 2u);
  EXPECT_NEAR(two.equilibria[0].angle_rad, 0.44, 1e-9);
  EXPECT_NEAR(two.equilibria[1].angle_rad, 0.46, 1e-9);
  const limb::Balance touching =
      limb::balance_of([](double q) { return (q - 0.45) * (q - 0.45); }, 0.0, 1.0, coarse);
  ASSERT_EQ(touching.equilibria.size(), 1u);
  EXPECT_NEAR(touching.equilibria[0].angle_rad, 0.45, 1e-4);
}

TEST(StaticBalance, NoneInRangeIsAResultWithTheNearestAngle) {
  const limb::Balance b = limb::balance_of([](double q) { return 0.5 + (q - 0.7) * (q - 0.7); }, 0.0, 2.0);
  EXPECT_TRUE(b.equilibria.empty());
  EXPECT_NEAR(b.nearest.angle_rad, 0.7, 1e-4);
  EXPECT_NEAR(b.nearest.residual_N_m, 0.5, 1e-7);
}

// The published elbow of the continuum model (extension positive there): lever arms [mm] over theta [deg]
// with the forces at 10 ... 150 deg, joined by a spline.
class PublishedElbow final : public limb::MuscleModel {
 public:
  const limb::ModelTraits& traits() const override { return traits_; }
  const std::vector<std::string>& coordinates() const override { return coordinates_; }
  const std::vector<std::string>& muscles() const override { return muscles_; }
  void evaluate(const Eigen::VectorXd& q, const Eigen::VectorXd&, const Eigen::VectorXd& a,
                const Eigen::VectorXd&, limb::Evaluation& out) const override {
    const double t = q(0) / degree;
    const double lt = (-0.0009399 * t * t + 0.1126 * t + 22.21) * 1e-3,
                 lb = (-0.001482 * t * t + 0.1776 * t + 35.02) * 1e-3;
    out.force.resize(2);
    out.force << at(t, triceps, triceps_full, a(0)), at(t, biceps, biceps_full, a(1));
    out.moment_arm.resize(1, 2);
    out.moment_arm << -lt, lb;
    out.moment = out.moment_arm * out.force;
  }

 private:
  using Samples = std::array<double, 7>;
  static double at(double t, const Samples& rest, const Samples& full, double a) {
    return (1.0 - a) * data::PiecewiseCubic::forsythe(angles, rest)(t).value +
           a * data::PiecewiseCubic::forsythe(angles, full)(t).value;
  }
  static constexpr Samples angles{10, 45, 60, 80, 90, 115, 150};
  static constexpr Samples triceps{24.5, 157.2, 242.8, 368.6, 424.8, 499.6, 452.7};
  static constexpr Samples triceps_full{337.9, 632.2, 773.0, 948.8, 1021.3, 1114.4, 1013.0};
  static constexpr Samples biceps{391.7, 242.2, 182.6, 124.9, 102.0, 50.0, 1.0};
  static constexpr Samples biceps_full{716.7, 600.0, 535.8, 428.2, 366.8, 202.5, 35.4};
  limb::ModelTraits traits_{"reference", 0, false, false, false, false};
  std::vector<std::string> coordinates_{"elbow"}, muscles_{"triceps", "biceps"};
};

TEST(StaticBalance, ReproducesThePublishedEquilibriaOfTheContinuumElbow) {
  const PublishedElbow elbow;
  const auto angle = [&](double triceps, double biceps, double load) {
    Eigen::VectorXd a(2), q = Eigen::VectorXd::Zero(1);
    a << triceps, biceps;
    const auto b = limb::static_balance(
        elbow, a, [load](const Eigen::VectorXd& x) { return -load * 0.2825 * std::sin(x(0)); }, q,
        10.0 * degree, 150.0 * degree);
    EXPECT_EQ(b.equilibria.size(), 1u);
    EXPECT_TRUE(b.equilibria.empty() || b.equilibria[0].stable);
    return b.equilibria.empty() ? 0.0 : b.equilibria[0].angle_rad / degree;
  };
  // Seven samples of the forces over 140 deg leave about a degree to the interpolant between them.
  EXPECT_NEAR(angle(0, 0, 0), 63.9, 1.0);
  EXPECT_NEAR(angle(0, 1, 0), 100.5, 1.0);
  EXPECT_NEAR(angle(1, 0, 0), 28.6, 1.0);
  EXPECT_NEAR(angle(1, 1, 0), 64.2, 1.0);
  EXPECT_NEAR(angle(0, 0, 22), 48.5, 1.0);
  EXPECT_NEAR(angle(0, 1, 22), 83.9, 1.0);
  EXPECT_NEAR(angle(1, 0, 22), 21.9, 1.0);
  EXPECT_NEAR(angle(1, 1, 22), 52.7, 1.0);
  Eigen::VectorXd a(2), q = Eigen::VectorXd::Zero(1);
  a << 1.0, 0.0;
  const auto none = limb::static_balance(
      elbow, a, [](const Eigen::VectorXd& x) { return -180.0 * 0.2825 * std::sin(x(0)); }, q, 10.0 * degree,
      150.0 * degree);
  EXPECT_TRUE(none.equilibria.empty()) << "the reference has none for 180 N at (1, 0)";
}

}  // namespace
