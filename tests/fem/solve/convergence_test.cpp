#include "bodies.hpp"

namespace brachium::fem {
namespace {

using tests::block_muscle;
using tests::body;
using tests::infinite;
using tests::quick_options;
using tests::reaction;

/// Cube between three symmetry planes, the fourth face moved along the fibres.
Problem cube(Formulation formulation, double stretch, double activation, double bend) {
  Problem p = body(formulation, {0.01, 0.01, 0.01}, 2, 1, 1,
                   {block_muscle(), {VolumetricLaw::quadratic, infinite}}, bend);
  p.conditions = {{"x", "x0", SymmetryPlane{}},
                  {"y", "y0", SymmetryPlane{}},
                  {"z", "z0", SymmetryPlane{}},
                  {"pull", "x1", PrescribedDisplacement{{0.01 * (stretch - 1.0), NAN, NAN}}}};
  if (stretch != 1.0) p.programme.push_back({"stretch", {{"pull", 1.0}}, {}, {}, 4, 1.0});
  if (activation > 0.0)
    p.programme.push_back({"activate", {}, {{p.mesh->regions.front(), activation}}, {}, 2, 1.0});
  return p;
}

/// Nominal stress of the incompressible law: 2 (l - l^-2)(c1 + c2/l) + c3/l (l^c4 - 1) + alpha sigma_max
/// f_l(l).
double nominal_stress(double l, double alpha) {
  const double iso = 2.0 * (l - 1.0 / (l * l)) * (3560.0 + 3860.0 / l);
  const double passive = l >= 1.0 ? 0.0357 / l * (std::pow(l, 42.6) - 1.0) : 0.0;
  const double x = l / 1.2 - 1.0,
               f = std::exp(-std::pow(std::abs(x) / (x <= 0.0 ? 0.25 : 0.15), x <= 0.0 ? 3.0 : 4.0));
  return iso + passive + alpha * 0.3e6 * f;
}

class ActiveCube : public ::testing::TestWithParam<Formulation> {};

TEST_P(ActiveCube, MatchesTheClosedFormTo1e9) {
  for (const auto& [stretch, alpha] : {std::pair{0.8, 0.5},
                                       {0.8, 1.0},
                                       {0.9, 0.25},
                                       {1.0, 1.0},
                                       {1.1, 0.0},
                                       {1.1, 0.5},
                                       {1.2, 1.0},
                                       {1.3, 0.0}}) {
    const Problem p = cube(GetParam(), stretch, alpha, 0.0);
    double force = 0.0;
    SolveOptions o = quick_options();
    o.relative_residual = 1e-11;
    o.volume_tolerance = 1e-11;
    o.on_instability = "report";
    const Summary s = solve(p, o, [&](const AcceptedState& state) { force = reaction(p, state, "x1")[0]; });
    ASSERT_TRUE(s.completed) << stretch << " " << alpha << ": " << s.reason;
    const double expected = 1e-4 * nominal_stress(stretch, alpha);
    EXPECT_NEAR(force, expected, 1e-9 * std::abs(expected)) << "stretch " << stretch << ", alpha " << alpha;
    EXPECT_NEAR(s.steps.back().volume, 1e-6, 1e-15);
  }
}

INSTANTIATE_TEST_SUITE_P(Incompressible, ActiveCube,
                         ::testing::Values(Formulation::q2_q1_taylor_hood, Formulation::q2_p1_discontinuous,
                                           Formulation::q1_p0, Formulation::p2b_p1_discontinuous,
                                           Formulation::p2_p1_taylor_hood),
                         [](const auto& which) { return to_string(which.param); });

/// Clamped at both ends: nothing homogeneous about it.
Problem clamped(Formulation formulation, double stretch, double alpha, int nx = 6, int ny = 2,
                double bulk = 1e7) {
  Problem p =
      body(formulation, {0.04, 0.01, 0.01}, nx, ny, ny, {block_muscle(), {VolumetricLaw::quadratic, bulk}});
  p.conditions = {{"left", "x0", Fixed{}},
                  {"right", "x1", PrescribedDisplacement{{0.04 * (stretch - 1.0), 0.0, 0.0}}}};
  p.programme = {{"stretch", {{"right", 1.0}}, {}, {}, 1, 1.0},
                 {"activate", {}, {{p.mesh->regions.front(), alpha}}, {}, 1, 1.0}};
  return p;
}

TEST(NewtonConvergence, ChordIterationsReachTheSameStateWithFewerFactorisations) {
  SolveOptions full = quick_options(), chord = full;
  full.chord = false;
  full.relative_residual = chord.relative_residual = 1e-10;
  const Problem p = clamped(Formulation::q2_p1_discontinuous, 1.1, 0.5);
  const Summary one = solve(p, full), other = solve(p, chord);
  ASSERT_TRUE(one.completed && other.completed) << one.reason << other.reason;
  EXPECT_LT((one.last.configuration.dofs - other.last.configuration.dofs).norm(),
            1e-8 * one.last.configuration.dofs.norm());
  EXPECT_GT(other.chord_iterations, 0);
  EXPECT_LT(other.newton_iterations, one.newton_iterations);
}

TEST(NewtonConvergence, OneAnalysisServesTheWholeProgramme) {
  const Summary s = solve(clamped(Formulation::q1_p0, 1.05, 0.3), quick_options());
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_EQ(s.analyses, 1);
}

TEST(NewtonConvergence, BitsDoNotDependOnTheNumberOfThreads) {
  const Problem p = clamped(Formulation::q2_p1_discontinuous, 1.1, 0.5);
  SolveOptions one = quick_options(), two = one;
  two.threads = 2;
  const Summary a = solve(p, one), b = solve(p, two);
  ASSERT_TRUE(a.completed && b.completed);
  EXPECT_EQ(a.last.configuration.dofs, b.last.configuration.dofs);
  EXPECT_EQ(a.newton_iterations, b.newton_iterations);
}

TEST(NewtonConvergence, AFullActivationAtOnceIsReached) {
  Problem p = clamped(Formulation::q2_p1_discontinuous, 1.0, 1.0);
  p.programme.erase(p.programme.begin());
  double force = 0.0;
  const Summary s =
      solve(p, quick_options(), [&](const AcceptedState& state) { force = reaction(p, state, "x1")[0]; });
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_EQ(s.steps.size(), 1u);
  EXPECT_GT(force, 20.0);
}

TEST(NewtonConvergence, ABodyWithoutLoadStaysAtRest) {
  Problem p = clamped(Formulation::q1_p0, 1.0, 0.0);
  p.programme = {{"nothing moves", {{"right", 1.0}}, {}, {}, 1, 1.0}};
  const Summary s = solve(p, quick_options());
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_EQ(s.last.configuration.dofs.cwiseAbs().maxCoeff(), 0.0);
}

TEST(NewtonConvergence, AnActiveBodyThatBearsOnNothingConverges) {
  Problem p = cube(Formulation::q2_p1_discontinuous, 1.0, 0.3, 0.05);
  p.conditions.pop_back();
  SolveOptions o = quick_options();
  o.on_instability = "report";
  const Summary s = solve(p, o);
  ASSERT_TRUE(s.completed) << s.reason << log_text(s);
  // Shortened until the ground balances the active stress, without any reaction: nominal stress 0.
  double end = 0.0;
  for (const int n : p.mesh->surface_points("x1")) end = s.last.configuration.dofs[3 * n];
  EXPECT_NEAR(nominal_stress(1.0 + end / 0.01, 0.3), 0.0, 1e-2);
}

/// Exact incompressibility by multipliers against the saddle point, as forces on the same mesh.
TEST(AugmentedLagrange, AgreesWithTaylorHoodAndCountsItsAugmentations) {
  const auto force = [](Formulation f) {
    double value = 0.0;
    const Problem p = clamped(f, 1.1, 0.5, 6, 2, infinite);
    const Summary s =
        solve(p, quick_options(), [&](const AcceptedState& state) { value = reaction(p, state, "x1")[0]; });
    EXPECT_TRUE(s.completed) << s.reason << log_text(s);
    if (f == Formulation::q2_p1_discontinuous) {
      EXPECT_GT(s.augmentations, 0);
      EXPECT_LE(s.steps.back().worst_volume, 1e-8);
    }
    EXPECT_NEAR(s.steps.back().volume, 4e-6, 1e-12);
    return value;
  };
  EXPECT_NEAR(force(Formulation::q2_p1_discontinuous), force(Formulation::q2_q1_taylor_hood), 0.02);
}

}  // namespace
}  // namespace brachium::fem
