// Where load histories take a limb.

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "optimise/scenario.hpp"
#include "snapping_system.hpp"
#include "upper_limb_forces.hpp"

namespace brachium::optimise::test {
namespace {

TEST(Follow, KeepsToTheBranchAndReturns) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  const int n = 201;
  std::vector<double> time;
  Eigen::VectorXd load(n);
  for (int i = 0; i < n; ++i) time.push_back(0.01 * i), load(i) = 20.0 * std::sin(0.0314159265358979 * i);
  const Eigen::MatrixXd a = Eigen::Vector2d(0.4, 0.5).replicate(1, n);
  const AngleHistory history = follow(s, time, a, load, 80.0 * deg);
  EXPECT_TRUE(history.events.empty());
  int evaluations = 0;
  for (int i = 0; i < n; ++i) {
    const Frame& f = history.frames[static_cast<std::size_t>(i)];
    EXPECT_EQ(f.kind, FrameKind::followed);
    EXPECT_NEAR(f.angle_rad, equilibria(s, a.col(i), load(i)).all.at(0).angle_rad, 2e-5);
    const auto back = load_for_angle(s, f.angle_rad, a.col(i));
    ASSERT_TRUE(back);
    EXPECT_NEAR(*back, load(i), 1e-3);
    evaluations += f.iterations;
  }
  EXPECT_LE(evaluations, 7 * n);
}

TEST(Follow, NamesTheJumpWhereABranchEnds) {
  const Idle idle;
  const StaticSystem s = snapping(idle);
  const int n = 401;
  std::vector<double> time;
  Eigen::VectorXd load(n);
  for (int i = 0; i < n; ++i) time.push_back(0.01 * i), load(i) = i <= 200 ? 0.03 * i : 0.03 * (400 - i);
  const AngleHistory history = follow(s, time, Eigen::MatrixXd::Zero(1, n), load, -1.0);
  const auto jumped = std::find_if(history.frames.begin(), history.frames.end(),
                                   [](const Frame& f) { return f.kind == FrameKind::jumped; });
  ASSERT_NE(jumped, history.frames.end());
  ASSERT_FALSE(history.events.empty());
  EXPECT_NE(history.events.front().find("jump from"), std::string::npos);
  const auto i = jumped - history.frames.begin();
  // Before the jump dM/dq has nearly vanished; the load is that of the fold, to one step.
  const Frame& last = history.frames[static_cast<std::size_t>(i - 1)];
  const double q = last.angle_rad;
  const double nearest_fold =
      (std::acos(1.0 / 12.0) -
       2.0 * std::numbers::pi * std::round((std::acos(1.0 / 12.0) - 3.0 * q) / (2.0 * std::numbers::pi))) /
      3.0;
  const double other_fold =
      (-std::acos(1.0 / 12.0) -
       2.0 * std::numbers::pi * std::round((-std::acos(1.0 / 12.0) - 3.0 * q) / (2.0 * std::numbers::pi))) /
      3.0;
  const double at = std::abs(q - nearest_fold) < std::abs(q - other_fold) ? nearest_fold : other_fold;
  const double L = at - 4.0 * std::sin(3.0 * at);
  EXPECT_LE(std::abs(load(i - 1)), std::abs(L));
  EXPECT_GE(load(i), L - 1e-12);
  EXPECT_LE(load(i) - L, 0.03);
  // Hysteresis: on the way back it does not return where it came from.
  EXPECT_GT(history.frames.back().angle_rad, history.frames.front().angle_rad + 1.0);
}

TEST(Follow, SaysThatNoEquilibriumIsInRange) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  const std::vector<double> time{0.0, 1.0, 2.0, 3.0};
  const Eigen::MatrixXd a = Eigen::Vector2d(1, 0).replicate(1, 4);
  const AngleHistory history = follow(s, time, a, Eigen::Vector4d(0, 180, 180, 0), 28.0 * deg);
  EXPECT_EQ(history.frames[0].kind, FrameKind::followed);
  EXPECT_EQ(history.frames[1].kind, FrameKind::at_lower);
  EXPECT_EQ(history.frames[2].kind, FrameKind::at_lower);
  EXPECT_EQ(history.frames[1].angle_rad, s.lower_rad);
  EXPECT_LT(history.frames[1].moment_N_m, 0.0);
  EXPECT_EQ(history.frames[3].kind, FrameKind::followed);
  EXPECT_NEAR(history.frames[3].angle_rad, history.frames[0].angle_rad, 1e-4);
  EXPECT_EQ(history.events.size(), 2u);
}

}  // namespace
}  // namespace brachium::optimise::test
