#include "fem/solve/stability.hpp"

#include "bodies.hpp"

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
  EXPECT_EQ(s.steps[1].stability.verdict, "unstable");
  EXPECT_EQ(s.steps[1].stability.negative_modes, 2) << "bending in y and in z";
  EXPECT_THAT(s.steps[1].stability.method, ::testing::HasSubstr("L D L'"));
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
  EXPECT_GT(last.relaxation_steps, 0);
  EXPECT_GT(last.dissipated_energy, 0.0);
  double sideways = 0.0;
  for (const int n : p.mesh->surface_points("x1"))
    sideways = std::max(sideways, s.last.configuration.dofs.segment<2>(3 * n + 1).norm());
  EXPECT_GT(sideways, 0.02) << "far from straight";
  EXPECT_LE(last.relative_residual, 1e-8);
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
  EXPECT_EQ(s.steps[1].stability.negative_modes, 2);
}

TEST(Stability, AnUnstableContractionIsReportedRefusedOrRelaxedAsAsked) {
  const Problem p = descending(1.3, 0.25);
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
