#include "fem/limb/cable_path.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "data/model/error.hpp"
#include "fem/limb/published.hpp"
#include "fem/limb/upper_limb.hpp"

namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

std::vector<CableGeometry> cables() {
  return {generic_arm().biceps.cable, generic_arm().triceps.cable};
}

double slope_of_length(const CableGeometry& cable, double q) {
  constexpr double h = 1e-5;
  return (CablePath(cable, q + h).length_m() - CablePath(cable, q - h).length_m()) / (2.0 * h);
}

TEST(CablePath, LeverArmIsMinusTheSlopeOfTheLength) {
  for (const CableGeometry& cable : cables()) {
    for (double q = 10.0; q <= 150.0; q += 7.0) {
      const double arm = CablePath(cable, q * degree).lever_arm_m();
      EXPECT_NEAR(arm, -slope_of_length(cable, q * degree), 1e-9) << q;
      EXPECT_GT(std::abs(arm - slope_of_length(cable, q * degree)), 0.03) << "the wrong sign must show";
    }
  }
}

TEST(CablePath, WrapsAroundACircleOnTheHingeWithItsRadiusAsLeverArm) {
  const CableGeometry cable{{0.0, 0.3}, 0.05, 0.0, {0.0, 0.0}, 0.02, true};
  const CablePath path(cable, 20.0 * degree);
  EXPECT_NEAR(path.lever_arm_m(), 0.02, 1e-15);
  // Tangents from (0, .3) and from .05 away, and the arc between them.
  const double arc =
      0.02 * (std::numbers::pi - 20.0 * degree - std::acos(0.02 / 0.3) - std::acos(0.02 / 0.05));
  EXPECT_NEAR(path.arc_m(), arc, 1e-15);
  EXPECT_NEAR(path.length_m(), std::sqrt(0.09 - 4e-4) + std::sqrt(25e-4 - 4e-4) + arc, 1e-15);
}

TEST(CablePath, PlacesRunFromInsertionToOriginWithUnitSpeed) {
  for (const CableGeometry& cable : cables()) {
    const CablePath path(cable, 30.0 * degree);
    EXPECT_GT(path.arc_m(), 0.0);
    EXPECT_LT((path.place(0.0).point_m - path.insertion_m()).norm(), 1e-15);
    EXPECT_LT((path.place(path.length_m()).point_m - cable.origin_m).norm(), 1e-15);
    for (double s = 1e-3; s < path.length_m() - 1e-3; s += 3e-3) {
      const Eigen::Vector2d chord = (path.place(s + 1e-6).point_m - path.place(s - 1e-6).point_m) / 2e-6;
      EXPECT_LT((chord - path.place(s).towards_origin).norm(), 1e-4) << s;
    }
  }
}

TEST(CablePath, OfTheGenericArmHasLeverArmsWithinATenthOfThePublishedOnes) {
  for (double q = 10.0; q <= 150.0; q += 2.5) {
    EXPECT_NEAR(CablePath(cables()[0], q * degree).lever_arm_m() / published_biceps_lever_arm_m(q * degree),
                1.0, 0.1)
        << q;
    EXPECT_NEAR(CablePath(cables()[1], q * degree).lever_arm_m() / -published_triceps_lever_arm_m(q * degree),
                1.0, 0.1)
        << q;
  }
}

TEST(CablePath, RefusesAnInsertionInsideTheObstacle) {
  try {
    CablePath({{0.0, 0.3}, 0.015, 0.0, {0.0, 0.0}, 0.02, true}, 0.5);
    FAIL() << "nothing was thrown";
  } catch (const data::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("the insertion of a tendon's path lies 0.015 m from the centre"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace brachium::fem
