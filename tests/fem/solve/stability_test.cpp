#include "fem/solve/stability.hpp"

#include "bodies.hpp"
#include "fem/solve/growing_mode.hpp"

namespace brachium::fem {
namespace {

using tests::block_muscle;
using tests::body;
using tests::quick_options;

/// The clamped block on the descending limb of its force-length curve.
Problem descending(double stretch, double alpha) {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.04, 0.01, 0.01}, 8, 2, 2,
                   {block_muscle(), {VolumetricLaw::quadratic, 1e7}});
  p.conditions = {{"left", "x0", Fixed{}},
                  {"right", "x1", PrescribedDisplacement{{0.04 * (stretch - 1.0), 0.0, 0.0}}}};
  p.programme = {{"stretch", {{"right", 1.0}}, {}, {}, 4, 1.0},
                 {"activate", {}, {{p.mesh->regions.front(), alpha}}, {}, 4, 1.0}};
  return p;
}

/// A rod of one material, pushed along its axis by a dead force: it buckles, first as Euler's cantilever
/// does.
TEST(Stability, EulersCriticalLoadIsWhereTheFirstNegativeModeAppears) {
  const double mu = 1e5, a = 0.004, length = 0.08;
  Problem p = body(Formulation::q2_p1_discontinuous, {length, a, a}, 10, 1, 1,
                   {NeoHooke{mu, false}, {VolumetricLaw::quadratic, 200.0 * mu}});
  // E = 3 mu, I = a^4/12, P = pi^2 E I / (4 L^2)
  const double critical = M_PI * M_PI * 3.0 * mu * std::pow(a, 4) / 12.0 / (4.0 * length * length);
  p.conditions = {{"foot", "x0", Fixed{}}, {"push", "x1", DeadTraction{{-critical, 0.0, 0.0}, true}}};
  SolveOptions o = quick_options();
  o.on_instability = "report";
  o.grow_steps = false;
  p.programme = {{"below", {{"push", 0.95}}, {}, {}, 1, 1.0}, {"above", {{"push", 1.05}}, {}, {}, 1, 1.0}};
  const Summary s = solve(p, o);
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_EQ(s.steps[0].stability.verdict, "stable");
  EXPECT_EQ(s.steps.back().stability.verdict, "unstable");
  EXPECT_EQ(s.steps.back().stability.negative_modes, 2) << "bending in y and in z";
  EXPECT_THAT(s.steps.back().stability.method, ::testing::HasSubstr("L D L'"));
  EXPECT_THAT(tests::codes(s.diagnostics), ::testing::Contains("unstable-state"));
}

TEST(Stability, ABuckledRodRelaxesToTheBentStateAndEnergyIsDissipated) {
  const double mu = 1e5, a = 0.004, length = 0.08;
  Problem p = body(Formulation::q2_p1_discontinuous, {length, a, a}, 8, 1, 1,
                   {NeoHooke{mu, false}, {VolumetricLaw::quadratic, 200.0 * mu}});
  const double critical = M_PI * M_PI * 3.0 * mu * std::pow(a, 4) / 12.0 / (4.0 * length * length);
  p.conditions = {{"foot", "x0", Fixed{}}, {"push", "x1", DeadTraction{{-1.1 * critical, 0.0, 0.0}, true}}};
  p.programme = {{"push", {{"push", 1.0}}, {}, {}, 1, 1.0}};
  const Summary s = solve(p, quick_options());
  ASSERT_TRUE(s.completed) << s.reason << log_text(s);
  const StepRecord& last = s.steps.back();
  EXPECT_EQ(last.stability.verdict, "stable");
  EXPECT_GT(s.relaxation_steps, 0);
  double dissipated = 0.0;
  for (const StepRecord& r : s.steps) dissipated += r.dissipated_energy;
  EXPECT_GT(dissipated, 0.0);
  double sideways = 0.0;
  for (const int n : p.mesh->surface_points("x1"))
    sideways = std::max(sideways, s.last.configuration.dofs.segment<2>(3 * n + 1).norm());
  EXPECT_GT(sideways, 0.02) << "far from straight";
  EXPECT_LE(last.relative_residual, 1e-8);
}

/// Stretched and fully activated in one step each, Newton leads Q2/P1 to another equilibrium (29.41 N, 8
/// negative modes) than the one that shorter steps lead to.
TEST(Stability, AStepThatLeadsToAnotherBranchIsHalved) {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.04, 0.01, 0.01}, 8, 2, 2,
                   {block_muscle(), {VolumetricLaw::quadratic, tests::infinite}});
  p.conditions = {{"left", "x0", Fixed{}}, {"right", "x1", PrescribedDisplacement{{0.004, 0.0, 0.0}}}};
  p.programme = {{"stretch", {{"right", 1.0}}, {}, {}, 1, 1.0},
                 {"activate", {}, {{p.mesh->regions.front(), 1.0}}, {}, 1, 1.0}};
  SolveOptions o = quick_options();
  o.on_instability = "fail";
  double force = 0.0;
  const auto observe = [&](const AcceptedState& state) { force = tests::reaction(p, state, "x1")[0]; };
  const Summary long_steps = solve(p, o, observe);
  ASSERT_TRUE(long_steps.completed) << long_steps.reason;
  EXPECT_GT(long_steps.steps.back().phase_time - long_steps.steps[1].phase_time, 0.0) << "it was halved";
  const double reached = force;
  for (Phase& phase : p.programme) phase.steps = 8;
  const Summary short_steps = solve(p, o, observe);
  ASSERT_TRUE(short_steps.completed) << short_steps.reason;
  EXPECT_NEAR(reached, force, 1e-6);
  EXPECT_NEAR(reached, 29.5330, 0.005) << "Taylor-Hood on the same mesh";
}

/// What grows fastest in a flow: the slender rod's bending, of which Taylor-Hood must see the displacements
/// and not a pressure, and of a block on the descending limb modes far from the eigenvalue next to zero.
TEST(Stability, TheGrowingModeIsADirectionAlongWhichTheEnergyFalls) {
  for (const Formulation f : {Formulation::q2_q1_taylor_hood, Formulation::q2_p1_discontinuous}) {
    const double mu = 1e5, a = 0.004, length = 0.08;
    const double critical = M_PI * M_PI * 3.0 * mu * std::pow(a, 4) / 12.0 / (4.0 * length * length);
    Problem p =
        body(f, {length, a, a}, 8, 1, 1, {NeoHooke{mu, false}, {VolumetricLaw::quadratic, tests::infinite}});
    p.conditions = {{"foot", "x0", Fixed{}}, {"push", "x1", DeadTraction{{-1.2 * critical, 0.0, 0.0}, true}}};
    p.programme = {{"push", {{"push", 1.0}}, {}, {}, 1, 1.0}};
    SolveOptions o = quick_options();
    o.on_instability = "report";
    const Summary s = solve(p, o);
    ASSERT_TRUE(s.completed) << s.reason;
    Equations equations(p, o);
    equations.constrain({});
    TangentFactor factor(o);
    factor.analyse(equations);
    const LoadPoint load = Programme(p).at(s.last, 1.0);
    const auto mode = growing_mode(equations, factor, s.last.configuration, load);
    ASSERT_TRUE(mode.has_value());
    EXPECT_DOUBLE_EQ(mode->head(equations.displacement_unknowns()).cwiseAbs().maxCoeff(), 1.0);
    // Euler's shape, 1 - cos(pi x / 2 L), sideways.
    const Eigen::VectorXd by_dof = equations.unknowns().extend(*mode);
    const auto side = [&](double x) {
      double size = 0.0;
      for (int n = 0; n < p.mesh->point_count(); ++n) {
        if (std::abs(p.mesh->points(0, n) - x) < 1e-9)
          size = std::max(size, by_dof.segment<2>(3 * n + 1).norm());
      }
      return size;
    };
    EXPECT_NEAR(side(0.5 * length) / side(length), 1.0 - std::cos(0.25 * M_PI), 0.02) << to_string(f);
    // The energy falls: the residual after a small move along the mode pushes further.
    const double part = 1e-3 * equations.cell_size_m();
    Configuration moved = s.last.configuration;
    equations.add(*mode, part, moved.dofs);
    const Evaluation there = equations.evaluate(moved, load);
    EXPECT_LT(there.residual.dot(*mode), 0.0) << to_string(f);
  }
}

TEST(Stability, TheSaddlePointCountsAsTheCondensedBodyDoes) {
  const double mu = 1e5, a = 0.004, length = 0.08;
  const double critical = M_PI * M_PI * 3.0 * mu * std::pow(a, 4) / 12.0 / (4.0 * length * length);
  Problem p = body(Formulation::q2_q1_taylor_hood, {length, a, a}, 10, 1, 1,
                   {NeoHooke{mu, false}, {VolumetricLaw::quadratic, tests::infinite}});
  p.conditions = {{"foot", "x0", Fixed{}}, {"push", "x1", DeadTraction{{-critical, 0.0, 0.0}, true}}};
  p.programme = {{"below", {{"push", 0.95}}, {}, {}, 1, 1.0}, {"above", {{"push", 1.05}}, {}, {}, 1, 1.0}};
  SolveOptions o = quick_options();
  o.on_instability = "report";
  o.grow_steps = false;
  const Summary s = solve(p, o);
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_EQ(s.steps[0].stability.negative_modes, 0);
  EXPECT_EQ(s.steps.back().stability.negative_modes, 2);
}

TEST(Stability, AnUnstableContractionIsReportedRefusedOrRelaxedAsAsked) {
  const Problem p = descending(1.2, 1.0);
  SolveOptions o = quick_options();
  o.on_instability = "report";
  const Summary reported = solve(p, o);
  const auto unstable = std::find_if(reported.steps.begin(), reported.steps.end(),
                                     [](const StepRecord& r) { return r.stability.verdict == "unstable"; });
  ASSERT_NE(unstable, reported.steps.end()) << log_text(reported);
  EXPECT_GT(unstable->stability.negative_modes, 0);
  EXPECT_LE(unstable->relative_residual, 1e-8) << "an equilibrium all the same";
  EXPECT_THAT(tests::codes(reported.diagnostics), ::testing::Contains("unstable-state"));

  o.on_instability = "fail";
  const Summary refused = solve(p, o);
  EXPECT_FALSE(refused.completed);
  EXPECT_THAT(refused.reason, ::testing::AllOf(::testing::HasSubstr("phase `activate`"),
                                               ::testing::HasSubstr("negative modes")));
  EXPECT_TRUE(refused.last.configuration.dofs.allFinite());

  o.on_instability = "relax";
  const Summary relaxed = solve(p, o);
  ASSERT_TRUE(relaxed.completed) << relaxed.reason << log_text(relaxed);
  for (const StepRecord& r : relaxed.steps) EXPECT_EQ(r.stability.verdict, "stable");
  EXPECT_GT(relaxed.relaxation_steps, 0);
  EXPECT_LE(relaxed.steps.back().relative_residual, 1e-8);
}

/// The fully active block past its optimum, where plain Newton is lost: viscous continuation gets through
/// with either kind of pressure, and what it leaves holds no viscosity.
TEST(Stability, ContinuationGetsThroughTheDescendingLimbWithEitherPressure) {
  for (const Formulation f : {Formulation::q2_q1_taylor_hood, Formulation::q2_p1_discontinuous}) {
    Problem p =
        body(f, {0.04, 0.01, 0.01}, 6, 2, 2, {block_muscle(), {VolumetricLaw::quadratic, tests::infinite}});
    const Problem clamped = descending(1.2, 1.0);
    p.conditions = clamped.conditions;
    p.programme = clamped.programme;
    const Summary s = solve(p, quick_options());
    ASSERT_TRUE(s.completed) << to_string(f) << ": " << s.reason;
    EXPECT_GT(s.relaxation_steps, 0);
    EXPECT_EQ(s.steps.back().stability.verdict, "stable");
    EXPECT_LE(s.steps.back().relative_residual, 1e-8);
    EXPECT_NEAR(s.steps.back().volume, 4e-6, 1e-12);
    EXPECT_EQ(s.last.configuration.viscosity_pa_s, 0.0);
  }
}

TEST(Stability, ASolveThatCannotEndSaysWhereAndKeepsTheLastState) {
  Problem p = body(Formulation::q1_p0, {0.01, 0.01, 0.01}, 2, 2, 2, tests::soft(1e6));
  p.conditions = {{"foot", "x0", Fixed{}},
                  {"crush", "x1", PrescribedDisplacement{{-0.0101, 0.0, 0.0}}}};  // turns the body inside out
  p.programme = {{"crush", {{"crush", 1.0}}, {}, {}, 2, 1.0}};
  SolveOptions o = quick_options();
  o.on_instability = "fail";
  o.stability = "off";
  const Summary s = solve(p, o);
  EXPECT_FALSE(s.completed);
  EXPECT_THAT(s.reason,
              ::testing::AllOf(::testing::HasSubstr("phase `crush`"), ::testing::HasSubstr("step "),
                               ::testing::HasSubstr("cell"), ::testing::HasSubstr("relative residual")));
  EXPECT_GT(s.last.phase_time, 0.0);
  EXPECT_TRUE(s.last.configuration.dofs.allFinite());
  EXPECT_FALSE(s.failed.iterations.empty());
}

}  // namespace
}  // namespace brachium::fem
