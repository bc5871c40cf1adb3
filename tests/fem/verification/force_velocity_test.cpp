// A cube of active muscle that shortens, or is lengthened, at a constant rate: the active stress is that of
// the force-length relation times Hill's hyperbola at that rate (fem/material/laws.hpp),
//
//   P(l, alpha f_v(v)),   v = (dl/dt)/(v_max l_opt),   P(l, alpha) in study.hpp
//
// Backward Euler differences a constant rate exactly, so that only the solver's tolerances are left.

#include <cmath>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

constexpr double side_m = 0.01, activation = 0.6, max_rate_per_s = 5.0, curvature = 0.25, eccentric = 1.5;

double hill(double v) {
  if (v <= 0.0) return (1.0 + v) / (1.0 - v / curvature);
  return 1.0 + (eccentric - 1.0) * v / (v + (eccentric - 1.0) / (1.0 + 1.0 / curvature));
}

MuscleTendon rated() {
  MuscleTendon law = thesis_muscle_tendon();
  law.rate_dependent = true;
  law.force_velocity = {
      .max_rate_per_s = max_rate_per_s, .curvature = curvature, .eccentric_force = eccentric};
  return law;
}

/// Stress at the end of a ramp from rest length to `stretch` within `duration_s`.
double stress(Formulation formulation, const MuscleTendon& law, double stretch, double duration_s,
              int steps) {
  Problem problem;
  problem.mesh = box_mesh({.type = cell_type(formulation),
                           .cells = {2, 1, 1},
                           .size_m = Eigen::Vector3d::Constant(side_m),
                           .distortion = 0.15});
  problem.formulation = formulation;
  problem.materials = {{law, {VolumetricLaw::quadratic, incompressible}}};
  problem.tissue = uniform_fibres(*problem.mesh, formulation, Eigen::Vector3d::UnitX());
  PrescribedDisplacement pull;
  pull.displacement_m[0] = (stretch - 1.0) * side_m;
  problem.conditions = {condition("x", "x0", SymmetryPlane{}), condition("y", "y0", SymmetryPlane{}),
                        condition("z", "z0", SymmetryPlane{}), condition("pull", "x1", pull)};
  problem.programme = {phase("activate", {}, {{"body", activation}}, 2),
                       phase("move", {{"pull", 1.0}}, {}, steps)};
  problem.programme.back().duration_s = duration_s;
  SolveOptions options = tight(problem);
  options.grow_steps = false;
  const Solved solved = run(problem, options);
  EXPECT_TRUE(solved.summary.completed) << solved.summary.reason;
  return solved.reaction("x1")[0] / (side_m * side_m);
}

class ForceVelocityCube : public testing::TestWithParam<Formulation> {};

TEST_P(ForceVelocityCube, ShortensAndLengthensOnHillsHyperbola) {
  const MuscleTendon law = rated();
  for (const double stretch : {0.9, 1.15}) {
    for (const double duration_s : {0.1, 1.0}) {
      const double v = (stretch - 1.0) / duration_s / (max_rate_per_s * law.force_length.optimal_stretch);
      const double found = stress(GetParam(), law, stretch, duration_s, 4);
      const double expected = uniaxial_stress(law, stretch, activation * hill(v));
      EXPECT_NEAR(found, expected, 1e-8 * std::abs(expected))
          << "stretch " << stretch << " in " << duration_s << " s";
      EXPECT_GT(std::abs(found - uniaxial_stress(law, stretch, activation)), 0.02 * std::abs(expected))
          << "an isometric twin would not be seen";
    }
  }
}

TEST_P(ForceVelocityCube, DoesNotDependOnTheNumberOfSteps) {
  const double coarse = stress(GetParam(), rated(), 0.9, 0.2, 2),
               fine = stress(GetParam(), rated(), 0.9, 0.2, 10);
  EXPECT_NEAR(coarse, fine, 1e-8 * std::abs(fine));
}

INSTANTIATE_TEST_SUITE_P(Formulations, ForceVelocityCube,
                         testing::Values(Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood),
                         named_by_formulation);

}  // namespace
}  // namespace brachium::fem::verification
