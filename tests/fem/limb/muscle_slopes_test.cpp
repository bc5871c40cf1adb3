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
