#include "bodies.hpp"

namespace brachium::fem {
namespace {

using tests::body;
using tests::quick_options;

/// Stretch, activate, let go of the far end.
Problem three_phases(Formulation formulation, double bulk) {
  Problem p = body(formulation, {0.02, 0.01, 0.01}, 3, 1, 1,
                   {tests::block_muscle(), {VolumetricLaw::quadratic, bulk}}, 0.05);
  p.conditions = {{"left", "x0", Fixed{}},
                  {"right", "x1", PrescribedDisplacement{{0.001, 0.0, 0.0}}},
                  {"shear", "y1", DeadTraction{{10.0, 0.0, 5.0}, false}}};
  const std::string region = p.mesh->regions.front();
  p.programme = {{"stretch", {{"right", 1.0}, {"shear", 1.0}}, {}, {}, 3, 1.0},
                 {"activate", {}, {{region, 0.2}}, {}, 3, 1.0},
                 {"release", {}, {{region, 0.0}}, {"right"}, 3, 1.0}};
  return p;
}

class Restart : public ::testing::TestWithParam<std::pair<Formulation, double>> {};

TEST_P(Restart, FromEveryStateGivesTheBitsOfTheUninterruptedSolve) {
  const Problem p = three_phases(GetParam().first, GetParam().second);
  SolveOptions o = quick_options();
  o.grow_steps = false;
  o.on_instability = "report";
  std::vector<SolveState> states;
  const Summary whole = solve(p, o, [&](const AcceptedState& s) { states.push_back(s.state); });
  ASSERT_TRUE(whole.completed) << whole.reason;
  ASSERT_GE(states.size(), 9u);
  for (const std::size_t k : {std::size_t{1}, std::size_t{2}, std::size_t{4}, std::size_t{6}}) {
    const Summary rest = solve(p, o, {}, {}, &states[k]);
    ASSERT_TRUE(rest.completed) << rest.reason;
    EXPECT_EQ(rest.steps.size(), whole.steps.size() - k - 1);
    EXPECT_EQ(rest.last.configuration.dofs, whole.last.configuration.dofs) << "from state " << k;
    EXPECT_EQ(rest.last.configuration.multiplier, whole.last.configuration.multiplier);
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, Restart,
                         ::testing::Values(std::pair{Formulation::q2_p1_discontinuous, 1e7},
                                           std::pair{Formulation::q2_p1_discontinuous, tests::infinite},
                                           std::pair{Formulation::q2_q1_taylor_hood, tests::infinite}));

TEST(RestartState, OfAnotherProblemIsRefused) {
  const Problem p = three_phases(Formulation::q2_p1_discontinuous, 1e7),
                other = three_phases(Formulation::q1_p0, 1e7);
  SolveOptions o = quick_options();
  o.on_instability = "report";
  const Summary s = solve(p, o);
  try {
    solve(other, o, {}, {}, &s.last);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "restart-mismatch");
  }
}

}  // namespace
}  // namespace brachium::fem
