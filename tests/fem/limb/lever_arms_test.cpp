#include "fem/limb/lever_arms.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

TEST(LeverArms, OfAPureForceAreItsDistanceFromTheAxisByBothDefinitions) {
  const Wrench pull{{0.0, 100.0, 0.0}, {0.0, 0.0, 0.0}};
  const ResultantLeverArms arms = lever_arms({}, pull, {0.04, -0.01, 0.02});
  EXPECT_DOUBLE_EQ(arms.vrla_m, 0.04);
  EXPECT_DOUBLE_EQ(arms.vrla_plus_m, 0.04);
  EXPECT_DOUBLE_EQ(arms.moment_n_m, 4.0);
}

TEST(LeverArms, LineOfActionCarriesTheMomentThatTheBarycentreMisses) {
  // A force of 100 N at x = 40 mm, but told as force and moment at x = 30 mm.
  const Wrench told{{0.0, 100.0, 0.0}, {0.0, 0.0, 1.0}};
  const ResultantLeverArms arms = lever_arms({}, told, {0.03, 0.0, 0.0});
  EXPECT_DOUBLE_EQ(arms.vrla_m, 0.03);
  EXPECT_DOUBLE_EQ(arms.vrla_plus_m, 0.04);
  EXPECT_DOUBLE_EQ(arms.moment_n_m, 4.0);
  EXPECT_DOUBLE_EQ(arms.moment_of_line_n_m, 4.0);
}

TEST(LeverArms, BothMomentsAgreeForAnyWrench) {
  const Wrench any{{3.0, -70.0, 12.0}, {0.2, 0.5, -0.9}};
  const ResultantLeverArms arms =
      lever_arms({{0.01, 0.02, 0.0}, Eigen::Vector3d(1.0, 2.0, 2.0) / 3.0}, any, {0.04, 0.1, -0.02});
  EXPECT_NEAR(arms.moment_n_m, arms.moment_of_line_n_m, 1e-14);
  EXPECT_GT(std::abs(arms.vrla_m - arms.vrla_plus_m), 1e-3);
}

TEST(LeverArms, ByTendonDisplacementAreTheSlopesOfTheLength) {
  std::vector<double> q, length;
  for (double at = 0.2; at < 2.6; at += 0.1) {
    q.push_back(at);
    length.push_back(0.4 + 0.04 * std::cos(at));
  }
  const std::vector<double> arms = tendon_displacement_lever_arms(q, length);
  for (std::size_t i = 0; i < q.size(); ++i) EXPECT_NEAR(arms[i], 0.04 * std::sin(q[i]), 5e-5) << q[i];
  EXPECT_THROW(tendon_displacement_lever_arms({0.0, 1.0, 2.0}, {1.0, 2.0, 3.0}), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
