#include "fem/limb/muscle_states.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "data/model/error.hpp"
#include "fem/limb/upper_limb.hpp"
#include "fem/quantities/stress_wrench.hpp"

namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

MuscleStates muscle(bool biceps) {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  const UpperLimb arm = generic_arm(coarse);
  SolvedMuscleOptions options;
  options.solve.relative_residual = 1e-10;
  return {biceps ? arm.biceps : arm.triceps, arm.range, arm.hinge, arm.humerus, options};
}

TEST(MuscleStates, OfBothMusclesAreStableOverTheWholeRangeInAnyOrder) {
  for (const bool biceps : {true, false}) {
    MuscleStates states = muscle(biceps);
    for (const auto& [angle, activation] :
         {std::pair{80.0, 1.0}, {10.0, 0.0}, {150.0, 1.0}, {10.0, 1.0}, {115.0, 0.3}, {150.0, 0.0}}) {
      const SolvedMuscle& s = states.solve_state(angle * degree, activation);
      EXPECT_EQ(s.stability, "stable") << angle << " " << activation;
      EXPECT_LT(s.relative_residual, 1e-10);
      EXPECT_LT(s.identity_error, 1e-14) << "m, of the identity of moments";
      EXPECT_GT(s.tension_n, 0.0);
      EXPECT_LE(s.tension_n, s.force_n);
      EXPECT_EQ(s.moment_n_m > 0.0, biceps) << "biceps flexes, triceps extends";
    }
    EXPECT_GT(states.solve_state(80.0 * degree, 1.0).force_n,
              2.0 * states.solve_state(115.0 * degree, 0.0).force_n);
  }
}

TEST(MuscleStates, DoNotDependOnTheWayThatTheyWereReached) {
  MuscleStates one = muscle(true), other = muscle(true);
  one.solve_state(20.0 * degree, 1.0);
  other.solve_state(150.0 * degree, 0.5);
  const SolvedMuscle &a = one.solve_state(60.0 * degree, 0.5), &b = other.solve_state(60.0 * degree, 0.5);
  EXPECT_NE(a.from_q_rad, b.from_q_rad);
  EXPECT_NEAR(a.force_n, b.force_n, 1e-6 * a.force_n);
  EXPECT_NEAR(a.length_m, b.length_m, 1e-8);
}

TEST(MuscleStates, MomentIsMinusTheSlopeOfTheEnergyWithContactPressed) {
  constexpr double h = 0.02;
  for (const bool biceps : {true, false}) {
    MuscleStates states = muscle(biceps);
    const double q = 70.0 * degree;
    const SolvedMuscle& here = states.solve_state(q, 0.0);
    ASSERT_FALSE(here.contacts.empty());
    EXPECT_GT(here.contacts.front().force_n, 0.5) << "the energy of contact belongs to the claim";
    const double slope =
        (states.solve_state(q + h, 0.0).energy_j - states.solve_state(q - h, 0.0).energy_j) / (2.0 * h);
    EXPECT_NEAR(here.moment_n_m, -slope, 2e-3 * std::abs(slope));
    EXPECT_GT(std::abs(here.moment_n_m - slope), 1.5 * std::abs(slope)) << "the wrong sign must show";
  }
}

TEST(MuscleStates, MomentByStressInTheBellyIsThatOfTheReactions) {
  for (const bool biceps : {true, false}) {
    MuscleStates states = muscle(biceps);
    for (const double activation : {0.0, 1.0}) {
      const SolvedMuscle& s = states.solve_state(75.0 * degree, activation);
      EXPECT_NEAR(s.moment_by_stress_n_m, s.arms.moment_n_m, 0.05 * std::abs(s.arms.moment_n_m));
      const Discretisation d(states.problem().mesh, states.problem().formulation);
      const Wrench face = stress_wrench(states.problem(), d, states.solved(s.q_rad, activation).configuration,
                                        "insertion", Eigen::Vector3d::Zero());
      EXPECT_GT(std::abs(face.moment_n_m.z() - s.arms.moment_n_m),
                1.5 * std::abs(s.moment_by_stress_n_m - s.arms.moment_n_m))
          << "stress is singular along the edge of the clamped face";
    }
  }
}

TEST(MuscleStates, AnswerAKnownStateWithoutSolvingAndRefuseWhatIsOutOfRange) {
  MuscleStates states = muscle(true);
  const SolvedMuscle* first = &states.solve_state(140.0 * degree, 0.0);
  EXPECT_EQ(first, &states.solve_state(140.0 * degree, 0.0));
  EXPECT_THROW(states.solve_state(151.0 * degree, 0.0), data::InputError);
  EXPECT_THROW(states.solve_state(100.0 * degree, 1.1), data::InputError);
  EXPECT_THROW(states.solve_state(std::nan(""), 0.0), data::InputError);
  ASSERT_EQ(states.log().size(), 2u);
  EXPECT_NE(states.log()[1].find("contact with distal humerus is left out"), std::string::npos)
      << states.log()[1];
  EXPECT_GT(first->least_gap_left_out_m, 0.0) << "what was left out is not touched";
}

TEST(MuscleBody, RefusesAMuscleThatIsLongerThanItsPath) {
  UpperLimb arm = generic_arm();
  arm.biceps.belly_length_m = 0.4;
  try {
    check(arm.biceps, arm.range);
    FAIL() << "nothing was thrown";
  } catch (const data::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("length of the rigid tendon that is left [m] = -0.1"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace brachium::fem
