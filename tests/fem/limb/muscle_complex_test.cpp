#include <gtest/gtest.h>

#include <numbers>

#include "fem/limb/upper_limb.hpp"

// The muscle-tendon complex beside the rigid-tendon variant of the same muscle.
namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

struct Pair {
  MuscleStates rigid, complex;
};

Pair muscles(bool biceps) {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  const UpperLimb arm = generic_arm(coarse);
  const MuscleBody body = biceps ? arm.biceps : arm.triceps;
  const MuscleBody complex = biceps ? with_tendons(body, 0.012, 0.015) : with_tendons(body, 0.009, 0.008);
  return {{body, arm.range, arm.hinge, arm.humerus}, {complex, arm.range, arm.hinge, arm.humerus}};
}

TEST(MuscleComplex, OfStiffTendonsIsTheRigidTendonVariantToThreePerCent) {
  for (const bool biceps : {true, false}) {
    Pair m = muscles(biceps);
    for (const auto& [angle, activation] : {std::pair{130.0, 0.0}, {90.0, 0.0}, {90.0, 1.0}, {50.0, 1.0}}) {
      const SolvedMuscle &r = m.rigid.solve_state(angle * degree, activation),
                         &c = m.complex.solve_state(angle * degree, activation);
      EXPECT_EQ(c.stability, "stable");
      EXPECT_NEAR(c.tension_n, r.tension_n, 0.03 * r.tension_n) << angle << " " << activation;
      EXPECT_NEAR(c.moment_n_m, r.moment_n_m, 0.04 * std::abs(r.moment_n_m)) << angle << " " << activation;
      EXPECT_LT(c.identity_error, 1e-14) << "m, of the identity of moments";
      EXPECT_LT(c.stretch_min, r.stretch_min + 0.01) << "tendon hardly stretches";
    }
    EXPECT_GT(m.complex.unknowns(), m.rigid.unknowns());
  }
}

TEST(MuscleComplex, MomentIsMinusTheSlopeOfTheEnergy) {
  constexpr double h = 0.02;
  Pair m = muscles(true);
  const double q = 80.0 * degree;
  const SolvedMuscle& here = m.complex.solve_state(q, 0.0);
  const double slope =
      (m.complex.solve_state(q + h, 0.0).energy_j - m.complex.solve_state(q - h, 0.0).energy_j) / (2.0 * h);
  EXPECT_NEAR(here.moment_n_m, -slope, 2e-3 * std::abs(slope));
}

TEST(MuscleComplex, SaysFromWhichAngleItsEndLiesOnTheObstacle) {
  LimbMesh coarse;
  coarse.belly_cells = 3;
  const UpperLimb arm = generic_arm(coarse);
  const MuscleStates longer(with_tendons(arm.triceps, 0.0, 0.03), arm.range, arm.hinge, arm.humerus);
  bool said = false;
  for (const std::string& line : longer.log()) said |= line.find("lies on the obstacle") != std::string::npos;
  EXPECT_TRUE(said);
  const MuscleStates rigid(arm.triceps, arm.range, arm.hinge, arm.humerus);
  for (const std::string& line : rigid.log()) EXPECT_EQ(line.find("lies on the obstacle"), std::string::npos);
}

}  // namespace
}  // namespace brachium::fem
