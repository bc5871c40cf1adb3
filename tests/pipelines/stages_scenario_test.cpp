// optimise.scenario on a system whose answers are known in closed form.

#include <gtest/gtest.h>

#include "data/model/error.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

// Flexor F = 100 + 200 a, extensor F = 100 + 100 a, arms 30 mm and 30 mm, load at 300 mm: M = 3 (2 a_f - a_e)
// - 0.3 L sin q.
const std::string system_of_two = R"(
load_arm_mm = 300.0
muscle = [
  { name = "flexor", action = "flexor", angle_deg = [10, 80, 170], force_N = [100, 100, 100, 300, 300, 300], lever_arm_mm = [30.0] },
  { name = "extensor", action = "extensor", angle_deg = [10, 80, 170], force_N = [100, 100, 100, 200, 200, 200], lever_arm_mm = [30.0] },
]
)";

std::string code_of(const std::string& options) {
  try {
    run("optimise.scenario", options);
  } catch (const data::InputError& e) {
    return e.diagnostics().front().code;
  }
  return "none";
}

TEST(ScenarioStage, FindsBothAnglesOfALoadWithTheirStability) {
  // 3 (2 a) = 0.3 L sin q: with a = 0.25, L = 10: sin q = 0.5.
  const StageData data =
      run("optimise.scenario", system_of_two + "equilibrium = [{ activation = [0.25, 0.0], load_N = 10.0 }]");
  const data::Table& t = data.tables.at("equilibria");
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_NEAR(t.numbers("angle_deg")[0], 30.0, 1e-3);
  EXPECT_NEAR(t.numbers("angle_deg")[1], 150.0, 1e-3);
  EXPECT_EQ(t.texts("outcome")[0], "stable");
  EXPECT_EQ(t.texts("outcome")[1], "unstable");
  EXPECT_EQ(data.tables.at("moments").rows(), 141u);
  EXPECT_GE(data.tables.at("convergence").rows(), 6u);
}

TEST(ScenarioStage, FindsTheActivationThatHoldsAnAngleOrSaysWhatIsMissing) {
  const StageData data = run("optimise.scenario", system_of_two + R"(position = [
    { angle_deg = 30, sought = "flexor", activation = [0, 0.2], load_N = 10 },
    { angle_deg = 90, sought = "extensor", activation = [0, 0], load_N = 10 }])");
  const data::Table& t = data.tables.at("positions");
  EXPECT_NEAR(t.numbers("activation")[0], 0.35, 1e-6);
  EXPECT_EQ(t.texts("outcome")[1], "none in range");
  EXPECT_NEAR(t.numbers("remaining_moment_N_m")[1], -3.0, 1e-9);
  EXPECT_NEAR(t.numbers("remaining_load_N")[1], -10.0, 1e-9);
}

TEST(ScenarioStage, FindsTheActivationsOfAMotionAndHowItCameToThem) {
  const StageData data = run("optimise.scenario", system_of_two + R"(motion = [
    { name = "bend", time_s = [0, 1], angle_deg = [30, 60], sought = "flexor", activation = [0, 0.2], load_N = [10], frames = 4 },
    { name = "too much", time_s = [0, 1], angle_deg = [30, 90], sought = "flexor", activation = [0, 0.2, 0.2, 0.2], load_N = [10, 30], frames = 4 }]
position = [{ name = "30 deg", angle_deg = 30, sought = "flexor", activation = [0, 0.2], load_N = 10 }])");
  const data::Table& t = data.tables.at("motions");
  ASSERT_EQ(t.rows(), 8u);
  for (std::size_t i = 0; i < 4; ++i) {  // 3 (2 a - 0.2) = 3 sin q
    const double q = (30.0 + 10.0 * static_cast<double>(i)) * 3.14159265358979 / 180.0;
    EXPECT_NEAR(t.numbers("activation")[i], 0.5 * (std::sin(q) + 0.2), 1e-6) << i;
    EXPECT_NEAR(t.numbers("dactivation_dangle_per_deg")[i], 0.5 * std::cos(q) * 3.14159265358979 / 180.0,
                1e-6);
  }
  EXPECT_EQ(t.texts("outcome")[7], "none in range");
  EXPECT_NEAR(t.numbers("remaining_moment_N_m")[7], 3.0 * (2.0 - 0.2) - 9.0, 1e-9);
  const data::Table& iterations = data.tables.at("position_convergence");
  ASSERT_GE(iterations.rows(), 2u);
  EXPECT_NEAR(iterations.numbers("activation").back(), 0.35, 1e-6);
  EXPECT_LT(std::abs(iterations.numbers("moment_N_m").back()), 1e-5);
}

TEST(ScenarioStage, FollowsALoadAndNamesTheEndOfTheRange) {
  const StageData data = run("optimise.scenario", system_of_two + R"(history = [
    { name = "load", time_s = [0, 1, 2], load_N = [10, 6, 4], activation = [0.25, 0.0], start_deg = 20, frames = 21 }])");
  const data::Table& t = data.tables.at("histories");
  ASSERT_EQ(t.rows(), 21u);
  EXPECT_NEAR(t.numbers("angle_deg")[0], 30.0, 1e-3);
  EXPECT_NEAR(t.numbers("angle_deg")[10], std::asin(1.5 / 1.8) * 180.0 / 3.14159265358979, 1e-3);
  EXPECT_EQ(t.texts("kind").back(), "at upper end");
  EXPECT_EQ(data.tables.at("events").rows(), 1u);
}

TEST(ScenarioStage, RefusesTablesThatDoNotFit) {
  EXPECT_EQ(
      code_of(
          R"(muscle = [{ name = "a", action = "flexor", angle_deg = [10, 90], force_N = [1, 2, 3], lever_arm_mm = [30.0] }])"),
      "wrong-size");
  EXPECT_EQ(code_of(system_of_two + "equilibrium = [{ activation = [0.5] }]"), "wrong-size");
  EXPECT_EQ(
      code_of(system_of_two + R"(position = [{ angle_deg = 30, sought = "flexer", activation = [0, 0] }])"),
      "unknown-value");
  EXPECT_EQ(code_of(system_of_two + "history = [{ time_s = [0, 1], load_N = [1], activation = [0, 0] }]"),
            "wrong-size");
  EXPECT_EQ(
      code_of(system_of_two +
              "motion = [{ time_s = [0, 1], angle_deg = [30], sought = \"flexor\", activation = [0, 0] }]"),
      "wrong-size");
  EXPECT_EQ(code_of(system_of_two + "lower_deg = 0.0\nequilibrium = [{ activation = [0, 0] }]"),
            "outside-surrogate");
}

}  // namespace
}  // namespace brachium::pipelines::tests
