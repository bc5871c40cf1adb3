// fem.upper_limb: continuum muscles over recorded trials by surrogate and frame by frame; and what
// pipelines.compare makes of models that lack muscles, leave frames out, or tell their parts.

#include <gmock/gmock.h>

#include <numbers>

#include "pipelines/options.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

std::string limb() {
  return "limb = \"" + (brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml").string() +
         "\"\nmesh = { belly_cells = 4 }\n";
}

const StageData& activations() {
  static const StageData a =
      named(run("emg.activation", "", {{"excitation", {&truth()}}}, {"curl"}), "activation");
  return a;
}

const StageData& whole_map() {
  static const StageData map =
      named(run("fem.muscle_map", limb() + "angle_deg = [15, 60, 100, 125]\nactivation = [0, 0.5, 1]\n", {},
                {"*"}, elbow(), 2),
            "map");
  return map;
}

StageData driven(const std::string& options, const StageData& map, const StageData& activation,
                 const StageData& kinematics = recordings()) {
  return named(run("fem.upper_limb", options,
                   {{"activation", {&activation}}, {"kinematics", {&kinematics}}, {"map", {&map}}}, {"curl"}),
               "fe");
}

std::string error_of(const std::function<void()>& task) {
  try {
    task();
  } catch (const data::InputError& e) {
    return e.diagnostics().front().code + ": " + e.diagnostics().front().message;
  }
  return "no error";
}

/// The recordings with all angles stretched by a factor.
StageData turned(double factor) {
  return named(changed(recordings(),
                       [factor](data::Session& session) {
                         for (data::Trial& t : session.trials)
                           for (data::Signal& s : t.signals)
                             if (s.info.quantity == data::Quantity::joint_angle)
                               for (double& q : s.samples) q *= factor;
                       }),
               "turned");
}

TEST(UpperLimbStage, IsTheMapAtTheMeanActivationOfEachGroup) {
  const StageData fe = driven("", whole_map(), activations());
  const LimbMap map = limb_map_of(whole_map());
  const data::Signal angle = signal(fe, "curl", "elbow_flexion"),
                     moment = signal(fe, "curl", "elbow_flexion_moment");
  const data::Signal long_head = signal(activations(), "curl", "BIClong"),
                     short_head = signal(activations(), "curl", "BICshort");
  const auto strength = [&](const std::string& m) {
    return elbow().muscle(m).parameters.max_isometric_force_N;
  };
  const double share = strength("BIClong") / (strength("BIClong") + strength("BICshort"));
  const data::Signal biceps = signal(fe, "curl", "biceps"), triceps = signal(fe, "curl", "triceps");
  const auto first = static_cast<std::size_t>(
      std::lround((biceps.info.start_time_s - long_head.info.start_time_s) * biceps.info.rate_hz));
  for (std::size_t i = 0; i < biceps.samples.size(); i += 97) {
    EXPECT_NEAR(biceps.samples[i],
                share * long_head.samples[first + i] + (1.0 - share) * short_head.samples[first + i], 1e-12);
    double sum = 0.0;
    for (const MappedMuscle& m : map.muscles) {
      std::vector<fem::OutputValue> out(m.surrogate->outputs().size());
      m.surrogate->evaluate(angle.samples[i], (m.name == "biceps" ? biceps : triceps).samples[i], out);
      EXPECT_NEAR(signal(fe, "curl", m.name + "_force").samples[i], out[m.surrogate->output("force_n")].value,
                  1e-9);
      sum += out[m.surrogate->output("moment_n_m")].value;
    }
    EXPECT_NEAR(moment.samples[i], sum, 1e-9);
  }
  EXPECT_EQ(fe.attributes.at("left_out_muscles"), "BRA,BRD");
}

TEST(UpperLimbStage, PassiveMomentIsThatWithoutActivation) {
  const StageData rest = named(changed(activations(),
                                       [](data::Session& session) {
                                         for (data::Trial& t : session.trials)
                                           for (data::Signal& s : t.signals)
                                             if (s.info.quantity == data::Quantity::activation)
                                               s.samples.assign(s.samples.size(), 0.0);
                                       }),
                               "rest");
  const StageData fe = driven("", whole_map(), activations()), passive = driven("", whole_map(), rest);
  const data::Signal part = signal(fe, "curl", "elbow_flexion_moment_passive"),
                     whole = signal(passive, "curl", "elbow_flexion_moment");
  for (std::size_t i = 0; i < part.samples.size(); i += 50)
    EXPECT_NEAR(part.samples[i], whole.samples[i], 1e-9);
  EXPECT_GT(std::abs(part.samples[0] - signal(fe, "curl", "elbow_flexion_moment").samples[0]), 0.1);
}

TEST(UpperLimbStage, FramesSolvedOneByOneAreWhatTheMapLiesNear) {
  const StageData solved =
      run("fem.upper_limb", limb() + "decimate = 400\n",
          {{"activation", {&activations()}}, {"kinematics", {&recordings()}}}, {"curl"}, elbow(), 2);
  const StageData mapped = driven("decimate = 400\n", whole_map(), activations());
  const data::Signal a = signal(solved, "curl", "biceps_force"), b = signal(mapped, "curl", "biceps_force");
  ASSERT_EQ(a.samples.size(), b.samples.size());
  ASSERT_GE(a.samples.size(), 4u);
  EXPECT_NEAR(a.info.rate_hz, 0.5, 1e-12);
  for (std::size_t i = 0; i < a.samples.size(); ++i)
    EXPECT_NEAR(a.samples[i], b.samples[i], 0.05 * a.samples[i]) << i;
}

TEST(UpperLimbStage, RefusesAnglesBeyondTheMapNamingTrialAndTime) {
  const StageData wide = turned(1.2);  // to 144 deg
  EXPECT_THAT(error_of([&] { driven("", whole_map(), activations(), wide); }),
              AllOf(HasSubstr("outside-surrogate: trial `curl` at "),
                    HasSubstr("and muscles are known from 15 to 125 deg")));
}

TEST(UpperLimbStage, LeavesFramesOutWhereAskedMarksAndCountsThem) {
  const StageData wide = turned(1.2);
  const StageData fe = driven("outside_range = \"leave_out\"\n", whole_map(), activations(), wide);
  const data::Signal use = signal(fe, "curl", "use"), angle = signal(wide, "curl", "joint_angle");
  std::size_t out = 0;
  for (std::size_t i = 0; i < use.samples.size(); ++i) {
    const double q =
        angle.samples[i + static_cast<std::size_t>(std::lround(use.info.start_time_s * use.info.rate_hz))];
    EXPECT_EQ(use.samples[i] > 0.5, q >= 15.0 * degree && q <= 125.0 * degree) << i;
    out += use.samples[i] < 0.5;
  }
  EXPECT_GT(out, 100u);
  EXPECT_EQ(fe.tables.at("muscles").numbers("left_out")[0], static_cast<double>(out));
  EXPECT_EQ(fe.diagnostics.front().code, "frames-left-out");
  // Judged on the frames that both know.
  const StageData c =
      run("pipelines.compare", "", {{"reference", {&wide}}, {"models", {&wide, &fe}}}, {"curl"});
  const data::Table& scores = c.tables.at("scores");
  EXPECT_EQ(scores.numbers("frames")[0], scores.numbers("frames")[2]);
  EXPECT_LE(scores.numbers("frames")[0], static_cast<double>(use.samples.size() - out));
}

TEST(UpperLimbStage, TakesMusclesFromOnePlaceOnly) {
  EXPECT_THAT(error_of([&] { driven(limb(), whole_map(), activations()); }), HasSubstr("contradiction: "));
  EXPECT_THAT(error_of([&] {
                run("fem.upper_limb", "", {{"activation", {&activations()}}, {"kinematics", {&recordings()}}},
                    {"curl"});
              }),
              HasSubstr("missing-key: "));
  EXPECT_THAT(error_of([&] {
                run("fem.upper_limb", limb() + "lever_arm = \"tdm\"\n",
                    {{"activation", {&activations()}}, {"kinematics", {&recordings()}}}, {"curl"});
              }),
              HasSubstr("contradiction: the lever arm by tendon displacement"));
}

TEST(CompareParts, WhatAModelLacksIsToldByTheOther) {
  const StageData fim = named(
      run("hill.moment", "", {{"activation", {&activations()}}, {"kinematics", {&recordings()}}}, {"curl"}),
      "fim");
  StageData some = fim;  // the same muscles without one
  some = named(changed(fim,
                       [](data::Session& session) {
                         for (data::Trial& t : session.trials) {
                           const auto of = [&](const std::string& name) -> data::Signal& {
                             return *std::find_if(t.signals.begin(), t.signals.end(),
                                                  [&](const data::Signal& s) { return s.info.name == name; });
                           };
                           for (std::size_t i = 0; i < of("BRA_force").samples.size(); ++i)
                             of("elbow_flexion_moment").samples[i] -=
                                 of("BRA_force").samples[i] * of("BRA_moment_arm").samples[i];
                         }
                       }),
               "some");
  some.attributes["left_out_muscles"] = "BRA";
  const StageData c = run("pipelines.compare", "",
                          {{"reference", {&fim}},
                           {"models", {&fim, &some}},
                           {"kinematics", {&recordings()}},
                           {"activation", {&activations()}}},
                          {"curl"});
  const data::Table& same = c.tables.at("same_muscles");
  ASSERT_EQ(same.rows(), 1u);
  EXPECT_LT(same.numbers("rmse_N_m")[0], 1e-9) << "without that muscle both are the same";
  EXPECT_NEAR(same.numbers("missing_rms_N_m")[0], c.tables.at("scores").numbers("rmse_N_m")[2], 1e-9)
      << "and it is all that differs";
  const data::Table& muscles = c.tables.at("muscles");
  double shares = 0.0;
  for (std::size_t k = 0; k < muscles.rows(); ++k) {
    if (muscles.texts("model")[k] != "fim") continue;
    shares += muscles.numbers("share_of_rms")[k];
    EXPECT_EQ(muscles.texts("in_continuum_model")[k], muscles.texts("muscle")[k] == "BRA" ? "no" : "yes");
  }
  EXPECT_NEAR(shares, 1.0, 1e-12);
  // Bias over the angle is that of all frames, weighted by their number.
  const data::Table& bias = c.tables.at("bias_by_angle");
  double frames = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < bias.rows(); ++k) {
    if (bias.texts("model")[k] != "some") continue;
    frames += bias.numbers("frames")[k];
    sum += bias.numbers("frames")[k] * bias.numbers("bias_N_m")[k];
  }
  EXPECT_EQ(frames, c.tables.at("scores").numbers("frames")[2]);
  EXPECT_NEAR(sum / frames, c.tables.at("scores").numbers("bias_N_m")[2], 1e-9);
  EXPECT_TRUE(c.tables.contains("bias_by_activation"));
  const data::Table& parts = c.tables.at("parts");
  EXPECT_NEAR(
      parts.numbers("mean_N_m")[0] + parts.numbers("mean_N_m")[1],
      [&] {
        double m = 0.0;
        const auto s = signal(c, "curl", "fim").samples;
        for (double v : s) m += v / static_cast<double>(s.size());
        return m;
      }(),
      1e-9);
  EXPECT_NEAR(parts.numbers("rmse_N_m")[3], 0.0, 1e-12) << "the passive parts are the same signal";
}

TEST(CompareParts, LimitsOfAgreementAreThoseOfTheDifferences) {
  const StageData model = named(changed(recordings(),
                                        [](data::Session& session) {
                                          for (data::Trial& t : session.trials)
                                            for (data::Signal& s : t.signals)
                                              if (s.info.name == "joint_moment")
                                                for (std::size_t i = 0; i < s.samples.size(); ++i)
                                                  s.samples[i] += 0.5 + (i % 2 == 0 ? 0.2 : -0.2);
                                        }),
                                "model");
  const StageData c =
      run("pipelines.compare", "", {{"reference", {&recordings()}}, {"models", {&model}}}, {"curl"});
  const data::Table& scores = c.tables.at("scores");
  const double n = scores.numbers("frames")[0], bias = scores.numbers("bias_N_m")[0];
  const double square = 0.29 + 0.2 * (bias - 0.5) / 0.2,
               deviation = std::sqrt((square - bias * bias) * n / (n - 1.0));
  EXPECT_NEAR(scores.numbers("upper_limit_N_m")[0], bias + 1.96 * deviation, 1e-9);
  EXPECT_NEAR(scores.numbers("lower_limit_N_m")[0], bias - 1.96 * deviation, 1e-9);
}

}  // namespace
}  // namespace brachium::pipelines::tests
