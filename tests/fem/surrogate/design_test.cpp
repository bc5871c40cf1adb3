// Ask for states, compute, feed back, refine.

#include "fem/surrogate/design.hpp"

#include <algorithm>

#include "data/model/error.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

const std::vector<std::string> one{"output_0"};

// Runs a design until it has at least `states` results.
void run(Design& design, const Truth& truth, std::size_t states, std::size_t step = 4) {
  while (true) {
    design.feed(sample(design.wanted(), {truth}));
    ASSERT_TRUE(design.wanted().empty());
    if (design.size() >= states || design.refine(step) == 0) return;
  }
}

// A ridge in the angle, linear in activation: only angles need to be refined.
OutputValue ridge(double t, double a) {
  const double e = std::exp(-std::pow((t - 0.8) / 0.15, 2));
  return {100.0 * a * e + 20.0 * a, 100.0 * a * e * -2.0 * (t - 0.8) / (0.15 * 0.15), 100.0 * e + 20.0};
}

TEST(SparseDesign, AsksForTheRegularGridFirst) {
  const auto design = sparse_design(elbow(), one);
  EXPECT_EQ(design->wanted().size(), 17u);
  EXPECT_THROW(design->surrogate(), data::InputError);
  EXPECT_THROW(design->refine(4), data::InputError);
}

TEST(SparseDesign, RefinesWhereTheFunctionIsRough) {
  const auto design = sparse_design(elbow(), one, {SparseBoundary::included, 2, 8});
  run(*design, ridge, 90);
  SparseGrid regular = SparseGrid::regular(SparseBoundary::included, 4);
  std::vector<StatePoint> states;
  for (const SparseIndex& p : regular.points()) states.push_back(state_of(p, elbow()));
  const double adaptive = differences(design->surrogate(), ridge).value;
  const double plain =
      differences(sparse_surrogate(sample(states, {ridge}), elbow(), SparseBoundary::included), ridge).value;
  EXPECT_LT(adaptive, 0.2 * plain);
}

TEST(SparseDesign, DoesNotDependOnTheOrderOfItsResults) {
  const auto forth = sparse_design(elbow(), one), back = sparse_design(elbow(), one);
  for (int k = 0; k < 4; ++k) {
    SampleSet results = sample(forth->wanted(), {muscle});
    forth->feed(results);
    std::reverse(results.samples.begin(), results.samples.end());
    for (const Sample& s : results.samples) back->feed({one, {s}});
    EXPECT_EQ(forth->refine(6), back->refine(6));
  }
  const auto a = forth->wanted(), b = back->wanted();
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].theta_rad, b[i].theta_rad);
}

TEST(SparseDesign, GoesOnWithoutAFailedStateAndAsksForNothingBelowIt) {
  const auto design = sparse_design(elbow(), one);
  SampleSet results = sample(design->wanted(), {muscle});
  const auto bad = std::find_if(results.samples.begin(), results.samples.end(), [](const Sample& s) {
    return std::abs(s.at.theta_rad - 45.0 * deg) < 1e-9 && s.at.activation == 0.0;
  });
  ASSERT_NE(bad, results.samples.end());
  const StatePoint lost = bad->at;
  results.samples.erase(bad);
  design->feed(results);
  design->fail(lost, "negative J");
  EXPECT_TRUE(design->wanted().empty());
  EXPECT_EQ(design->surrogate().states(), 16u);
  design->refine(60);
  for (const StatePoint& s : design->wanted())
    EXPECT_FALSE(std::abs(s.theta_rad - lost.theta_rad) < 25.0 * deg && s.activation == 0.0 &&
                 s.theta_rad != 80.0 * deg)
        << s.theta_rad / deg;
}

TEST(SparseDesign, TakesResultsOfAnEarlierRun) {
  const auto first = sparse_design(elbow(), one), second = sparse_design(elbow(), one);
  SampleSet all{one, {}};
  for (int k = 0; k < 3; ++k) {
    const SampleSet results = sample(first->wanted(), {muscle});
    all.samples.insert(all.samples.end(), results.samples.begin(), results.samples.end());
    first->feed(results);
    if (k < 2) first->refine(5);
  }
  second->feed(all);
  EXPECT_TRUE(second->wanted().empty());
  EXPECT_EQ(second->size(), first->size());
  EXPECT_EQ(derivative_mismatch(second->surrogate()), derivative_mismatch(first->surrogate()));
}

TEST(SparseDesign, StopsAtTheFinestLevel) {
  const auto design = sparse_design(elbow(), one, {SparseBoundary::included, 2, 3});
  run(*design, muscle, 10000, 1000);
  EXPECT_EQ(design->size(), 81u);  // the full grid of level 3
  EXPECT_EQ(design->refine(5), 0u);
}

TEST(GridDesign, RefinesTheDirectionThatNeedsIt) {
  GridDesignOptions options;
  options.theta_states = 5, options.activation_states = 3;
  const auto design = grid_design(elbow(), one, options);
  run(*design, ridge, 40);
  std::vector<double> activations;
  SampleSet none;
  const Surrogate s = design->surrogate();
  EXPECT_EQ(s.patches().alpha().lines().size(), 3u);
  EXPECT_GT(s.patches().theta().lines().size(), 12u);
}

TEST(GridDesign, OfHermiteStatesReachesThePublishedErrorWithFortyNineStates) {
  GridDesignOptions options;
  options.theta_states = 5, options.activation_states = 3;
  const auto design = grid_design(elbow(), one, options);
  run(*design, muscle, 40, 1);
  EXPECT_LE(design->size(), 49u);
  SampleSet known =
      sample(grid_states(equidistant(10.0 * deg, 150.0 * deg, 15), equidistant(0.0, 1.0, 9)), {muscle});
  EXPECT_LT(error_at(design->surrogate(), known).outputs[0].relative_l2, 0.5 * 3.3e-3);
}

TEST(GridDesign, WithSplinesNeedsNoDerivatives) {
  GridDesignOptions options;
  options.hermite = false;
  const auto design = grid_design(elbow(), one, options);
  design->feed(sample(design->wanted(), {muscle}, false));
  const std::size_t asked = design->refine(1);
  EXPECT_GT(asked, 0u);
  design->feed(sample(design->wanted(), {muscle}, false));
  EXPECT_NO_THROW(design->surrogate());
}

TEST(GridDesign, NamesTheStateThatFailed) {
  const auto design = grid_design(elbow(), one);
  SampleSet results = sample(design->wanted(), {muscle});
  const StatePoint lost = results.samples.back().at;
  results.samples.pop_back();
  design->feed(results);
  design->fail(lost, "no equilibrium");
  try {
    design->surrogate();
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "states-missing");
    EXPECT_NE(e.diagnostics().front().message.find("no equilibrium"), std::string::npos);
  }
  EXPECT_THROW(design->feed(sample({{1.0, 0.123}}, {muscle})), data::InputError);
}

}  // namespace
}  // namespace brachium::fem::test
