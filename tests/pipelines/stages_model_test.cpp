// Muscle model, calibration, cross-validation and comparison as stages, against the twin's truth.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "pipelines/stages/calibration_options.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

const StageData& true_activation() {
  static const StageData data = named(
      run("emg.activation", "", {{"excitation", {&truth()}}}, {"ramp", "random-*", "curl"}), "activation");
  return data;
}

// ---------------------------------------------------------------- hill.moment

TEST(MomentStage, OfTrueActivationsAndParametersIsTheTwinsMoment) {
  const StageData m =
      run("hill.moment", "", {{"activation", {&true_activation()}}, {"kinematics", {&recordings()}}});
  EXPECT_EQ(m.attributes.at("rung"), "hill.rigid");
  for (const char* trial : {"ramp", "random-1", "random-2", "curl"}) {
    EXPECT_LT(largest_difference(signal(m, trial, "elbow_flexion_moment").samples,
                                 signal(recordings(), trial, "joint_moment").samples),
              1e-9)
        << trial;
    EXPECT_LT(largest_difference(signal(m, trial, "BRA_force").samples,
                                 signal(truth(), trial, "BRA.force").samples),
              1e-7)
        << trial;
  }
}

TEST(MomentStage, IsTheSumOfForceTimesMomentArm) {
  const StageData m = run("hill.moment", "tendon = \"elastic\"",
                          {{"activation", {&true_activation()}}, {"kinematics", {&recordings()}}}, {"curl"});
  EXPECT_EQ(m.attributes.at("rung"), "hill.elastic");
  std::vector<double> sum(signal(m, "curl", "elbow_flexion_moment").samples.size(), 0.0);
  for (const data::SceneMuscle& muscle : elbow().muscles) {
    const std::vector<double> force = signal(m, "curl", muscle.name + "_force").samples,
                              arm = signal(m, "curl", muscle.name + "_moment_arm").samples;
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += force[i] * arm[i];
  }
  EXPECT_LT(largest_difference(sum, signal(m, "curl", "elbow_flexion_moment").samples), 1e-10);
}

TEST(MomentStage, ALongTrialInPiecesIsTheShortOneOverAndOver) {
  constexpr std::size_t period = 1000, count = 300000;
  const auto repeated = [](const StageData& data) {
    return changed(data, [](data::Session& session) {
      std::erase_if(session.trials, [](const data::Trial& t) { return t.name != "curl"; });
      for (data::Signal& s : session.trials[0].signals) {
        ASSERT_EQ(s.info.rate_hz, 200.0);
        ASSERT_EQ(s.info.start_time_s, 0.0);
        std::vector<double> all(count);
        for (std::size_t i = 0; i < count; ++i) all[i] = s.samples[i % period];
        s.samples = std::move(all);
        s.info.count = count;
      }
    });
  };
  const StageData kinematics =
      run("limb.kinematics", "lowpass_hz = 0", {{"signals", {&recordings()}}}, {"curl"});
  const StageData activation = repeated(true_activation()), motion = repeated(kinematics);
  const StageData longer =
      run("hill.moment", "", {{"activation", {&activation}}, {"kinematics", {&motion}}}, {"curl"});
  const std::vector<double> whole = signal(longer, "curl", "elbow_flexion_moment").samples;
  ASSERT_EQ(whole.size(), count);
  for (std::size_t i = period; i < count; ++i)
    ASSERT_NEAR(whole[i], whole[i % period], 1e-9 * std::abs(whole[i % period]) + 1e-9) << i;
  EXPECT_EQ(longer.tables.at("muscles").rows(), elbow().muscles.size());
}

TEST(MomentStage, ASubjectsStrengthScalesTheMoment) {
  StageData subject = subject_data();
  for (data::SubjectMuscle& m : subject.subject->muscles) m.parameters.strength = 1.25;
  const StageData m =
      run("hill.moment", "",
          {{"activation", {&true_activation()}}, {"kinematics", {&recordings()}}, {"subject", {&subject}}},
          {"curl"});
  const std::vector<double> a = signal(m, "curl", "elbow_flexion_moment").samples,
                            b = signal(recordings(), "curl", "joint_moment").samples;
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], 1.25 * b[i], 1e-9);
}

TEST(MomentStage, ActivationsBeyondOneAreCountedOrRefused) {
  const StageData loud = changed(true_activation(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals)
        if (s.info.name == "BRA") s.samples[100] = 1.2;
  });
  const Inputs inputs = {{"activation", {&loud}}, {"kinematics", {&recordings()}}};
  const StageData m = run("hill.moment", "", inputs, {"curl"});
  ASSERT_EQ(m.diagnostics.size(), 1u);
  EXPECT_EQ(m.diagnostics[0].message,
            "1 activation samples outside [0, 1] were brought to its ends before the muscle model");
  EXPECT_EQ(error_of([&] { run("hill.moment", "outside_activation = \"fail\"", inputs, {"curl"}); }),
            "error[activation-range]: activation of `BRA` in trial `curl` is 1.2000, above 1\n"
            "  help: the maximum contraction was not maximal; choose `outside_activation = \"clamp\"` to "
            "count and clamp such samples\n");
}

// ---------------------------------------------------------------- optimise.calibrate

/// The scene a calibration starts from: other strengths, slack lengths, delay and shape.
data::Scene disturbed() {
  data::Scene scene = elbow();
  for (data::SceneMuscle& m : scene.muscles) {
    m.parameters.strength = 0.8;
    m.parameters.tendon_slack_length_m *= 1.02;
    m.activation.delay_s = 0.055;
    m.activation.shape = -0.9;
  }
  return scene;
}

const std::string exact =
    "excitation_cv = 0.0\ncorrect_bias = false\nnoise_replicates = 4\nedge_s = 0.1\ndecimate = 4\n";
const std::string free_without_priors =
    "free = [ { parameter = \"strength\", scope = \"group\" }, { parameter = \"tendon_slack_length\", scope "
    "= \"group\", relative = true },"
    " { parameter = \"shape\", scope = \"global\" }, { parameter = \"delay\", scope = \"global\" } ]\n";
const std::vector<std::string> learning = {"ramp", "random-*", "curl"};

Inputs calibration_inputs() {
  return {{"excitation", {&truth()}}, {"kinematics", {&recordings()}}, {"moment", {&recordings()}}};
}

TEST(CalibrateStage, WithoutNoiseFindsTheTwinsParameters) {
  const StageData c =
      run("optimise.calibrate", exact + free_without_priors, calibration_inputs(), learning, disturbed());
  ASSERT_TRUE(c.subject.has_value());
  for (const data::SceneMuscle& m : elbow().muscles) {
    const data::SubjectMuscle& found = c.subject->muscle(m.name);
    EXPECT_NEAR(found.parameters.strength, 1.0, 1e-6) << m.name;
    EXPECT_NEAR(found.parameters.tendon_slack_length_m / m.parameters.tendon_slack_length_m, 1.0, 1e-6)
        << m.name;
    EXPECT_NEAR(found.activation.delay_s, m.activation.delay_s, 1e-6);
    EXPECT_NEAR(found.activation.shape, m.activation.shape, 1e-6);
  }
  for (const std::string& verdict : c.tables.at("verdicts").texts("verdict"))
    EXPECT_EQ(verdict, "identified");
  EXPECT_EQ(c.subject->provenance.at("trials"),
            "ramp,random-1,random-2");  // kind `calibration`: not the test trial
  EXPECT_LT(c.tables.at("training").numbers("rmse_N_m")[0], 1e-5);
}

TEST(CalibrateStage, FindingsNameParametersInWords) {
  data::Subject subject;
  subject.verdicts.resize(2);
  subject.verdicts[0].muscle = "biceps";
  subject.verdicts[0].parameter = "tendon_slack_length_factor";
  subject.verdicts[0].unit = "1";
  subject.verdicts[1].muscle = "*";
  subject.verdicts[1].parameter = "delay_s";
  subject.verdicts[1].unit = "s";
  StageOutput out;
  add_calibration_findings(
      {{data::Severity::warning,
        "not-identified",
        "`biceps tendon_slack_length_factor` is NOT IDENTIFIED: correlated 0.98 with * delay_s",
        {},
        {}}},
      subject, out);
  EXPECT_EQ(out.diagnostics[0].message,
            "`biceps tendon slack length factor` is NOT IDENTIFIED: correlated 0.98 with common delay");
}

TEST(CalibrateStage, ScalingByTheTrainingMaximumBelongsToTheGains) {
  const std::string options =
      exact +
      "free = [ { parameter = \"gain\", scope = \"channel\", lower = 0.01, upper = 2.0 } "
      "]\nnormalise_by_training_maximum = true\nlinear_strength_first = false\n";
  const StageData c = run("optimise.calibrate", options, calibration_inputs(), learning);
  for (const auto& [channel, gain] : c.subject->channel_gains) EXPECT_NEAR(gain, 1.0, 1e-6) << channel;
  const StageData a = run("emg.activation", "", {{"excitation", {&truth()}}, {"subject", {&c}}}, {"curl"});
  EXPECT_LT(
      largest_difference(signal(a, "curl", "BRA").samples, signal(truth(), "curl", "BRA.activation").samples),
      1e-6);
}

// ---------------------------------------------------------------- optimise.cross_validate

const std::string folds = exact + free_without_priors;

TEST(CrossValidateStage, JudgesEveryTrialOnceBesideItsBaselines) {
  const StageData v = run("optimise.cross_validate", folds, calibration_inputs(), learning, disturbed());
  for (const char* table :
       {"scores", "pooled", "residuals", "stability", "fold_01", "fold_02", "fold_03", "fold_04"})
    EXPECT_TRUE(v.tables.contains(table)) << table;
  const data::Table& pooled = v.tables.at("pooled");
  EXPECT_THAT(pooled.texts("model"), ::testing::SizeIs(4));
  EXPECT_LT(pooled.numbers("rmse_N_m")[0], 1e-4);  // noise-free: the model is the truth
  for (std::size_t m = 1; m < 4; ++m) EXPECT_GT(pooled.numbers("rmse_N_m")[m], 0.1);
  for (const data::TrialInfo& t : v.signals->info().trials) {
    EXPECT_TRUE(t.has_signal("reference")) << t.name;
    EXPECT_TRUE(t.has_signal("muscle_model")) << t.name;
  }
  double frames = 0.0;
  for (std::size_t row = 0; row < v.tables.at("residuals").rows(); ++row)
    if (v.tables.at("residuals").texts("by")[row] == "phase")
      frames += v.tables.at("residuals").numbers("frames")[row];
  EXPECT_EQ(frames, pooled.numbers("frames")[0]);
  EXPECT_THAT(v.attributes.at("verdict"),
              HasSubstr("On trials the calibration never saw: muscle model R2 1.000, RMSE 0.00 N m;"));
  EXPECT_EQ(v.attributes.at("verdict_tone"), "good");
}

TEST(CrossValidateStage, NothingOfAHeldOutTrialReachesItsFold) {
  const StageData wrong = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      if (t.name == "curl")
        for (data::Signal& s : t.signals)
          if (s.info.name == "joint_moment")
            for (double& v : s.samples) v = 3.0 - 2.0 * v;
  });
  Inputs inputs = calibration_inputs();
  const std::string options = folds + "hold_out = [\"curl\"]\n";
  const StageData good = run("optimise.cross_validate", options, inputs, learning, disturbed());
  inputs["moment"] = {&wrong};
  const StageData bad = run("optimise.cross_validate", options, inputs, learning, disturbed());
  EXPECT_EQ(good.tables.at("fold_01").numbers("fitted"), bad.tables.at("fold_01").numbers("fitted"));
  std::size_t models = 0;
  for (const data::SignalInfo& model : good.signals->info().trials.back().signals) {
    if (model.name == "reference") continue;
    ++models;
    // Kept as reference plus residual, hence the rounding.
    EXPECT_LT(
        largest_difference(signal(good, "curl", model.name).samples, signal(bad, "curl", model.name).samples),
        1e-12)
        << model.name;
  }
  EXPECT_EQ(models, 4u);
  EXPECT_GT(bad.tables.at("pooled").numbers("rmse_N_m")[0],
            1.0);  // the wrong moment is seen by the judge alone
}

// ---------------------------------------------------------------- pipelines.compare

TEST(CompareStage, AModelThatIsTheReferenceHasNoError) {
  const StageData model = named(changed(recordings(), [](data::Session&) {}), "model");
  const StageData c = run("pipelines.compare", "", {{"reference", {&recordings()}}, {"models", {&model}}},
                          {"random-*", "curl"});
  const data::Table& scores = c.tables.at("scores");
  for (std::size_t row = 0; row < scores.rows(); ++row) {
    EXPECT_LT(scores.numbers("rmse_N_m")[row], 1e-13);  // interpolated at its own time stamps
    EXPECT_DOUBLE_EQ(scores.numbers("r2")[row], 1.0);
    EXPECT_EQ(scores.texts("seen_in_calibration")[row], "no");
  }
  EXPECT_THAT(c.attributes.at("verdict"),
              HasSubstr("gainst `recordings`: `model` R2 1.000, RMSE 0.00 N m (0.0 % of the range)"));
}

TEST(CompareStage, AConstantErrorIsItsOwnRmseAndBias) {
  const StageData model = named(changed(recordings(),
                                        [](data::Session& session) {
                                          for (data::Trial& t : session.trials)
                                            for (data::Signal& s : t.signals)
                                              if (s.info.name == "joint_moment")
                                                for (double& v : s.samples) v += 0.5;
                                        }),
                                "model");
  const StageData c = run("pipelines.compare", "edge_s = 1.0",
                          {{"reference", {&recordings()}}, {"models", {&model}}}, {"curl"});
  EXPECT_NEAR(c.tables.at("scores").numbers("rmse_N_m")[0], 0.5, 1e-12);
  EXPECT_NEAR(c.tables.at("scores").numbers("bias_N_m")[0], 0.5, 1e-12);
  EXPECT_EQ(c.tables.at("scores").numbers("frames")[0], 1201.0);  // from 1 s to 7 s at 200 Hz, both included
}

TEST(CompareStage, AgainstAConstantReferenceR2IsSaidToBeNotDefined) {
  const auto constant = [](double value) {
    return changed(recordings(), [value](data::Session& session) {
      for (data::Trial& t : session.trials)
        for (data::Signal& s : t.signals)
          if (s.info.name == "joint_moment") s.samples.assign(s.samples.size(), value);
    });
  };
  const StageData hold = named(constant(12.0), "hold"), model = named(constant(12.5), "model");
  const StageData c = run("pipelines.compare", "", {{"reference", {&hold}}, {"models", {&model}}}, {"curl"});
  EXPECT_TRUE(std::isnan(c.tables.at("scores").numbers("r2")[0]));
  EXPECT_TRUE(std::isnan(c.tables.at("scores").numbers("nrmse_range")[1]));
  EXPECT_THAT(c.attributes.at("verdict"), HasSubstr("`model` R2 not defined, RMSE 0.50 N m"));
}

TEST(CompareStage, AModelMayBeCalledReference) {
  const StageData model = named(changed(recordings(), [](data::Session&) {}), "reference");
  const StageData c =
      run("pipelines.compare", "", {{"reference", {&recordings()}}, {"models", {&model}}}, {"curl"});
  EXPECT_EQ(signal(c, "curl", "reference_model").samples.size(),
            signal(c, "curl", "reference").samples.size());
  EXPECT_EQ(c.tables.at("scores").texts("model")[0], "reference");
}

TEST(CompareStage, TrialsThatTheCalibrationHasSeenAreFlaggedAndNotJudged) {
  StageData subject = subject_data();
  subject.subject->provenance["trials"] = "random-1,ramp";
  const StageData model = named(changed(recordings(), [](data::Session&) {}), "model");
  const StageData c =
      run("pipelines.compare", "",
          {{"reference", {&recordings()}}, {"models", {&model}}, {"subject", {&subject}}}, {"random-*"});
  const data::Table& scores = c.tables.at("scores");
  EXPECT_EQ(scores.texts("seen_in_calibration"), (std::vector<std::string>{"yes", "no", "no"}));
  EXPECT_EQ(scores.texts("trial")[2], "all unseen trials");
  EXPECT_EQ(scores.numbers("frames")[2], scores.numbers("frames")[1]);
  ASSERT_EQ(c.diagnostics.size(), 1u);
  EXPECT_EQ(c.diagnostics[0].code, "trained-and-judged");
}

// ---------------------------------------------------------------- threads

void expect_same(const StageData& a, const StageData& b) {
  const data::Session x = session_of(a), y = session_of(b);
  ASSERT_EQ(x.trials.size(), y.trials.size());
  for (std::size_t t = 0; t < x.trials.size(); ++t) {
    ASSERT_EQ(x.trials[t].name, y.trials[t].name);
    ASSERT_EQ(x.trials[t].signals.size(), y.trials[t].signals.size());
    for (std::size_t s = 0; s < x.trials[t].signals.size(); ++s) {
      EXPECT_EQ(x.trials[t].signals[s].info.name, y.trials[t].signals[s].info.name);
      EXPECT_EQ(x.trials[t].signals[s].samples, y.trials[t].signals[s].samples)
          << x.trials[t].name << " " << x.trials[t].signals[s].info.name;
    }
  }
  ASSERT_EQ(a.tables.size(), b.tables.size());
  for (const auto& [name, table] : a.tables) {
    const data::Table& other = b.tables.at(name);
    ASSERT_EQ(table.columns.size(), other.columns.size());
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      EXPECT_EQ(table.columns[c].values, other.columns[c].values) << name << " " << table.columns[c].name;
  }
  std::map<std::string, std::string> said = a.attributes, other = b.attributes;
  said.erase("summary"), other.erase("summary");  // tells the time it took
  EXPECT_EQ(said, other);
  EXPECT_EQ(data::render(a.diagnostics), data::render(b.diagnostics));
}

TEST(Stages, ResultsDoNotDependOnTheNumberOfThreads) {
  const StageData a = run("emg.activation", "", {{"excitation", {&truth()}}}, learning);
  const StageData b = run("emg.activation", "", {{"excitation", {&truth()}}}, learning, elbow(), 3);
  expect_same(a, b);
  const auto both = [&](const std::string& stage, const std::string& options, const Inputs& inputs,
                        const std::vector<std::string>& trials = learning) {
    SCOPED_TRACE(stage);
    expect_same(run(stage, options, inputs, trials, disturbed(), 1),
                run(stage, options, inputs, trials, disturbed(), 3));
  };
  const Inputs session = {{"signals", {&recordings()}}};
  both("emg.quality", "", session);
  both("emg.envelope", "output_rate_hz = 200", session, {"*-1", "curl", "weak"});
  both("emg.onset", "", session);
  both("limb.kinematics", "", session);
  both("limb.inverse_dynamics", "", session);
  both("limb.dynamometer", "gravity = \"passive_sweep\"", session);
  both("hill.moment", "", {{"activation", {&a}}, {"kinematics", {&recordings()}}});
  both("optimise.calibrate", exact + free_without_priors, calibration_inputs());
  both("optimise.cross_validate", folds, calibration_inputs());
}

}  // namespace
}  // namespace brachium::pipelines::tests
