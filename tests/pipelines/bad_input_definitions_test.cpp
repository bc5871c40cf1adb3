// Definitions of built-in stages: the shipped ones pass, and mistakes are all told at once before anything runs.

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "data/io/session_file.hpp"
#include "pipelines/definition.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

std::filesystem::path shipped(const std::string& name) {
  return brachium::tests::source_dir() / "pipelines" / name;
}

TEST(ShippedDefinitions, EveryOptionOfTheDemoIsValidAndItsResolvedTextReadsBack) {
  const Definition demo = read_definition(shipped("demo.toml"), {}, catalogue());
  EXPECT_EQ(demo.order.size(), demo.stages.size());
  EXPECT_TRUE(demo.warnings.empty()) << data::render(demo.warnings);
  const std::filesystem::path copy = brachium::tests::scratch_dir() / "resolved.toml";
  std::ofstream(copy) << resolved_text(demo);
  const Definition again = read_definition(copy, {}, catalogue());
  EXPECT_EQ(resolved_text(again), resolved_text(demo));
}

TEST(ShippedDefinitions, EveryOptionOfTheElbowCurlsIsValid) {
  BRACHIUM_NEEDS_SESSIONS();
  const std::vector<std::string> settings = {
      "recordings=" + (brachium::tests::sessions_dir() / "elbow_curls_noraxon").string()};
  const Definition curls = read_definition(shipped("elbow_curls.toml"), settings, catalogue());
  ASSERT_NE(curls.find("validation"), nullptr);
  ASSERT_NE(curls.find("subject"), nullptr);
  // What is validated is what is calibrated: every option that both have is the same.
  const auto &validated = curls.find("validation")->options, &calibrated = curls.find("subject")->options;
  for (const char* key : {"curves", "tendon", "nonlinearity"})
    EXPECT_EQ(validated.text(key), calibrated.text(key)) << key;
  EXPECT_EQ(validated.tables("free").size(), calibrated.tables("free").size());
  EXPECT_EQ(validated.number("scale_N_m"), calibrated.number("scale_N_m"));
}

/// A definition over a small stored session, with a scene beside it.
class BadDefinition : public ::testing::Test {
 protected:
  BadDefinition() : folder_(brachium::tests::scratch_dir()) {
    data::Session session;
    data::Trial trial;
    trial.name = "curl";
    for (const char* channel :
         {"biceps", "brachialis", "brachioradialis", "triceps_lateral", "triceps_long"}) {
      data::Signal emg;
      emg.info = {channel, data::Quantity::emg, "V", 1000.0, 0.0, 1000, {}, {}, {}};
      for (int i = 0; i < 1000; ++i) emg.samples.push_back(1e-4 * std::sin(0.7 * i));
      trial.signals.push_back(emg);
    }
    session.trials.push_back(trial);
    io::write_session(session, folder_ / "s.h5");
    std::filesystem::copy(shipped("scenes/elbow_twin.toml"), folder_ / "scene.toml");
  }
  std::string mistakes(const std::string& stages,
                       const std::string& head =
                           "[pipeline]\ntitle = \"t\"\nsession = \"s.h5\"\nscene = \"scene.toml\"\n") const {
    std::ofstream(folder_ / "d.toml") << head << stages;
    std::string out = error_of([&] { read_definition(folder_ / "d.toml", {}, catalogue()); });
    const std::string prefix = (folder_ / "").string();
    for (std::size_t at; (at = out.find(prefix)) != std::string::npos;) out.erase(at, prefix.size());
    return out;
  }
  std::string scene_text() const {
    std::ifstream in(folder_ / "scene.toml");
    return {std::istreambuf_iterator<char>(in), {}};
  }
  const std::filesystem::path folder_;
};

TEST_F(BadDefinition, AllMistakesOfDefinitionAndSceneAreToldAtOnce) {
  std::string scene = scene_text();
  scene.replace(scene.find("tendon_slack_length_m = 0.1430"), 30, "tendon_slack_length_m = -0.143");
  scene += scene.substr(scene.find("[[muscle]]\nname = \"BRD\""));
  std::ofstream(folder_ / "scene.toml") << scene;
  const std::string said = mistakes(
      "[[stage]]\nname = \"e\"\nrun = \"emg.envelope\"\nlow_pass_hz = 6.0\n"
      "[[stage]]\nname = \"e\"\nrun = \"emg.activation\"\ninput = { excitation = \"f\" }\n"
      "[[stage]]\nname = \"k\"\nrun = \"limb.kinematics\"\nlowpass = 6.0\n"
      "[[stage]]\nname = \"m\"\nrun = \"hill.momnet\"\n");
  for (const char* line : {"error[unknown-key]: `low_pass_hz` is not an option of stage `emg.envelope`",
                           "did you mean `lowpass_hz`?", "error[duplicate-stage]: two stages are called `e`",
                           "error[unknown-stage]: input `excitation` of stage `e` names the stage `f`, which "
                           "the pipeline does not have",
                           "error[wrong-unit]: `lowpass` is not an option of stage `limb.kinematics`",
                           "error[unknown-stage]: there is no stage `hill.momnet`",
                           "did you mean `hill.moment`?", "error[out-of-range]: `tendon_slack_length_m`",
                           "error[duplicate-muscle]: muscle `BRD` is defined twice"}) {
    EXPECT_THAT(said, HasSubstr(line));
  }
}

TEST_F(BadDefinition, OptionsOutsideTheirRangeAreToldWithTheRange) {
  EXPECT_EQ(
      mistakes("[[stage]]\nname = \"e\"\nrun = \"emg.envelope\"\nlowpass_hz = -6.0\nnormalise = \"mcv\"\n"),
      "error[out-of-range]: `lowpass_hz` = -6 of stage `emg.envelope` is out of range\n"
      "  --> d.toml:8:14\n"
      "  |\n"
      "8 | lowpass_hz = -6.0\n"
      "  |              ^^^^ allowed: greater than 0 Hz\n"
      "error[unknown-value]: `mcv` is not a value of `normalise` of stage `emg.envelope`\n"
      "  --> d.toml:9:13\n"
      "  |\n"
      "9 | normalise = \"mcv\"\n"
      "  |             ^^^^^ did you mean `mvc`?\n");
}

TEST_F(BadDefinition, ADriveByAChannelThatTheSessionLacksIsToldBeforeAnythingRuns) {
  std::string scene = scene_text();
  scene.replace(scene.find("brachialis = 1.0"), 10, "brachialsi");
  std::ofstream(folder_ / "scene.toml") << scene;
  const std::string said = mistakes("[[stage]]\nname = \"e\"\nrun = \"emg.envelope\"\n");
  EXPECT_THAT(said, HasSubstr("error[unmapped-channel]: muscle `BRA` is driven by channel `brachialsi`, "
                              "which is not recorded\n"));
  EXPECT_THAT(said, HasSubstr("did you mean `brachialis`?"));
}

TEST_F(BadDefinition, AStageThatNeedsASceneSaysSo) {
  EXPECT_THAT(mistakes("[[stage]]\nname = \"k\"\nrun = \"limb.kinematics\"\n",
                       "[pipeline]\ntitle = \"t\"\nsession = \"s.h5\"\n"),
              HasSubstr("error[missing-scene]: "));
}

TEST_F(BadDefinition, EmptyFilesAreTold) {
  std::ofstream(folder_ / "empty.toml");
  EXPECT_EQ(mistakes("", ""),
            "error[missing-key]: the definition has no table [pipeline]\n"
            "  --> d.toml:1:1\n"
            "  help: start it with [pipeline] and a title\n"
            "error[missing-key]: the definition has no [[stage]]\n"
            "  --> d.toml:1:1\n"
            "  help: `brachium stages` lists what there is\n");
  const std::string all = mistakes(
      "[[stage]]\nname = \"a\"\nrun = \"emg.envelope\"\n"
      "[[stage]]\nname = \"b\"\nrun = \"emg.activation\"\n"
      "input = { excitation = \"a\", subject = \"file:empty.toml\" }\n",
      "[pipeline]\ntitle = \"t\"\nsession = \"empty.toml\"\nscene = \"empty.toml\"\n");
  for (const char* line :
       {"error[missing-key]: there is no [session]\n", "error[missing-key]: there is no [[trial]]\n",
        "error[missing-key]: there is no [[file]]\n", "error[missing-key]: the table [scene] is missing\n",
        "error[missing-key]: the scene has no [[coordinate]]\n",
        "error[empty-file]: `empty.toml` is empty\n"})
    EXPECT_THAT(all, HasSubstr(line));
}

TEST_F(BadDefinition, ATruncatedSessionIsTold) {
  std::filesystem::resize_file(folder_ / "s.h5", 3000);
  EXPECT_THAT(mistakes("[[stage]]\nname = \"e\"\nrun = \"emg.envelope\"\n"),
              HasSubstr("error[damaged-file]: `s.h5` is cut off or damaged: HDF5 cannot open it"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
