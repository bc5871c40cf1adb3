// What each stage says of recordings, scenes and options it cannot use. The readers' own messages are pinned in tests/data.

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

/// The recordings with something done to one signal of one trial.
StageData with_signal(const std::string& trial, const std::string& name,
                      const std::function<void(data::Signal&)>& change) {
  return changed(recordings(), [&](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals)
        if (t.name == trial && s.info.name == name) change(s);
  });
}

std::string envelope_error(const StageData& session, const std::string& options = "",
                           const std::vector<std::string>& trials = {"curl"}) {
  return error_of([&] { run("emg.envelope", options, {{"signals", {&session}}}, trials); });
}

TEST(BadInput, AChannelThatDrivesAMuscleButIsNotRecordedIsNamed) {
  const StageData less = changed(truth(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      std::erase_if(t.signals, [](const data::Signal& s) { return s.info.name == "brachialis"; });
  });
  EXPECT_THAT(error_of([&] {
                run("emg.activation", "", {{"excitation", {&less}}}, {"curl"});
              }),
              StartsWith("error[unmapped-channel]: muscle `BRA` is driven by channel `brachialis`, which is "
                         "not recorded\n"));
}

TEST(BadInput, SamplesThatAreNotFiniteAreCountedAndPlaced) {
  const StageData nan =
      with_signal("curl", "biceps", [](data::Signal& s) { s.samples[2000] = std::nan(""); });
  EXPECT_THAT(envelope_error(nan, "normalise = \"none\""),
              StartsWith("error[not-finite]: channel `biceps` of trial `curl` has 1 samples that are not "
                         "finite, the first, nan, at 1 s\n"));
  const StageData infinite = with_signal("curl", "joint_angle", [](data::Signal& s) {
    s.samples[100] = std::numeric_limits<double>::infinity();
  });
  EXPECT_EQ(
      error_of([&] {
        run("limb.kinematics", "", {{"signals", {&infinite}}}, {"curl"});
      }),
      "error[not-finite]: joint angle `joint_angle` of trial `curl` is not a finite number at sample 100 "
      "(0.5 s)\n"
      "  help: fill or cut the gap before\n");
  EXPECT_EQ(error_of([&] {
              run("limb.inverse_dynamics", "", {{"signals", {&infinite}}}, {"curl"});
            }),
            "error[not-finite]: trial `curl`: the elbow angle is not a finite number at sample 100 (0.5 s)\n"
            "  help: fill or cut the gap before\n");
  const StageData torque =
      with_signal("curl", "dynamometer_torque", [](data::Signal& s) { s.samples[100] = std::nan(""); });
  EXPECT_EQ(error_of([&] {
              run("limb.dynamometer", "", {{"signals", {&torque}}}, {"curl"});
            }),
            "error[non-finite-sample]: trial `curl`: signal `dynamometer_torque` has nan at 0.5 s\n");
}

TEST(BadInput, ASweepThatCannotShowGravityIsNamed) {
  const auto sweep_error = [](const std::string& options) {
    return error_of([&] {
      run("limb.dynamometer", "gravity = \"passive_sweep\"\n" + options, {{"signals", {&recordings()}}},
          {"curl"});
    });
  };
  EXPECT_EQ(
      sweep_error("sweep_trials = [\"ramp\"]"),
      "error[short-sweep]: trial `ramp`: the passive sweep covers 0 deg (75 to 75); the gravity fit needs "
      "40.1 deg\n"
      "  help: record a longer sweep, or take gravity from the limb's inertia\n");
  EXPECT_EQ(
      sweep_error("sweep_trials = [\"sweep\"]\nsweep_max_speed_deg_s = 1e-9"),
      "error[too-few-samples]: trial `sweep`: the passive sweep has 1 samples slower than 1e-09 deg/s; the "
      "gravity fit needs 10\n"
      "  help: record a slower sweep, or allow a higher speed\n");
}

TEST(BadInput, AChannelThatIsConstantInItsMvcCannotNormalise) {
  const StageData flat = with_signal(
      "mvc-1", "biceps", [](data::Signal& s) { std::fill(s.samples.begin(), s.samples.end(), 0.0); });
  EXPECT_THAT(envelope_error(flat), StartsWith("error[constant-channel]: the largest envelope of channel "
                                               "`biceps` is 0: there is nothing to normalise by\n"));
  EXPECT_THAT(
      error_of([&] {
        run("emg.quality", "on_bad = \"fail\"", {{"signals", {&flat}}}, {"mvc-1"});
      }),
      StartsWith(
          "error[bad-channel]: channel `biceps` of trial `mvc-1` is bad: constant: every sample is 0\n"));
}

TEST(BadInput, CutOffsAboveNyquistAreTold) {
  EXPECT_EQ(envelope_error(recordings(), "normalise = \"none\"\nhighpass_hz = 1200\nlowpass_hz = 1000"),
            "error[cutoff-above-nyquist]: `highpass_hz` = 1200 Hz is not below 1000 Hz, half the sampling "
            "rate of 2000 Hz\n"
            "error[cutoff-above-nyquist]: `lowpass_hz` = 1000 Hz is not below 1000 Hz, half the sampling "
            "rate of 2000 Hz\n");
  EXPECT_EQ(
      error_of([&] {
        run("limb.kinematics", "lowpass_hz = 100", {{"signals", {&recordings()}}}, {"curl"});
      }),
      "error[cutoff-above-nyquist]: the cut-off 100 Hz for joint angle `joint_angle` of trial `curl` must "
      "lie above 0 and below 0.45 of its rate 200 Hz\n");
}

TEST(BadInput, ATrialShorterThanItsFiltersNeedIsTold) {
  const StageData brief = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals) {
        if (t.name != "curl") continue;
        s.samples.resize(static_cast<std::size_t>(0.1 * s.info.rate_hz));
        s.info.count = s.samples.size();
      }
  });
  EXPECT_EQ(envelope_error(brief, "normalise = \"none\""),
            "error[trial-too-short]: trial `curl` has 200 samples (0.1 s); its filters need at least 1126 "
            "(0.563 s)\n"
            "  help: a higher edge has a shorter transient; `trim_edges = false` keeps the ends\n");
  EXPECT_THAT(error_of([&] {
                run("emg.quality", "", {{"signals", {&brief}}}, {"curl"});
              }),
              StartsWith("error[trial-too-short]: channel `triceps_long` of trial `curl` has 0.1 s; judging "
                         "its quality needs 1 s\n"));
}

TEST(BadInput, AnAbsentMvcIsToldWithWhatElseCanBeDone) {
  const StageData none =
      changed(recordings(), [](data::Session& session) { session.trials[0].kind = data::TrialKind::test; });
  EXPECT_EQ(envelope_error(none),
            "error[mvc-absent]: stage `emg.envelope` normalises by maximum voluntary contractions, and no "
            "trial is of kind `mvc`\n"
            "  help: record one, name trials in `reference_trials`, or choose `normalise = "
            "\"trials_maximum\"` or `\"none\"` (the gain is then fitted)\n");
  const StageData partly = changed(recordings(), [](data::Session& session) {
    std::erase_if(session.trials[0].signals, [](const data::Signal& s) { return s.info.name == "biceps"; });
  });
  EXPECT_EQ(envelope_error(partly),
            "error[mvc-absent]: channel `biceps` of trial `curl` is in none of the reference trials\n"
            "  help: name trials that record it in `reference_trials`\n");
}

TEST(BadInput, AnAbsentRestIsToldWithWhatElseCanBeDone) {
  const StageData busy = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials) t.kind = data::TrialKind::test;
  });
  EXPECT_EQ(envelope_error(busy, "normalise = \"none\"\nsubtract_rest = true"),
            "error[rest-absent]: stage `emg.envelope` takes off the envelope at rest, and no trial is of "
            "kind `rest` or `passive`\n"
            "  help: record one, name trials in `rest_trials`, or set `subtract_rest = false`\n");
}

TEST(BadInput, ChannelsOfDifferentRatesAreNotConditionedTogether) {
  const StageData mixed = with_signal("curl", "biceps", [](data::Signal& s) { s.info.rate_hz = 1000.0; });
  EXPECT_THAT(
      envelope_error(mixed, "normalise = \"none\""),
      ::testing::AllOf(StartsWith("error[rate-mismatch]: EMG channels `"), HasSubstr("`biceps` (1000 Hz, "),
                       HasSubstr("of trial `curl` differ\n"),
                       HasSubstr("help: condition them in two stages, each with its own `channels`")));
}

TEST(BadInput, AnAngleSignalThatIsNoAngleIsTold) {
  const StageData volts = with_signal("curl", "joint_angle", [](data::Signal& s) {
    s.info.quantity = data::Quantity::other;
    s.info.unit = "V";
  });
  data::Scene scene = elbow();
  scene.coordinates[0].angle_signal = "joint_angle";
  EXPECT_EQ(
      error_of([&] {
        run("limb.kinematics", "", {{"signals", {&volts}}}, {"curl"}, scene);
      }),
      "error[wrong-quantity]: signal `joint_angle` of trial `curl` is meant as the angle of `elbow_flexion`, "
      "but it is other [V]\n"
      "  help: set quantity = \"joint_angle\" in the session description, or `angle_signal` in the scene\n");
}

TEST(BadInput, AnAbsentMomentIsTold) {
  const StageData none = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      std::erase_if(t.signals,
                    [](const data::Signal& s) { return s.info.quantity == data::Quantity::joint_moment; });
  });
  for (const char* stage : {"optimise.calibrate", "optimise.cross_validate"}) {
    EXPECT_EQ(error_of([&] {
                run(stage, "",
                    {{"excitation", {&truth()}}, {"kinematics", {&recordings()}}, {"moment", {&none}}},
                    {"ramp", "random-*"});
              }),
              "error[missing-moment]: trial `ramp` has no reference moment for `elbow_flexion`\n"
              "  help: add a stage limb.dynamometer or limb.inverse_dynamics, and wire `moment` to it\n");
  }
}

TEST(BadInput, AMomentThatDoesNotVaryIsTold) {
  const StageData flat = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals)
        if (s.info.quantity == data::Quantity::joint_moment)
          std::fill(s.samples.begin(), s.samples.end(), 12.5);
  });
  EXPECT_THAT(error_of([&] {
                run("optimise.calibrate", "",
                    {{"excitation", {&truth()}}, {"kinematics", {&recordings()}}, {"moment", {&flat}}},
                    {"ramp", "random-*"});
              }),
              StartsWith("error[zero-variance-moment]: the reference moment does not vary over the training "
                         "trials (constant 12.5 N m): no scale can be taken from it\n"));
}

TEST(BadInput, AnAngleOutsideTheGeometrysRangeIsNotExtrapolated) {
  EXPECT_EQ(error_of([&] {
              run("limb.kinematics", "angle_offset_deg = 80", {{"signals", {&recordings()}}}, {"ramp"});
            }),
            "error[angle-out-of-range]: `elbow_flexion` of trial `ramp` goes from 155.0 to 155.0 deg; the "
            "scene's geometry holds from 0.0 to 150.0 deg\n"
            "  help: widen `range_deg` with geometry that is valid there, check the angle's zero, or leave "
            "the trial out\n");
  // The muscle model refuses it too, should the angle come from elsewhere.
  const StageData bent = with_signal("curl", "joint_angle", [](data::Signal& s) { s.samples[500] = 3.0; });
  const StageData a = run("emg.activation", "", {{"excitation", {&truth()}}}, {"curl"});
  EXPECT_EQ(
      error_of([&] {
        run("hill.moment", "", {{"activation", {&a}}, {"kinematics", {&bent}}});
      }),
      "error[angle-out-of-range]: `elbow_flexion` of trial `curl` is 171.9 deg at 2.5 s; the scene's "
      "geometry holds from 0.0 to 150.0 deg\n"
      "  help: widen `range_deg` with geometry that is valid there, check the angle's zero, or leave the "
      "trial out\n");
}

TEST(BadInput, ParametersOutsideTheirDomainAreNamedWithTheirMuscle) {
  data::Scene scene = elbow();
  scene.muscles[5].parameters.optimal_fibre_length_m = -0.1;
  const StageData a = run("emg.activation", "", {{"excitation", {&truth()}}}, {"curl"});
  EXPECT_THAT(
      error_of([&] {
        run("hill.moment", "", {{"activation", {&a}}, {"kinematics", {&recordings()}}}, {"curl"}, scene);
      }),
      StartsWith("error[bad-parameter]: `optimal_fibre_length_m` of muscle `BRA` is -0.1\n"));
  scene = elbow();
  scene.muscles[5].activation.time_constant_1_s = 0.0;
  EXPECT_THAT(error_of([&] {
                run("emg.activation", "", {{"excitation", {&truth()}}}, {"curl"}, scene);
              }),
              HasSubstr("`BRA`"));
}

TEST(BadInput, ANegativeMassIsRefusedWhereTheMomentIsComputed) {
  data::Scene scene = elbow();
  scene.segments[0].mass_kg = -1.2;
  for (const char* stage : {"limb.inverse_dynamics", "limb.dynamometer"}) {
    const std::string said = error_of([&] {
      run(stage, "", {{"signals", {&recordings()}}}, {"curl"}, scene);
    });
    EXPECT_THAT(said, StartsWith("error[out-of-range]: ")) << stage;
    EXPECT_THAT(said, HasSubstr("`forearm`")) << stage;
    EXPECT_THAT(said, HasSubstr("-1.2")) << stage;
  }
}

TEST(BadInput, AnEnvelopeWithoutNormalisationOrGainIsNotAnExcitation) {
  const StageData volts = run("emg.envelope", "normalise = \"none\"\noutput_rate_hz = 200",
                              {{"signals", {&recordings()}}}, {"curl"});
  EXPECT_EQ(error_of([&] {
              run("emg.activation", "", {{"excitation", {&volts}}});
            }),
            "error[not-normalised]: the envelope of `triceps_long` in trial `curl` is in V, and there is no "
            "gain for it\n"
            "  help: normalise it in emg.envelope, or wire a calibrated subject with its gain\n");
}

TEST(BadInput, SignalsAndTrialsThatAreNotThereAreNamed) {
  const StageData silent = changed(recordings(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      std::erase_if(t.signals, [](const data::Signal& s) { return s.info.quantity == data::Quantity::emg; });
  });
  EXPECT_EQ(envelope_error(silent, "normalise = \"none\""),
            "error[missing-signal]: trial `curl` has no EMG channel to work on\n"
            "  help: no signal has the quantity `emg`: set it in the session description\n");
  const StageData one = run("emg.activation", "", {{"excitation", {&truth()}}}, {"curl", "ramp"});
  const StageData other = run("limb.kinematics", "", {{"signals", {&recordings()}}}, {"curl"});
  EXPECT_THAT(
      error_of([&] {
        run("hill.moment", "", {{"activation", {&one}}, {"kinematics", {&other}}});
      }),
      StartsWith("error[missing-trial]: the output of stage `limb.kinematics` has no trial `ramp`\n"));
}

TEST(BadInput, ASessionWithoutTrialsIsToldByEveryStage) {
  const StageData empty = session_data({});
  for (const char* stage : {"emg.quality", "emg.envelope", "emg.onset", "limb.kinematics",
                            "limb.inverse_dynamics", "limb.dynamometer"}) {
    EXPECT_THAT(error_of([&] {
                  run(stage, "", {{"signals", {&empty}}});
                }),
                StartsWith("error[no-match]: "))
        << stage;
    StageRequest request;
    request.inputs = {{"signals", {&empty}}};
    request.scene = &elbow();
    request.trials = {};
    EXPECT_EQ(error_of([&] { run_stage(*catalogue().find(stage), request); }),
              "error[no-trials]: `session` has no trials\n  help: check what it was made from\n")
        << stage;
  }
}

}  // namespace
}  // namespace brachium::pipelines::tests
