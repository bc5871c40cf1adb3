// A subject's file in the hands of the stages that predict: calibrated on one synthetic session from a scene whose
// parameters are wrong, read by the pipeline of another session with the same scene.

#include <gtest/gtest.h>

#include <fstream>

#include "data/io/session_file.hpp"
#include "data/io/stage_file.hpp"
#include "data/io/subject_file.hpp"
#include "optimise/twin.hpp"
#include "pipelines/runner.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

namespace fs = std::filesystem;
using optimise::Programme;

struct Silent final : RunObserver {
  void stage_begins(const StageRecord&, std::size_t, std::size_t) override {}
  void stage_progress(const StageRecord&, double, const std::string&) override {}
  void stage_ends(const StageRecord&, const std::vector<data::Diagnostic>&) override {}
  void message(const std::string&) override {}
};

std::string stage(const std::string& name, const std::string& run, const std::string& lines) {
  return "[[stage]]\nname = \"" + name + "\"\nrun = \"" + run + "\"\n" + lines;
}

/// Activations and moment, with a subject's file or with the scene's own parameters.
std::string model(const std::string& name, const std::string& excitation, const std::string& file) {
  const std::string subject = file.empty() ? "" : ", subject = \"file:" + file + "\"";
  return stage("activation_" + name, "emg.activation",
               "input = { excitation = \"" + excitation + "\"" + subject +
                   " }\ntrials = [\"random-*\", \"ramp\"]\n") +
         stage(name, "hill.moment", "input = { activation = \"activation_" + name + "\"" + subject + " }\n");
}

const std::string judged =
    "input = { reference = \"session\", models = [\"calibrated\", \"truth\", \"scene\"] }\n"
    "trials = [\"random-*\", \"ramp\"]\nedge_s = 0.5\n";
const std::string free_parameters =
    "trials = [\"random-*\", \"ramp\"]\nedge_s = 0.1\ndecimate = 4\n"
    "free = [ { parameter = \"strength\", scope = \"group\" },"
    " { parameter = \"tendon_slack_length\", scope = \"group\", relative = true },"
    " { parameter = \"shape\", scope = \"global\" }, { parameter = \"delay\", scope = \"global\" } ]\n";

class SubjectPrediction : public ::testing::Test {
 protected:
  SubjectPrediction() {
    const fs::path scenes = brachium::tests::source_dir() / "pipelines/scenes";
    std::ifstream in(scenes / "elbow_twin.toml");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto change = [&](const std::string& what, const std::string& value) {
      for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += value.size())
        text.replace(at, what.size(), value);
    };
    change("shape = -1.5", "shape = -0.9");
    change("delay_s = 0.040", "delay_s = 0.055");
    change("max_isometric_force_N", "strength = 1.3\nmax_isometric_force_N");
    std::ofstream(folder_ / "scene.toml") << text;
  }

  /// Recordings and, beside them, the true excitations; the truth as a subject's file.
  void write_twin(std::uint64_t seed, optimise::TwinOptions options) const {
    options.seed = seed;
    const auto trial = [&](const std::string& name, Programme programme, double lower_deg, double upper_deg,
                           double effort, data::TrialKind kind = data::TrialKind::calibration) {
      const double rad = std::acos(-1.0) / 180.0;
      options.trials.push_back(
          {name, programme, kind, 12.0, lower_deg * rad, upper_deg * rad, effort, 12.0, 0.0});
    };
    trial("mvc", Programme::mvc, 90.0, 90.0, 1.0, data::TrialKind::mvc);
    trial("sweep", Programme::passive_sweep, 10.0, 130.0, 0.0, data::TrialKind::passive);
    trial("ramp", Programme::isometric_ramp, 75.0, 75.0, 0.7);
    trial("random-1", Programme::random, 20.0, 120.0, 0.7);
    trial("random-2", Programme::random, 20.0, 120.0, 0.7);
    const optimise::Twin twin = optimise::make_twin(elbow(), options);
    data::Session session = twin.recordings;
    if (!options.raw_emg)
      for (std::size_t t = 0; t < session.trials.size(); ++t)
        for (const data::Signal& s : twin.truth.trials[t].signals)
          if (s.info.quantity == data::Quantity::excitation) session.trials[t].signals.push_back(s);
    io::write_session(session, folder_ / ("session-" + std::to_string(seed) + ".h5"));
    io::write_subject(twin.subject, folder_ / "truth.subject.toml");
  }

  RunResult run(const std::string& name, std::uint64_t seed, const std::string& stages) const {
    std::ofstream(folder_ / (name + ".toml"))
        << "[pipeline]\ntitle = \"" << name << "\"\nscene = \"scene.toml\"\nsession = \"session-" << seed
        << ".h5\"\n"
        << stages;
    RunRequest request;
    request.definition = folder_ / (name + ".toml");
    request.out = folder_ / name;
    request.threads = 1;
    Silent silent;
    RunResult result = run_pipeline(catalogue(), request, silent);
    EXPECT_EQ(result.outcome, Outcome::done) << data::render(result.errors);
    return result;
  }

  /// RMSE of the calibrated subject, of the true one, and of the scene they started from.
  struct Errors {
    double calibrated, truth, scene;
  };
  static Errors errors(const RunResult& result) {
    const data::Table scores = io::read_stage_content(result.find("verdict")->output).tables.at("scores");
    std::map<std::string, double> rmse;
    for (std::size_t row = 0; row < scores.rows(); ++row)
      if (scores.texts("trial")[row].starts_with("all"))
        rmse[scores.texts("model")[row]] = scores.numbers("rmse_N_m")[row];
    return {rmse.at("calibrated"), rmse.at("truth"), rmse.at("scene")};
  }

  const fs::path folder_ = brachium::tests::scratch_dir();
};

TEST_F(SubjectPrediction, WithoutNoiseIsExactOnAnotherSeed) {
  optimise::TwinOptions exact;
  exact.raw_emg = false;
  write_twin(3, exact);
  write_twin(11, exact);
  run("calibration", 3,
      stage("who", "optimise.calibrate",
            "input = { excitation = \"session\", kinematics = \"session\", moment = \"session\" }\n"
            "excitation_cv = 0.0\ncorrect_bias = false\n" +
                free_parameters));
  const Errors e =
      errors(run("prediction", 11,
                 model("calibrated", "session", "calibration/who.subject.toml") +
                     model("truth", "session", "truth.subject.toml") + model("scene", "session", "") +
                     stage("verdict", "pipelines.compare", judged)));
  EXPECT_LT(e.truth, 1e-9);
  EXPECT_LT(e.calibrated, 1e-6);
  EXPECT_GT(e.scene, 1.0);
}

// What noise of the envelopes does to a moment is undone by no parameters: the true ones are the measure.
TEST_F(SubjectPrediction, FromNoisyEmgIsAsGoodAsThatOfTheTrueSubject) {
  optimise::TwinOptions noisy;
  noisy.emg.snr_db = 20.0;
  noisy.moment_noise_sd_N_m = 0.3;
  write_twin(3, noisy);
  write_twin(11, noisy);
  const std::string envelope = stage("excitation", "emg.envelope",
                                     "highpass_hz = 30.0\nlowpass_hz = 6.0\noutput_rate_hz = 100.0\n"
                                     "correct_reference_bias = true\nsubtract_rest = true\n");
  run("calibration", 3,
      envelope +
          stage("who", "optimise.calibrate",
                "input = { excitation = \"excitation\", kinematics = \"session\", moment = \"session\" }\n"
                "noise_band_high_hz = 1000.0\nnoise_replicates = 10\n" +
                    free_parameters));
  const Errors e =
      errors(run("prediction", 11,
                 envelope + model("calibrated", "excitation", "calibration/who.subject.toml") +
                     model("truth", "excitation", "truth.subject.toml") + model("scene", "excitation", "") +
                     stage("verdict", "pipelines.compare", judged)));
  EXPECT_GT(e.calibrated, 0.3);  // the noise of the reference
  EXPECT_LT(e.calibrated, 1.1 * e.truth);
  EXPECT_GT(e.scene, 1.5 * e.truth);
}

}  // namespace
}  // namespace brachium::pipelines::tests
