// fem.muscle_map: the figures of single states, failures that are named, grids that grow, and what bad input
// is told.

#include <gmock/gmock.h>

#include <numbers>

#include "fem/limb/muscle_states.hpp"
#include "pipelines/options.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "pipelines/stages/limb_scene.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr double degree = std::numbers::pi / 180.0;

std::string limb_file() {
  return (brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml").string();
}

std::string coarse(const std::string& more) {
  return "limb = \"" + limb_file() + "\"\nmesh = { belly_cells = 4 }\n" + more;
}

const std::string small_grid = "angle_deg = [20, 60, 100, 140]\nactivation = [0, 1]\n";

const StageData& small_map() {
  static const StageData map = named(run("fem.muscle_map", coarse(small_grid), {}, {"*"}, elbow(), 2), "map");
  return map;
}

/// A stage with a folder for what a later run can go on from; also what it says and why it failed.
struct Kept {
  StageOutput output;
  std::vector<std::string> said;
};
Kept run_beside(const std::string& options, const std::filesystem::path& beside) {
  const StageSpec& spec = *catalogue().find("fem.muscle_map");
  const Options checked = options_from_text(options, spec);
  StageContext context;
  context.name = "map";
  context.options = &checked;
  context.threads = 2;
  context.beside = beside;
  if (checked.number_map("pre_stretch").size() > 0) context.made_from["option.pre_stretch"] = "given";
  Kept kept;
  context.say = [&](const std::string& line) { kept.said.push_back(line); };
  data::MemorySession signals;
  kept.output.signals = &signals;
  spec.run(context, kept.output);
  return kept;
}

TEST(MuscleMapStage, HasTheFiguresOfSingleStatesAndTheirLeverArms) {
  const data::Table& states = small_map().tables.at("states");
  ASSERT_EQ(states.rows(), 16u);
  const LimbScene limb = read_limb(limb_file(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  fem::MuscleStates biceps(limb.muscle("biceps").body, limb.range, limb.hinge, limb.humerus);
  const fem::SolvedMuscle& s = biceps.solve_state(100.0 * degree, 1.0);
  const std::size_t row = 5;
  ASSERT_EQ(states.texts("muscle")[row], "biceps");
  ASSERT_EQ(states.numbers("angle_deg")[row], 100.0);
  EXPECT_NEAR(states.numbers("force_N")[row], s.force_n, 1e-6 * s.force_n);
  EXPECT_NEAR(states.numbers("moment_N_m")[row], s.moment_n_m, 1e-6 * s.moment_n_m);
  EXPECT_NEAR(states.numbers("greatest_fibre_stretch")[row], s.stretch_max, 1e-6);
  EXPECT_EQ(states.texts("outcome")[row], "stable");
  // The passive length's slope is the lever arm of the work that the passive force does.
  const std::size_t passive = 2;
  EXPECT_NEAR(states.numbers("tdm_m")[passive],
              states.numbers("moment_N_m")[passive] / states.numbers("force_N")[passive], 1.5e-3);
  EXPECT_EQ(states.numbers("tdm_m")[passive], states.numbers("tdm_m")[passive + 1]) << "of the angle alone";
  EXPECT_GT(states.numbers("vrla_m")[row], 0.0);
  EXPECT_LT(states.numbers("vrla_m")[row + 8], 0.0) << "the triceps extends";
}

TEST(MuscleMapStage, SaysWhichBonesAreModelledAndSharesAddUp) {
  const data::Table& muscles = small_map().tables.at("muscles");
  EXPECT_THAT(muscles.texts("bones")[0], HasSubstr("biceps: contact with distal humerus is left out"));
  EXPECT_THAT(small_map().attributes.at("not_modelled"), HasSubstr("ulna, radius"));
  const data::Table& stretch = small_map().tables.at("fibre_stretch");
  double sum = 0.0, mean = 0.0;
  for (std::size_t k = 0; k < stretch.rows(); ++k) {
    if (stretch.texts("muscle")[k] != "triceps" || stretch.numbers("angle_deg")[k] != 60.0 ||
        stretch.numbers("activation")[k] != 1.0)
      continue;
    sum += stretch.numbers("share")[k];
    mean += stretch.numbers("share")[k] * stretch.numbers("stretch")[k];
  }
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(mean, small_map().tables.at("states").numbers("mean_fibre_stretch")[8 + 3], 0.01)
      << "half an interval";
  EXPECT_EQ(small_map().tables.at("contacts").rows(), 8u * 1u + 8u * 2u);
}

TEST(MuscleMapStage, GivesSurrogatesThatPassThroughItsStates) {
  const LimbMap map = limb_map_of(small_map());
  ASSERT_EQ(map.muscles.size(), 2u);
  EXPECT_FALSE(map.muscles[1].flexor);
  EXPECT_NEAR(map.load_arm_m, 0.2825, 1e-15);
  for (const std::string& method : moment_methods()) {
    const fem::SurrogateModel model = model_of(map, method, "elbow");
    limb::Evaluation e;
    model.evaluate(Eigen::VectorXd::Constant(1, 60.0 * degree), Eigen::VectorXd::Zero(1),
                   Eigen::Vector2d(1.0, 0.0), {}, e);
    const data::Table& states = small_map().tables.at("states");
    EXPECT_NEAR(e.force(0), states.numbers("force_N")[3], 1e-9 * e.force(0)) << method;
    const std::string column = method == "virtual_work" ? "moment_N_m" : method + "_m";
    const double of_table = states.numbers(column)[3] * (method == "virtual_work" ? 1.0 : e.force(0));
    EXPECT_NEAR(e.moment_arm(0, 0) * e.force(0), of_table, 1e-9) << method;
  }
}

TEST(MuscleMapStage, SolvesOnlyWhatIsNewWhenAGridGrows) {
  const std::filesystem::path beside = brachium::tests::scratch_dir() / "01-map";
  const std::string one = "muscles = [\"triceps\"]\nsurrogate = \"none\"\nactivation = [0, 1]\nangle_deg = ";
  const Kept first = run_beside(coarse(one + "[20, 80]"), beside);
  EXPECT_TRUE(first.output.diagnostics.empty());
  const Kept second = run_beside(coarse(one + "[20, 50, 80]"), beside);
  ASSERT_EQ(second.output.diagnostics.size(), 1u);
  EXPECT_EQ(second.output.diagnostics[0].message, "4 states were there from an earlier run");
  const Kept whole = run_beside(coarse(one + "[20, 50, 80]"), beside.parent_path() / "02-map");
  const data::Table &a = second.output.tables.at("states"), &b = whole.output.tables.at("states");
  EXPECT_EQ(a.numbers("angle_deg"), b.numbers("angle_deg"));
  for (std::size_t k = 0; k < a.rows(); ++k)
    EXPECT_NEAR(a.numbers("force_N")[k], b.numbers("force_N")[k], 1e-6 * b.numbers("force_N")[k]);
  EXPECT_EQ(a.numbers("solve_s")[0], first.output.tables.at("states").numbers("solve_s")[0])
      << "not solved again";
  const Kept other = run_beside(coarse("pre_stretch = { triceps = 1.15 }\n" + one + "[20, 80]"), beside);
  EXPECT_TRUE(other.output.diagnostics.empty()) << "another muscle: nothing of it is known";
}

TEST(MuscleMapStage, NamesStatesThatFailAndKeepsTheOthers) {
  const Kept kept =
      run_beside(coarse(small_grid + "muscles = [\"biceps\"]\nmax_stress_Pa = { biceps = 3e8 }\n"
                                     "solver = { smallest_step = 0.25, on_instability = \"fail\" }"),
                 brachium::tests::scratch_dir() / "01-map");
  ASSERT_TRUE(kept.output.failure.has_value());
  EXPECT_THAT(*kept.output.failure, StartsWith("muscle `biceps`: no surrogate without the state at "));
  const data::Table& states = kept.output.tables.at("states");
  ASSERT_EQ(states.rows(), 8u) << "failed ones have their rows";
  std::size_t failed = 0;
  for (const std::string& outcome : states.texts("outcome")) failed += outcome.starts_with("failed: from ");
  EXPECT_GE(failed, 4u);
  EXPECT_LT(failed, 8u);
  EXPECT_EQ(kept.output.diagnostics.size(), failed);
  EXPECT_EQ(kept.output.diagnostics[0].code, "failed-state");
  EXPECT_EQ(kept.output.attributes.at("verdict_tone"), "warning");
  EXPECT_FALSE(kept.output.tables.contains("surrogate_error"));
}

TEST(MuscleMapStage, TakesASparseGridOverTheWholeRange) {
  const StageData map = run(
      "fem.muscle_map", coarse("muscles = [\"triceps\"]\nsparse_level = 2\nsurrogate = \"sparse_modified\""));
  const data::Table& states = map.tables.at("states");
  std::size_t asked = 0;
  for (const double a : states.numbers("asked")) asked += a == 1.0;
  EXPECT_EQ(asked, 5u);
  EXPECT_EQ(states.rows(), 8u) << "and the passive state of each of three angles";
  const LimbMap of = limb_map_of(map);
  EXPECT_EQ(of.muscles[0].surrogate->states(), 5u);
  EXPECT_NEAR(of.muscles[0].surrogate->bounds().theta_upper_rad, 150.0 * degree, 1e-12);
}

TEST(MuscleMapStage, ScalesTheLimbToTheSubject) {
  const StageData subject = subject_data();
  const StageData map = run("fem.muscle_map",
                            coarse("muscles = [\"biceps\"]\nangle_deg = [60]\nactivation = [1]\nsurrogate = "
                                   "\"none\"\nscale_to = \"subject\""),
                            {{"subject", {&subject}}});
  const data::Table& t = map.tables.at("scaling");
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.texts("stands_for")[0], "BIClong, BICshort");
  const double force = 624.3 + 435.56;
  EXPECT_NEAR(t.numbers("strength_N")[0], force, 1e-6);
  EXPECT_NEAR(t.numbers("max_stress_Pa")[0] * t.numbers("mean_section_m2")[0], force, 1e-6 * force);
  EXPECT_EQ(t.numbers("length_factor")[0], t.numbers("length_factor")[1]);
  EXPECT_NEAR(map.tables.at("muscles").numbers("max_stress_Pa")[0], t.numbers("max_stress_Pa")[0], 1e-9);
}

TEST(MuscleMapStage, HasTheExactSlopesOfItsStatesInTheSurrogate) {
  const LimbMap map = limb_map_of(small_map());
  EXPECT_THAT(map.muscles[0].surrogate->method(), StartsWith("Hermite"));
  const data::Table& states = small_map().tables.at("states");
  for (const std::size_t row : {2u, 3u, 12u}) {
    const MappedMuscle& m = map.muscles[states.texts("muscle")[row] == "biceps" ? 0 : 1];
    std::vector<fem::OutputValue> out(m.surrogate->outputs().size());
    m.surrogate->evaluate(states.numbers("angle_deg")[row] * degree, states.numbers("activation")[row], out);
    const auto& force = out[m.surrogate->output("force_n")];
    const auto& moment = out[m.surrogate->output("moment_n_m")];
    const auto near = [&](double found, const char* column) {
      EXPECT_NEAR(found, states.numbers(column)[row], 1e-9 * std::abs(states.numbers(column)[row]))
          << column << row;
    };
    near(force.dtheta, "dforce_dangle_N_per_rad");
    near(force.dalpha, "dforce_dactivation_N");
    near(moment.dtheta, "dmoment_dangle_N_m_per_rad");
    near(moment.dalpha, "dmoment_dactivation_N_m");
  }
}

TEST(MuscleMapStage, IsAskedForEquilibriaByEachLeverArm) {
  const std::string cases =
      "equilibrium = [{ name = \"both\", activation = [0.4, 0.3] }]\nlever_arm = [\"virtual_work\", "
      "\"vrla\"]";
  const StageData found = run("optimise.scenario", cases, {{"map", {&small_map()}}});
  const data::Table& t = found.tables.at("equilibria");
  ASSERT_EQ(t.rows(), 2u);
  EXPECT_EQ(t.texts("system")[0], "map: virtual work");
  EXPECT_EQ(t.texts("system")[1], "map: resultant (VRLA)");
  const LimbMap map = limb_map_of(small_map());
  for (std::size_t k = 0; k < 2; ++k) {
    const fem::SurrogateModel model = model_of(map, k == 0 ? "virtual_work" : "vrla", "elbow");
    limb::Evaluation e;
    model.evaluate(Eigen::VectorXd::Constant(1, t.numbers("angle_deg")[k] * degree), Eigen::VectorXd::Zero(1),
                   Eigen::Vector2d(0.4, 0.3), {}, e);
    const double scale =
        std::abs(e.moment_arm(0, 0) * e.force(0)) + std::abs(e.moment_arm(0, 1) * e.force(1));
    EXPECT_LT(std::abs(e.moment(0)), 1e-6 * scale) << "optimise/scenario.hpp";
    EXPECT_EQ(t.texts("outcome")[k], e.dmoment_dq(0, 0) < 0.0 ? "stable" : "unstable");
  }
  EXPECT_GT(std::abs(t.numbers("angle_deg")[0] - t.numbers("angle_deg")[1]), 0.1)
      << "two systems, not one twice";
}

TEST(MuscleMapStage, ScenariosTakeForcesFromOnePlaceOnly) {
  const std::string given =
      "muscle = [{ name = \"a\", action = \"flexor\", angle_deg = [10, 90], force_N = [1, 2, 3, 4], "
      "lever_arm_mm = [30.0] }]";
  EXPECT_THAT(
      error_of([&] {
        run("optimise.scenario", given, {{"map", {&small_map()}}});
      }),
      StartsWith("error[contradiction]: forces come from `muscle` or from the input `map`, not from both\n"));
  EXPECT_THAT(error_of([&] { run("optimise.scenario", ""); }),
              StartsWith("error[missing-key]: there are no muscles: neither `muscle` nor the input `map`\n"));
  const StageData other = session_data({});
  EXPECT_THAT(error_of([&] {
                run("optimise.scenario", "", {{"map", {&other}}});
              }),
              StartsWith("error[not-a-muscle-map]: stage `session` leaves no muscle map\n"));
}

std::string told(const std::string& more) {
  return error_of([&] { run("fem.muscle_map", coarse(more)); });
}

TEST(MuscleMapStage, TellsWhatIsWrongBeforeItSolves) {
  EXPECT_EQ(told(""),
            "error[contradiction]: a muscle map takes one of `angle_deg` with `activation`, `sparse_level`, "
            "and `state`\n"
            "  help: say which states are to be solved\n");
  EXPECT_EQ(told("angle_deg = [20]"),
            "error[missing-key]: `angle_deg` and `activation` belong together\n  help: a grid needs both\n");
  EXPECT_THAT(told("muscles = [\"bicepts\"]\n" + small_grid), StartsWith("error[no-match]: "));
  EXPECT_THAT(told("pre_stretch = { bicepts = 1.1 }\n" + small_grid),
              StartsWith("error[missing-muscle]: the limb `Generic arm: biceps and triceps over a hinge` has "
                         "no muscle `bicepts`\n  help: did you mean `biceps`?"));
  EXPECT_THAT(told("pre_stretch = { biceps = 1.9 }\n" + small_grid),
              StartsWith("error[limb-geometry]: `pre_stretch` of muscle `biceps`: biceps: length of the "
                         "rigid tendon that is left [m] = "));
  EXPECT_EQ(told("angle_deg = [5, 20, 60, 100]\nactivation = [0, 1]"),
            "error[limb-range]: biceps: there is no state at 5 deg, activation 0\n"
            "  help: angles from 10 to 150 deg and activations from 0 to 1\n");
  EXPECT_THAT(told("state = [{ angle_deg = 20, activation = 0 }, { angle_deg = 50, activation = 1 }]"),
              StartsWith("error[not-a-grid]: "));
  EXPECT_THAT(told("surrogate = \"sparse_included\"\n" + small_grid), StartsWith("error[not-a-grid]: "));
  EXPECT_THAT(
      told(small_grid + "scale_to = \"subject\"\ngroup = [{ muscle = \"biceps\", members = [\"BIClong\", "
                        "\"BRA\"] }, { muscle = \"triceps\", members = [\"BRA\"] }]"),
      StartsWith("error[contradiction]: muscle `BRA` is in the groups of `biceps` and of `triceps`\n"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
