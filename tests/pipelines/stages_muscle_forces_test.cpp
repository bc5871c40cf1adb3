// optimise.muscle_forces: a parameter found again, handed on to a map, and what bad references are told.

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "data/model/resample.hpp"
#include "fem/limb/body_parameters.hpp"
#include "fem/limb/muscle_states.hpp"
#include "pipelines/options.hpp"
#include "pipelines/stages/limb_scene.hpp"
#include "pipelines/stages/muscle_force_references.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double degree = std::numbers::pi / 180.0;
constexpr double radius = 0.0215;

std::string limb_options() {
  return "limb = \"" + (brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml").string() +
         "\"\nmesh = { belly_cells = 3 }\n";
}

/// Options with the forces of a biceps whose greatest radius is `radius`.
std::string references() {
  const LimbScene limb = read_limb(brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml",
                                   LimbVariant::rigid_tendon, {.belly_cells = 3});
  fem::MuscleBody truth = limb.muscle("biceps").body;
  fem::set_body_value(truth, "greatest_radius_m", radius);
  fem::MuscleStates states(truth, limb.range, limb.hinge, limb.humerus);
  const auto force = [&](double q, double a) { return states.solve_state(q * degree, a).force_n; };
  return fmt::format(
      "reference = [\n"
      "  {{ muscle = \"biceps\", set = \"passive\", activation = 0, angle_deg = [90, 150], force_N = "
      "[{:.12g}, {:.12g}] "
      "}},\n"
      "  {{ muscle = \"biceps\", set = \"maximal\", activation = 1, angle_deg = [90, 150], force_N = "
      "[{:.12g}, {:.12g}] "
      "}}]\n",
      force(90, 0), force(150, 0), force(90, 1), force(150, 1));
}

const StageData& fit() {
  static const StageData data = named(
      run("optimise.muscle_forces",
          limb_options() + references() +
              "muscles = [\"biceps\"]\nbegin_at = \"limb\"\nfree = [{ parameter = \"greatest_radius_m\" }]\n",
          {}, {"*"}, elbow(), 1),
      "fit");
  return data;
}

TEST(MuscleForcesStage, FindsTheRadiusThatTheForcesWereMadeWith) {
  const data::Table& verdicts = fit().tables.at("verdicts");
  ASSERT_EQ(verdicts.rows(), 1u);
  EXPECT_NEAR(verdicts.numbers("fitted")[0], radius, 1e-6);
  EXPECT_EQ(verdicts.texts("owner")[0], "biceps");
  const data::Table& agreement = fit().tables.at("agreement");
  ASSERT_EQ(agreement.rows(), 4u) << "two sets, by the continuum and by the strap beside it";
  EXPECT_LT(agreement.numbers("relative_l2")[0], 1e-4);
  EXPECT_GT(agreement.numbers("relative_l2")[2], 1e-2) << "a strap is no continuum";
}

TEST(MuscleForcesStage, HandsItsResultToAMap) {
  const std::string states =
      "muscles = [\"biceps\"]\nsurrogate = \"none\"\nstate = [{ angle_deg = 90, activation = 1 }]\n";
  const StageData map =
      run("fem.muscle_map", limb_options() + states, {{"fitted", {&fit()}}}, {"*"}, elbow(), 1);
  const data::Table &mapped = map.tables.at("states"), &forces = fit().tables.at("forces");
  EXPECT_NEAR(mapped.numbers("force_N").back(), forces.numbers("reference_N")[2],
              1e-4 * forces.numbers("reference_N")[2]);
}

/// What the lumped muscles of a group exert becomes the target, frame for frame, one reference a cell.
TEST(MuscleForcesStage, TakesTheMomentsOfTheMusclesThatAContinuumMuscleStandsFor) {
  const StageData activation =
      named(run("emg.activation", "", {{"excitation", {&truth()}}}, {"curl"}), "activation");
  const StageData fim = named(
      run("hill.moment", "", {{"activation", {&activation}}, {"kinematics", {&recordings()}}}, {"curl"}),
      "fim");
  const StageData fitted =
      run("optimise.muscle_forces",
          limb_options() +
              "muscles = [\"biceps\"]\nmax_iterations = 2\nbegin_at = \"limb\"\n"
              "moment_angle_cell_deg = 70\nmoment_activation_cell = 0.5\n"
              "free = [{ parameter = \"max_stress_pa\" }]\n",
          {{"moments", {&fim}}, {"activation", {&activation}}, {"kinematics", {&recordings()}}}, {"curl"},
          elbow(), 1);
  const data::Table& t = fitted.tables.at("moments");
  ASSERT_GE(t.rows(), 2u);
  EXPECT_EQ(fitted.tables.at("forces").rows(), 0u);
  const std::size_t curl = recordings().signals->info().trial_index("curl");
  std::size_t at = 0;
  for (const data::TrialInfo& info = recordings().signals->info().trials[curl];
       info.signals[at].quantity != data::Quantity::joint_angle;)
    ++at;
  const data::Signal angle = recordings().signals->signal(curl, at);
  for (std::size_t i = 0; i < t.rows(); ++i) {
    double nearest = 1e9, moment = 0.0;
    const data::Signal any = signal(fim, "curl", "BIClong_force");
    std::vector<double> time;
    for (std::size_t k = 0; k < any.samples.size(); ++k) time.push_back(any.info.time_s(k));
    std::vector<double> q, sum(time.size(), 0.0), mean(time.size(), 0.0);
    double strength = 0.0;
    for (const data::SceneMuscle& m : elbow().muscles) {
      if (m.group != "biceps") continue;
      const data::Signal f = signal(fim, "curl", m.name + "_force"),
                         r = signal(fim, "curl", m.name + "_moment_arm");
      const double f0 = m.parameters.strength * m.parameters.max_isometric_force_N;
      const std::vector<double> a = data::evaluate_at(signal(activation, "curl", m.name), time);
      strength += f0;
      for (std::size_t k = 0; k < time.size(); ++k)
        sum[k] += f.samples[k] * r.samples[k], mean[k] += f0 * a[k];
    }
    q = data::evaluate_at(angle, time);
    for (std::size_t k = 0; k < time.size(); ++k) {
      const double away = std::abs(q[k] / degree - t.numbers("angle_deg")[i]) +
                          std::abs(mean[k] / strength - t.numbers("activation")[i]);
      if (away < nearest) nearest = away, moment = sum[k];
    }
    EXPECT_LT(nearest, 1e-9);
    EXPECT_NEAR(t.numbers("reference_N_m")[i], moment, 1e-9 * std::abs(moment));
  }
  const data::Table& agreement = fitted.tables.at("agreement");
  EXPECT_GT(agreement.numbers("rms_N_m")[0], 0.0);
  EXPECT_TRUE(std::isnan(agreement.numbers("rms_N")[0]));
}

std::vector<optimise::ReferenceForce> read(const std::string& reference) {
  const StageSpec& spec = *catalogue().find("optimise.muscle_forces");
  return reference_forces(options_from_text(limb_options() + "reference = [" + reference + "]\n", spec),
                          "biceps");
}

std::string mistake(const std::string& reference) {
  try {
    read(reference);
  } catch (const data::InputError& e) {
    return data::render(e.diagnostics());
  }
  return {};
}

TEST(MuscleForceReferences, ComeFromColumnsOfAFile) {
  const auto file = brachium::tests::scratch_dir() / "forces.csv";
  std::ofstream(file) << "# as published\ntheta_deg,alpha,FB_N\n10,0.5,-300\n141.25,0.5,-40\n";
  const auto forces =
      read("{ muscle = \"biceps\", set = \"samples\", file = \"" + file.string() +
           "\", angle_column = \"theta_deg\", activation_column = \"alpha\", force_column = \"FB_N\", "
           "factor = -1, not_fitted = [141.25, 0.5] }");
  ASSERT_EQ(forces.size(), 2u);
  EXPECT_NEAR(forces[0].q_rad, 10.0 * degree, 1e-15);
  EXPECT_EQ(forces[0].value, 300.0);
  EXPECT_EQ(forces[0].weight, 1.0);
  EXPECT_EQ(forces[1].weight, 0.0);
}

TEST(MuscleForceReferences, MayBeMomentsOfEitherSign) {
  const auto moments = read(
      "{ muscle = \"biceps\", set = \"held\", activation = 0.3, angle_deg = [10, 20], moment_N_m = [5, -1] "
      "}");
  ASSERT_EQ(moments.size(), 2u);
  EXPECT_EQ(moments[1].value, -1.0);
  EXPECT_EQ(moments[1].measure, optimise::Measure::moment);
}

TEST(MuscleForceReferences, AreToldTheirMistakes) {
  const std::string head = "{ muscle = \"biceps\", set = \"passive\", ";
  EXPECT_THAT(mistake(head + "activation = 0, angle_deg = [10, 20], force_N = [1] }"),
              HasSubstr("1 forces are given for 2 angles"));
  EXPECT_THAT(mistake(head + "activation = 0, angle_deg = [10] }"), HasSubstr("contradiction"));
  EXPECT_THAT(mistake(head + "activation = 0, angle_deg = [10], force_N = [1], moment_N_m = [1] }"),
              HasSubstr("contradiction"));
  EXPECT_THAT(mistake(head + "angle_deg = [10], force_N = [1] }"), HasSubstr("`activation` is missing"));
  EXPECT_THAT(mistake(head + "activation = 0, angle_deg = [10], force_N = [-1] }"), HasSubstr("tensions"));
  EXPECT_THAT(
      mistake("{ muscle = \"triceps\", set = \"passive\", activation = 0, angle_deg = [10], force_N = [1] }"),
      IsEmpty());
}

}  // namespace
}  // namespace brachium::pipelines::tests
