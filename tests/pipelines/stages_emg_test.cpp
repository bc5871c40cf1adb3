// The EMG stages on a synthetic session: what they keep, leave out, scale and say.

#include <gmock/gmock.h>

#include <algorithm>

#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> moving = {"mvc-1", "weak", "ramp", "random-*", "curl"};

/// The recordings with the biceps clipped in one trial.
StageData clipped() {
  return changed(recordings(), [](data::Session& session) {
    for (data::Trial& trial : session.trials) {
      if (trial.name != "random-1") continue;
      for (data::Signal& s : trial.signals) {
        if (s.info.name != "biceps") continue;
        const double limit = 0.2 * *std::max_element(s.samples.begin(), s.samples.end());
        for (double& v : s.samples) v = std::clamp(v, -limit, limit);
      }
    }
  });
}

TEST(TwinStage, GivesTheSameSessionForTheSameSeedAndItsTruthBesideIt) {
  const StageData again = run("twin.session", protocol);
  EXPECT_EQ(signal(again, "curl", "biceps").samples, signal(recordings(), "curl", "biceps").samples);
  EXPECT_EQ(signal(truth(), "curl", "joint_moment").samples,
            signal(recordings(), "curl", "joint_moment").samples);
  EXPECT_EQ(again.tables.at("truth").texts("muscle").size(), elbow().muscles.size());
  EXPECT_EQ(again.tables.at("truth").numbers("tendon_slack_length_m").front(),
            elbow().muscles.front().parameters.tendon_slack_length_m);
  EXPECT_EQ(recordings().signals->info().trials[0].kind, data::TrialKind::mvc);
  EXPECT_EQ(signal(recordings(), "curl", "biceps").info.unit, "V");
}

TEST(TwinStage, WithoutRawEmgKeepsMotionAndMomentOnly) {
  const StageData bare = run("twin.session", protocol + "raw_emg = false\n");
  for (const data::SignalInfo& s : bare.signals->info().trials.back().signals)
    EXPECT_NE(s.quantity, data::Quantity::emg) << s.name;
  EXPECT_EQ(signal(bare, "curl", "joint_angle").samples, signal(recordings(), "curl", "joint_angle").samples);
}

TEST(QualityStage, WarnsExcludesOrFailsAsTold) {
  const StageData session = clipped();
  const Inputs input = {{"signals", {&session}}};
  const StageData warned = run("emg.quality", "on_bad = \"warn\"", input, {"random-*"});
  EXPECT_EQ(warned.attributes.at("bad_channels"), "1");
  EXPECT_EQ(warned.attributes.at("excluded_channels"), "");
  ASSERT_EQ(warned.diagnostics.size(), 1u);
  EXPECT_EQ(warned.diagnostics[0].severity, data::Severity::warning);
  EXPECT_THAT(warned.diagnostics[0].message,
              HasSubstr("channel `biceps` of trial `random-1` is bad: clipping"));
  EXPECT_EQ(warned.tables.at("quality").rows(), 10u);  // two trials of five channels

  const StageData without = run("emg.quality", "on_bad = \"exclude\"", input, {"random-*"});
  EXPECT_EQ(without.attributes.at("excluded_channels"), "biceps");
  EXPECT_THAT(error_of([&] { run("emg.quality", "on_bad = \"fail\"", input, {"random-*"}); }),
              HasSubstr("error[bad-channel]: channel `biceps` of trial `random-1` is bad: clipping"));
}

TEST(QualityStage, ThresholdsAreThoseOfTheOptions) {
  const Inputs input = {{"signals", {&recordings()}}};
  const auto bad = [&](const std::string& options) {
    return run("emg.quality", options, input, {"curl"}).attributes.at("bad_channels");
  };
  const std::string lax = "median_high_hz = 450.0\n";
  EXPECT_EQ(bad(lax + "snr_db = 0.0"), "0");
  // Each threshold set where no recording can meet it: all five channels are bad, and the reason is its own.
  for (const auto& [option, reason] : std::vector<std::pair<std::string, std::string>>{
           {lax + "snr_db = 200.0", "dB above rest (limit 200 dB)"},
           {lax + "snr_db = 0.0\nline_ratio = 1e-9", "line"},
           {lax + "snr_db = 0.0\nbaseline_drift = 1e-9", "drift"},
           {"snr_db = 0.0\nmedian_low_hz = 450.0\nmedian_high_hz = 460.0", "surface EMG (450-460 Hz)"}}) {
    EXPECT_EQ(bad(option), "5") << option;
    for (const data::Diagnostic& d : run("emg.quality", option, input, {"curl"}).diagnostics)
      EXPECT_THAT(d.message, HasSubstr(reason));
  }
}

TEST(QualityStage, AChannelExcludedByNameMustExist) {
  const Inputs input = {{"signals", {&recordings()}}};
  EXPECT_EQ(
      run("emg.quality", "exclude = [\"brachialis\"]", input, {"curl"}).attributes.at("excluded_channels"),
      "brachialis");
  EXPECT_EQ(error_of([&] { run("emg.quality", "exclude = [\"bicpes\"]", input, {"curl"}); }),
            "error[no-match]: no EMG channel matches `bicpes`\n  help: did you mean `biceps`?\n");
}

TEST(QualityStage, RestIsNotJudgedByItsActivity) {
  const StageData quality = run("emg.quality", "", {{"signals", {&recordings()}}}, {"sweep"});
  for (const data::Diagnostic& d : quality.diagnostics)
    EXPECT_EQ(d.message.find("SNR"), std::string::npos) << d.message;
}

TEST(EnvelopeStage, NormalisedByMvcIsTheEnvelopeOverItsReference) {
  const Inputs input = {{"signals", {&recordings()}}};
  const StageData plain = run("emg.envelope", "normalise = \"none\"\noutput_rate_hz = 200", input, moving);
  const StageData scaled = run("emg.envelope", "normalise = \"mvc\"\noutput_rate_hz = 200", input, moving);
  const data::Table& table = scaled.tables.at("normalisation");
  ASSERT_EQ(table.rows(), 5u);
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::string channel = table.texts("channel")[row];
    EXPECT_EQ(table.texts("trial")[row], "mvc-1");
    const data::Signal e = signal(scaled, "random-1", channel), v = signal(plain, "random-1", channel);
    EXPECT_EQ(e.info.unit, "1");
    EXPECT_EQ(v.info.unit, "V");
    EXPECT_EQ(e.info.quantity, data::Quantity::excitation);
    EXPECT_EQ(e.info.rate_hz, 200.0);
    EXPECT_GT(e.info.start_time_s, 0.0);  // trimmed, and said
    const double reference = table.numbers("reference_V")[row];
    for (std::size_t i = 0; i < e.samples.size(); ++i)
      ASSERT_NEAR(e.samples[i] * reference, v.samples[i], 1e-15);
  }
  EXPECT_THAT(scaled.attributes.at("trimmed"), HasSubstr("s at the start and"));
}

double expected_bias(const StageData& envelopes, const std::string& channel) {
  const data::Table& table = envelopes.tables.at("normalisation");
  const auto& names = table.texts("channel");
  return table.numbers("expected_bias")
      .at(static_cast<std::size_t>(std::find(names.begin(), names.end(), channel) - names.begin()));
}

TEST(EnvelopeStage, FollowsTheTrueExcitation) {
  const StageData e =
      run("emg.envelope", "output_rate_hz = 200", {{"signals", {&recordings()}}}, {"random-*"});
  for (const char* channel : {"biceps", "triceps_long", "brachialis"}) {
    const data::Signal envelope = signal(e, "random-1", channel),
                       exact = signal(truth(), "random-1", channel);
    const auto first = static_cast<std::size_t>(std::lround(envelope.info.start_time_s * 200.0));
    ASSERT_LE(first + envelope.samples.size(), exact.samples.size());
    const std::vector<double> same(
        exact.samples.begin() + static_cast<std::ptrdiff_t>(first),
        exact.samples.begin() + static_cast<std::ptrdiff_t>(first + envelope.samples.size()));
    // The largest mean of noise in the MVC is above the true one, by as much as the stage says to expect.
    EXPECT_NEAR(mean(envelope.samples) * (1.0 + expected_bias(e, channel)) / mean(same), 1.0, 0.1) << channel;
    double ee = 0.0, tt = 0.0, et = 0.0;
    const double me = mean(envelope.samples), mt = mean(same);
    for (std::size_t i = 0; i < same.size(); ++i) {
      ee += (envelope.samples[i] - me) * (envelope.samples[i] - me);
      tt += (same[i] - mt) * (same[i] - mt);
      et += (envelope.samples[i] - me) * (same[i] - mt);
    }
    EXPECT_GT(et / std::sqrt(ee * tt), 0.9) << channel;
  }
}

TEST(EnvelopeStage, OverTheMaximumOfAllTrialsNothingExceedsOneByMoreThanTheWindowHides) {
  const StageData e =
      run("emg.envelope", "normalise = \"trials_maximum\"\nreference_window_s = 0.0\noutput_rate_hz = 0",
          {{"signals", {&recordings()}}}, moving);
  EXPECT_FALSE(e.tables.contains("above_one"));
  double largest = 0.0;
  for (const data::TrialInfo& trial : e.signals->info().trials) {
    const data::Signal s = signal(e, trial.name, "biceps");
    largest = std::max(largest, *std::max_element(s.samples.begin(), s.samples.end()));
  }
  EXPECT_DOUBLE_EQ(largest, 1.0);
  ASSERT_FALSE(e.diagnostics.empty());
  EXPECT_EQ(e.diagnostics.front().severity, data::Severity::warning);
}

TEST(EnvelopeStage, ExcitationAboveOneIsListedAndNotClamped) {
  const StageData e = run("emg.envelope", "reference_trials = [\"weak\"]\noutput_rate_hz = 200",
                          {{"signals", {&recordings()}}}, {"ramp"});
  const data::Table& table = e.tables.at("above_one");
  ASSERT_GT(table.rows(), 0u);
  const data::Signal s = signal(e, "ramp", table.texts("channel")[0]);
  EXPECT_DOUBLE_EQ(*std::max_element(s.samples.begin(), s.samples.end()), table.numbers("maximum")[0]);
  EXPECT_EQ(static_cast<double>(
                std::count_if(s.samples.begin(), s.samples.end(), [](double v) { return v > 1.0; })),
            table.numbers("samples")[0]);
  ASSERT_FALSE(e.diagnostics.empty());
  EXPECT_EQ(e.diagnostics.back().code, "excitation-above-one");
}

TEST(EnvelopeStage, LeavesOutWhatQualityOrItsOwnOptionExcludes) {
  const StageData quality =
      run("emg.quality", "exclude = [\"biceps\"]", {{"signals", {&recordings()}}}, {"curl"});
  const StageData e = run("emg.envelope", "exclude = [\"brachialis\"]",
                          {{"signals", {&recordings()}}, {"quality", {&quality}}}, {"curl"});
  std::vector<std::string> names;
  for (const data::SignalInfo& s : e.signals->info().trials.front().signals) names.push_back(s.name);
  EXPECT_THAT(names, ::testing::UnorderedElementsAre("triceps_long", "triceps_lateral", "brachioradialis"));
  EXPECT_EQ(error_of([&] {
              run("emg.envelope", "exclude = [\"bicpes\"]", {{"signals", {&recordings()}}}, {"curl"});
            }),
            "error[no-match]: no EMG channel matches `bicpes`\n  help: did you mean `biceps`?\n");
}

TEST(OnsetStage, FindsTheContractionsOfTheMvc) {
  const StageData onsets =
      run("emg.onset", "channels = [\"biceps\"]", {{"signals", {&recordings()}}}, {"mvc-1"});
  const data::Table& table = onsets.tables.at("bursts");
  const data::Signal e = signal(truth(), "mvc-1", "biceps");
  std::size_t contractions = 0;
  for (std::size_t i = 1; i < e.samples.size(); ++i) {
    if (!(e.samples[i - 1] < 0.5 && e.samples[i] >= 0.5)) continue;
    ++contractions;
    const double rise = e.info.time_s(i);
    const auto& from = table.numbers("onset_s");
    EXPECT_TRUE(std::any_of(from.begin(), from.end(), [&](double t) { return t <= rise && t > rise - 0.5; }))
        << rise;
  }
  EXPECT_EQ(contractions, 3u);
  EXPECT_EQ(onsets.tables.at("baselines").numbers("bursts")[0], static_cast<double>(table.rows()));
}

TEST(ActivationStage, GivesTheTwinsActivationsFromItsExcitations) {
  const StageData a = run("emg.activation", "", {{"excitation", {&truth()}}}, {"random-1"});
  for (const data::SceneMuscle& muscle : elbow().muscles) {
    EXPECT_LT(largest_difference(signal(a, "random-1", muscle.name).samples,
                                 signal(truth(), "random-1", muscle.name + ".activation").samples),
              1e-12)
        << muscle.name;
  }
}

TEST(ActivationStage, ASubjectBringsItsParametersAndGains) {
  StageData subject = subject_data();
  const Inputs plain = {{"excitation", {&truth()}}, {"subject", {&subject}}};
  const std::vector<double> exact = signal(truth(), "random-1", "BIClong.activation").samples;
  EXPECT_LT(largest_difference(
                signal(run("emg.activation", "", plain, {"random-1"}), "random-1", "BIClong").samples, exact),
            1e-12);

  subject.subject->channel_gains = {{"biceps", 2.0}};
  const StageData halved = changed(truth(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals)
        if (s.info.name == "biceps")
          for (double& v : s.samples) v *= 0.5;
  });
  EXPECT_LT(largest_difference(signal(run("emg.activation", "",
                                          {{"excitation", {&halved}}, {"subject", {&subject}}}, {"random-1"}),
                                      "random-1", "BIClong")
                                   .samples,
                               exact),
            1e-12);

  for (data::SubjectMuscle& m : subject.subject->muscles) m.activation.delay_s += 0.1;  // 20 frames at 200 Hz
  const std::vector<double> late =
      signal(run("emg.activation", "", {{"excitation", {&halved}}, {"subject", {&subject}}}, {"random-1"}),
             "random-1", "BIClong")
          .samples;
  for (std::size_t i = 400; i < exact.size(); ++i)
    ASSERT_NEAR(late[i], exact[i - 20], 1e-6) << i;  // after the start has decayed
}

TEST(ActivationStage, CountsWhatExceedsOne) {
  const StageData loud = changed(truth(), [](data::Session& session) {
    for (data::Trial& t : session.trials)
      for (data::Signal& s : t.signals)
        if (s.info.quantity == data::Quantity::excitation)
          for (double& v : s.samples) v *= 3.0;
  });
  const StageData a = run("emg.activation", "", {{"excitation", {&loud}}}, {"ramp"});
  ASSERT_TRUE(a.tables.contains("above_one"));
  EXPECT_GT(a.tables.at("above_one").numbers("maximum")[0], 1.0);
  EXPECT_EQ(a.diagnostics.front().code, "activation-above-one");
}

}  // namespace
}  // namespace brachium::pipelines::tests
