#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/limb/muscle_reading.hpp"
#include "tests/fem/limb/coarse_arm.hpp"

// The triceps slides along the humerus from 10 to 150 deg and back.
namespace brachium::fem {
namespace {

MuscleStates triceps(double tolerance_m) {
  const UpperLimb arm = coarse_arm();
  return states_of(arm, arm.triceps, tolerance_m);
}

/// Turns of a curve that are more than `least` deep: a smooth one has few, one that chatters has many.
int turns(const std::vector<double>& f, double least) {
  int count = 0, rising = 0;
  double extreme = f.front();
  for (const double v : f) {
    if (rising == 0 ? std::abs(v - extreme) > least : rising * (extreme - v) > least) {
      if (rising != 0) ++count;
      rising = v > extreme ? 1 : -1;
      extreme = v;
    } else if (rising != 0) {
      extreme = rising > 0 ? std::max(extreme, v) : std::min(extreme, v);
    }
  }
  return count;
}

TEST(ContactSweep, TurnsAreCountedWhereACurveChatters) {
  std::vector<double> smooth, chattering;
  for (int i = 0; i < 40; ++i) {
    smooth.push_back(std::sin(0.07 * i));
    chattering.push_back(smooth.back() + (i % 2 == 0 ? 0.03 : -0.03));
  }
  EXPECT_EQ(turns(smooth, 0.01), 1);
  EXPECT_GT(turns(chattering, 0.01), 20);
}

TEST(ContactSweep, DoesNotChatter) {
  MuscleStates states = triceps(0.0);
  std::vector<double> contact, force;
  int slow = 0;
  for (double q = 10.0; q <= 150.0; q += 4.0) {
    const SolvedMuscle& s = states.solve_state(q * degree, 0.5);
    EXPECT_EQ(s.stability, "stable") << q;
    contact.push_back(contact_force(s));
    force.push_back(s.force_n);
    if (q > 10.0 && (s.steps > 1 || s.newton_iterations > 6)) ++slow;
  }
  EXPECT_GT(*std::min_element(contact.begin(), contact.end()), 1.0) << "pressed all the way";
  EXPECT_LE(turns(contact, 0.01 * contact.front()), 2);
  EXPECT_EQ(turns(force, 1e-3 * force.front()), 0) << "it lengthens, and pulls more, all the way";
  EXPECT_LE(slow, 2) << "states that took more than one step or six factorisations";
}

TEST(ContactSweep, PenetratesNoMoreThanItsTolerance) {
  constexpr double tolerance = 1e-5;
  MuscleStates exact = triceps(tolerance), penalised = triceps(0.0);
  double greatest = 0.0;
  for (const double q : {10.0, 45.0, 80.0, 115.0, 150.0}) {
    for (const double a : {0.0, 1.0}) {
      const SolvedMuscle &s = exact.solve_state(q * degree, a), &p = penalised.solve_state(q * degree, a);
      EXPECT_EQ(s.stability, "stable");
      for (const BoneContact& c : s.contacts)
        EXPECT_LE(c.greatest_penetration_m, tolerance) << c.bone << " " << q;
      for (const BoneContact& c : p.contacts) greatest = std::max(greatest, c.greatest_penetration_m);
      EXPECT_NEAR(p.force_n, s.force_n, 0.01 * s.force_n) << "what the penalty lets through hardly matters";
      EXPECT_NEAR(s.moment_by_stress_n_m, s.arms.moment_n_m, 0.1 * std::abs(s.arms.moment_n_m));
    }
  }
  EXPECT_GT(greatest, 10.0 * tolerance) << "the penalty alone does not keep it";
}

TEST(ContactSweep, PressureThatIsShownIsThatOfTheContactForceWithMultipliersToo) {
  std::vector<double> shown;
  for (const double tolerance : {0.0, 1e-5}) {
    MuscleStates states = triceps(tolerance);
    const SolvedMuscle& s = states.solve_state(60.0 * degree, 1.0);
    const Configuration& now = states.solved(60.0 * degree, 1.0).configuration;
    const Problem& problem = states.problem();
    const Discretisation discretisation(problem.mesh, problem.formulation);
    const Eigen::VectorXd pressure = contact_pressure_pa(problem, discretisation, now);
    EXPECT_GE(pressure.minCoeff(), 0.0);
    Eigen::Index first = 0;
    double over_points = 0.0, resultants = 0.0;
    for (const Contact& c : problem.contacts) {
      const ContactSurface surface(discretisation, c.surface, c.body, {c.penalty_pa_per_m, c.smoothing_m});
      const Eigen::VectorXd multiplier =
          tolerance > 0.0 ? Eigen::VectorXd(now.contact_multiplier.segment(first, surface.point_count()))
                          : Eigen::VectorXd();
      first += surface.point_count();
      const ContactPoints points = surface.points(now.dofs, {}, multiplier);
      over_points += points.area_m2.dot(points.pressure_pa);
      if (&c == &problem.contacts.front())
        shown.push_back(surface.at_mesh_points(now.dofs, {}, multiplier).area_m2.dot(pressure));
    }
    for (const BoneContact& c : s.contacts) resultants += c.force_n;
    EXPECT_GT(resultants, 10.0);
    EXPECT_NEAR(shown.back(), over_points, 1e-12 * over_points) << tolerance;
    EXPECT_GE(shown.back(), resultants) << "directions differ over the surface";
  }
  EXPECT_NEAR(shown[1], shown[0], 0.3 * shown[0]) << "held by multipliers as by the penalty";
}

}  // namespace
}  // namespace brachium::fem
