#include "fem/solve/programme.hpp"

#include "bodies.hpp"

namespace brachium::fem {
namespace {

using tests::body;
using tests::quick_options;
using tests::reaction;
using tests::soft;

Problem pulled() {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.02, 0.01, 0.01}, 2, 1, 1, soft());
  p.conditions = {{"left", "x0", Fixed{}}, {"right", "x1", PrescribedDisplacement{{0.002, 0.001, 0.0}}}};
  return p;
}

TEST(Programme, AmplitudesMoveLinearlyFromWhereTheyStand) {
  Problem p = pulled();
  p.programme = {{"out", {{"right", 1.0}}, {}, {}, 1, 1.0},
                 {"back", {{"right", -0.5}}, {{p.mesh->regions.front(), 0.4}}, {}, 1, 1.0}};
  const Programme programme(p);
  SolveState state = programme.start(3);
  EXPECT_DOUBLE_EQ(programme.at(state, 0.25).amplitude[1], 0.25);
  programme.advance(state, 1.0);
  programme.next_phase(state);
  EXPECT_DOUBLE_EQ(programme.at(state, 0.0).amplitude[1], 1.0);
  EXPECT_DOUBLE_EQ(programme.at(state, 0.5).amplitude[1], 0.25);
  EXPECT_DOUBLE_EQ(programme.at(state, 0.5).activation[0], 0.2);
  EXPECT_EQ(programme.at(state, 1.0).amplitude[1], -0.5);
}

TEST(Release, ReactionsFadeLinearlyAndTheBodyEndsAtRest) {
  Problem p = pulled();
  p.programme = {{"pull", {{"right", 1.0}}, {}, {}, 1, 1.0}, {"let go", {}, {}, {"right"}, 4, 1.0}};
  SolveOptions o = quick_options();
  o.grow_steps = false;
  std::vector<Eigen::Vector3d> left;
  std::vector<double> time;
  const Summary s = solve(p, o, [&](const AcceptedState& state) {
    left.push_back(reaction(p, state, "x0"));
    time.push_back(state.record.phase_time);
  });
  ASSERT_TRUE(s.completed) << s.reason;
  ASSERT_EQ(left.size(), 5u);
  for (std::size_t k = 1; k < left.size(); ++k) {
    EXPECT_LT((left[k] - (1.0 - time[k]) * left[0]).norm(), 1e-6 * left[0].norm()) << "at " << time[k];
  }
  EXPECT_LT(s.last.configuration.dofs.cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Release, OfOneOfTwoConditionsLeavesWhatTheOtherHolds) {
  Problem p = pulled();
  p.conditions.push_back({"plane", "x1", Fixed{{false, true, false}}});
  p.conditions[1].kind = PrescribedDisplacement{{0.002, NAN, NAN}};
  p.programme = {{"pull", {{"right", 1.0}}, {}, {}, 1, 1.0}, {"let go", {}, {}, {"right"}, 1, 1.0}};
  const Summary s = solve(p, quick_options());
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_EQ(s.analyses, 2);
  for (const int n : p.mesh->surface_points("x1")) EXPECT_EQ(s.last.configuration.dofs[3 * n + 1], 0.0);
}

TEST(Steps, GrowWhereNewtonIsQuickAndEndOnThePhase) {
  Problem p = pulled();
  p.programme = {{"pull", {{"right", 1.0}}, {}, {}, 10, 1.0}};
  const Summary s = solve(p, quick_options());
  ASSERT_TRUE(s.completed);
  EXPECT_LT(s.steps.size(), 10u);
  EXPECT_EQ(s.steps.back().phase_time, 1.0);
  SolveOptions fixed = quick_options();
  fixed.grow_steps = false;
  EXPECT_EQ(solve(p, fixed).steps.size(), 10u);
}

TEST(Steps, AreCutWhereNewtonFails) {
  Problem p = body(Formulation::q1_p0, {0.01, 0.01, 0.01}, 3, 3, 3, soft(1e6));
  p.conditions = {{"foot", "x0", Fixed{}}, {"press", "x1", PrescribedDisplacement{{-0.006, 0.0, 0.0}}}};
  p.programme = {{"press", {{"press", 1.0}}, {}, {}, 1, 1.0}};
  SolveOptions o = quick_options();
  o.max_iterations = 4;
  o.chord = false;
  o.on_instability = "report";
  const Summary s = solve(p, o);
  ASSERT_TRUE(s.completed) << s.reason;
  long cuts = 0;
  for (const StepRecord& r : s.steps) cuts += r.cut_backs;
  EXPECT_GT(cuts, 0);
}

TEST(Progress, RisesToOne) {
  Problem p = pulled();
  p.programme = {{"pull", {{"right", 1.0}}, {}, {}, 2, 1.0}, {"back", {{"right", 0.0}}, {}, {}, 2, 1.0}};
  std::vector<double> seen;
  solve(p, quick_options(), {}, [&](double fraction, const std::string&) { seen.push_back(fraction); });
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_EQ(seen.back(), 1.0);
}

}  // namespace
}  // namespace brachium::fem
