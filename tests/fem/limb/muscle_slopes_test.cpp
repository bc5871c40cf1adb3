#include <gtest/gtest.h>

#include <numbers>

#include "fem/limb/upper_limb.hpp"

namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

MuscleStates muscle(bool biceps) {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  const UpperLimb arm = generic_arm(coarse);
  SolvedMuscleOptions options;
  options.solve.relative_residual = 1e-11;
  return {biceps ? arm.biceps : arm.triceps, arm.range, arm.hinge, arm.humerus, options};
}

struct Difference {
  double force, tension, moment;
};
Difference between(const SolvedMuscle& a, const SolvedMuscle& b, double step) {
  return {(b.force_n - a.force_n) / step, (b.tension_n - a.tension_n) / step,
          (b.moment_n_m - a.moment_n_m) / step};
}

// Fourth-order differences of solved states: slopes by the tangent are those of the states.
Difference richardson(const Difference& wide, const Difference& narrow) {
  const auto f = [](double w, double n) { return (4.0 * n - w) / 3.0; };
  return {f(wide.force, narrow.force), f(wide.tension, narrow.tension), f(wide.moment, narrow.moment)};
}

void expect(double slope, double difference, double size, const std::string& what) {
  EXPECT_NEAR(slope, difference, 1e-5 * size) << what;
  EXPECT_GT(std::abs(1.01 * slope - difference), 1e-5 * size) << what << ": one per cent off must show";
}

TEST(MuscleSlopes, ByActivationAreThoseOfNeighbouringStates) {
  for (const bool biceps : {true, false}) {
    MuscleStates states = muscle(biceps);
    constexpr double h = 0.02;
    const double q = 75.0 * degree;
    const auto at = [&](double a) { return states.solve_state(q, a); };
    const SolvedMuscle here = at(0.4);
    const Difference d = richardson(between(at(0.4 - 2 * h), at(0.4 + 2 * h), 4 * h),
                                    between(at(0.4 - h), at(0.4 + h), 2 * h));
    expect(here.force_slope_n.by_activation, d.force, here.force_n, "force");
    expect(here.tension_slope_n.by_activation, d.tension, here.force_n, "tension");
    expect(here.moment_slope_n_m.by_activation, d.moment, std::abs(here.moment_n_m), "moment");
  }
}

TEST(MuscleSlopes, ByAngleAreThoseOfNeighbouringStates) {
  for (const bool biceps : {true, false}) {
    MuscleStates states = muscle(biceps);
    constexpr double h = 0.01;
    // A knot of the guided motion, where place and slope are the path's own to second order.
    const double q = 90.0 * degree;
    const auto at = [&](double x) { return states.solve_state(x, 0.6); };
    const SolvedMuscle here = at(q);
    const Difference d =
        richardson(between(at(q - 2 * h), at(q + 2 * h), 4 * h), between(at(q - h), at(q + h), 2 * h));
    EXPECT_NEAR(here.force_slope_n.by_q, d.force, 1e-4 * here.force_n);
    EXPECT_NEAR(here.tension_slope_n.by_q, d.tension, 1e-4 * here.force_n);
    EXPECT_NEAR(here.moment_slope_n_m.by_q, d.moment, 1e-4 * std::abs(here.moment_n_m));
    EXPECT_GT(std::abs(1.01 * here.moment_slope_n_m.by_q - d.moment), 1e-4 * std::abs(here.moment_n_m));
  }
}

// States are known to the tolerance of their contact only, and so are differences of them.
TEST(MuscleSlopes, WithContactToAToleranceAreThoseOfNeighbouringStates) {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  const UpperLimb arm = generic_arm(coarse);
  SolvedMuscleOptions options;
  options.contact_tolerance_m = 1e-5;
  MuscleStates states(arm.triceps, arm.range, arm.hinge, arm.humerus, options);
  constexpr double h = 0.04;
  const double q = 60.0 * degree;
  const SolvedMuscle here = states.solve_state(q, 0.5);
  ASSERT_GT(here.contacts.front().force_n, 10.0);
  const SolvedMuscle below = states.solve_state(q - h, 0.5), above = states.solve_state(q + h, 0.5),
                     weaker = states.solve_state(q, 0.5 - h), stronger = states.solve_state(q, 0.5 + h);
  const Difference angle = between(below, above, 2 * h), activation = between(weaker, stronger, 2 * h);
  const auto near = [](double slope, double difference, double size) {
    EXPECT_NEAR(slope, difference, 0.01 * size);
  };
  near(here.force_slope_n.by_q, angle.force, here.force_n);
  near(here.moment_slope_n_m.by_q, angle.moment, std::abs(here.moment_n_m));
  near(here.force_slope_n.by_activation, activation.force, here.force_n);
  near(here.moment_slope_n_m.by_activation, activation.moment, std::abs(here.moment_n_m));
}

TEST(MuscleSlopes, AtTheEndsOfTheRangeAreThoseOfTheRange) {
  MuscleStates states = muscle(true);
  constexpr double h = 0.01;
  for (const bool upper : {true, false}) {
    const double q = upper ? states.range().upper_rad : states.range().lower_rad, s = upper ? -h : h;
    const SolvedMuscle here = states.solve_state(q, 0.3);
    const double f1 = states.solve_state(q + s, 0.3).force_n, f2 = states.solve_state(q + 2 * s, 0.3).force_n,
                 f3 = states.solve_state(q + 3 * s, 0.3).force_n;
    const double slope = (-11.0 * here.force_n + 18.0 * f1 - 9.0 * f2 + 2.0 * f3) / (6.0 * s);  // third order
    EXPECT_NEAR(here.force_slope_n.by_q, slope, 1e-3 * here.force_n);
    EXPECT_GT(std::abs(here.force_slope_n.by_q), 0.1 * here.force_n) << "a slope that is there to be missed";
  }
}

}  // namespace
}  // namespace brachium::fem
