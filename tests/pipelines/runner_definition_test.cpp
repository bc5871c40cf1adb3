// What is refused before anything runs, and how it is said.

#include <gmock/gmock.h>

#include "pipelines/definition.hpp"
#include "runner_fake_stages.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class DefinitionTest : public ::testing::Test {
 protected:
  DefinitionTest() : folder_(brachium::tests::scratch_dir()) {}
  Definition read(const std::string& text, const std::vector<std::string>& settings = {}) const {
    write_file(folder_ / "d.toml", text);
    return read_definition(folder_ / "d.toml", settings, catalogue_);
  }
  std::string mistakes(const std::string& text, const std::vector<std::string>& settings = {}) const {
    std::string out = mistakes_of([&] { read(text, settings); });
    const std::string prefix = (folder_ / "").string();
    for (std::size_t at; (at = out.find(prefix)) != std::string::npos;) out.erase(at, prefix.size());
    return out;
  }
  const std::filesystem::path folder_;
  const Catalogue catalogue_ = fake_catalogue();
};

const std::string head =
    "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"s\"\nrun = \"fake.source\"\nvalue = 1\n";
std::string scale(const std::string& lines) {
  return head + "[[stage]]\nname = \"x\"\nrun = \"fake.scale\"\ninput = { signal = \"s\" }\n" + lines;
}

TEST_F(DefinitionTest, AGoodOneHasAllDefaultsAndAnOrder) {
  const Definition d = read(chain);
  ASSERT_EQ(d.stages.size(), 3u);
  EXPECT_EQ(d.find("scaled")->options.number("lowpass_hz"), 6.0);
  EXPECT_EQ(d.order, (std::vector<std::size_t>{0, 1, 2}));
}

TEST_F(DefinitionTest, StagesMayStandInAnyOrder) {
  const Definition d = read(
      "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"b\"\nrun = \"fake.scale\"\ninput = { signal = \"a\" }\n"
      "[[stage]]\nname = \"a\"\nrun = \"fake.source\"\nvalue = 1\n");
  EXPECT_EQ(d.order, (std::vector<std::size_t>{1, 0}));
}

TEST_F(DefinitionTest, MisspeltOptionIsShownWithItsNearestName) {
  EXPECT_EQ(mistakes(scale("low_pas_hz = 6.0\n")),
            "error[unknown-key]: `low_pas_hz` is not an option of stage `fake.scale`\n"
            "  --> d.toml:11:1\n"
            "   |\n"
            "11 | low_pas_hz = 6.0\n"
            "   | ^^^^^^^^^^ did you mean `lowpass_hz`?\n");
}

TEST_F(DefinitionTest, OptionInAnotherUnitIsToldItsUnit) {
  EXPECT_THAT(mistakes(scale("lowpass_khz = 0.006\n")),
              HasSubstr("`lowpass_khz` is not an option of stage `fake.scale`: it is given in Hz"));
  EXPECT_THAT(mistakes(scale("lowpass = 6\n")), HasSubstr("error[wrong-unit]: `lowpass` is not an option"));
  EXPECT_THAT(mistakes(scale("lowpass = 6\n")),
              HasSubstr("^^^^^^^ write `lowpass_hz`, with the value in Hz"));
}

TEST_F(DefinitionTest, WrongTypeRangeAndChoiceAreTold) {
  EXPECT_THAT(mistakes(scale("factor = \"two\"\n")),
              HasSubstr("error[wrong-type]: `factor` of stage `fake.scale` must be a number, not a text\n  "
                        "--> d.toml:11:10"));
  EXPECT_THAT(mistakes(scale("factor = 200\n")),
              HasSubstr("error[out-of-range]: `factor` = 200 of stage `fake.scale` is out of range"));
  EXPECT_THAT(mistakes(scale("factor = 200\n")), HasSubstr("allowed: 0 to 100"));
  EXPECT_THAT(mistakes(scale("factor = nan\n")), HasSubstr("error[out-of-range]"));
  EXPECT_THAT(mistakes(scale("lowpass_hz = 0\n")), HasSubstr("allowed: greater than 0 Hz"));
  EXPECT_THAT(mistakes(scale("mode = \"plane\"\n")),
              HasSubstr("error[unknown-value]: `plane` is not a value of `mode` of stage `fake.scale`"));
  EXPECT_THAT(mistakes(scale("mode = \"plane\"\n")), HasSubstr("did you mean `plain`?"));
  EXPECT_THAT(mistakes(scale("bounds = [{ lower = 1 }]\n")),
              HasSubstr("error[missing-option]: `bounds` of stage `fake.scale` needs the option `upper`"));
}

TEST_F(DefinitionTest, MissingOptionIsTold) {
  EXPECT_THAT(
      mistakes("[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"s\"\nrun = \"fake.source\"\n"),
      HasSubstr("error[missing-option]: stage `fake.source` needs the option `value`\n  --> d.toml:3:"));
}

TEST_F(DefinitionTest, UnknownStageIsShownWithItsNearestName) {
  EXPECT_THAT(mistakes("[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"s\"\nrun = \"fake.sorce\"\n"),
              HasSubstr("error[unknown-stage]: there is no stage `fake.sorce`\n  --> d.toml:5:7\n"));
}

TEST_F(DefinitionTest, TwoStagesOfOneNameAreRefused) {
  EXPECT_THAT(mistakes(head + "[[stage]]\nname = \"s\"\nrun = \"fake.source\"\nvalue = 1\n"),
              HasSubstr("error[duplicate-stage]: two stages are called `s`\n  --> d.toml:8:8"));
  EXPECT_THAT(mistakes(head + "[[stage]]\nname = \"s\"\nrun = \"fake.source\"\nvalue = 1\n"),
              HasSubstr("the other one starts in line 3"));
}

TEST_F(DefinitionTest, ALoopIsNamedStageByStage) {
  const std::string text =
      "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"a\"\nrun = \"fake.scale\"\ninput = { signal = \"b\" }\n"
      "[[stage]]\nname = \"b\"\nrun = \"fake.scale\"\ninput = { signal = \"a\" }\n";
  EXPECT_THAT(mistakes(text), HasSubstr("error[cycle]: stages wait for each other: `a` reads `b` reads `a`"));
}

TEST_F(DefinitionTest, WiringMistakesAreTold) {
  EXPECT_THAT(
      mistakes(head + "[[stage]]\nname = \"x\"\nrun = \"fake.scale\"\n"),
      HasSubstr("error[missing-input]: stage `x` (`fake.scale`) needs the input `signal`: any signals"));
  EXPECT_THAT(mistakes(head + "[[stage]]\nname = \"x\"\nrun = \"fake.scale\"\ninput = { signal = \"z\" }\n"),
              HasSubstr("error[unknown-stage]: input `signal` of stage `x` names the stage `z`, which the "
                        "pipeline does not have"));
  EXPECT_THAT(mistakes(head + "[[stage]]\nname = \"x\"\nrun = \"fake.scale\"\ninput = { sinal = \"s\" }\n"),
              HasSubstr("error[unknown-input]: stage `x` has no input `sinal`"));
  EXPECT_THAT(
      mistakes(
          head +
          "[[stage]]\nname = \"x\"\nrun = \"fake.predict\"\ninput = { signal = \"s\", subject = \"s\" }\n"),
      HasSubstr(
          "error[wrong-port]: input `subject` of stage `x` takes a subject, but stage `s` gives signals"));
  EXPECT_THAT(
      mistakes(head + "[[stage]]\nname = \"x\"\nrun = \"fake.scale\"\ninput = { signal = [\"s\", \"s\"] }\n"),
      HasSubstr("error[too-many-inputs]"));
}

TEST_F(DefinitionTest, MissingFilesAreTold) {
  EXPECT_THAT(mistakes("[pipeline]\ntitle = \"t\"\nsession = \"s01.h5\"\nscene = "
                       "\"elbow.toml\"\n[[stage]]\nname = \"x\"\nrun = \"fake.scale\"\n"),
              ::testing::AllOf(
                  HasSubstr("error[missing-file]: the session `s01.h5` does not exist\n  --> d.toml:3:11"),
                  HasSubstr("error[missing-file]: the scene `elbow.toml` does not exist\n  --> d.toml:4:9")));
}

TEST_F(DefinitionTest, AllMistakesAreReportedAtOnce) {
  const std::string text = mistakes(
      "[pipeline]\ntitel = \"t\"\nscene = \"none.toml\"\n[[stage]]\nname = \"a\"\nrun = "
      "\"fake.scale\"\nfactor = -1\n"
      "input = { signal = \"b\" }\n[[stage]]\nname = \"a\"\nrun = \"fake.nothing\"\n[[expect]]\nstage = "
      "\"q\"\n");
  for (const char* code :
       {"unknown-key", "missing-key", "missing-file", "out-of-range", "unknown-stage", "duplicate-stage"}) {
    EXPECT_THAT(text, HasSubstr(std::string("error[") + code + "]")) << text;
  }
}

TEST_F(DefinitionTest, SyntaxErrorsHaveAPlace) {
  EXPECT_THAT(mistakes("[pipeline\n"), HasSubstr("error[toml-syntax]"));
}

TEST_F(DefinitionTest, SettingsChangeOptionsAndVariables) {
  const std::string text =
      "[variables]\nf = 3\nwhere = { help = \"a folder\", path = true }\n" + scale("factor = \"${f}\"\n");
  EXPECT_EQ(read(text).find("x")->options.number("factor"), 3.0);
  EXPECT_EQ(read(text, {"f=5"}).find("x")->options.number("factor"), 5.0);
  EXPECT_EQ(read(text, {"x.factor=7", "pipeline.title=other"}).find("x")->options.number("factor"), 7.0);
  EXPECT_EQ(read(text, {"pipeline.title=other"}).title, "other");
  EXPECT_EQ(read(text, {"x.trials=[\"a\"]"}).find("x")->trials, std::vector<std::string>{"a"});
}

TEST_F(DefinitionTest, PlainValuesBeforeTheFirstTableAreVariables) {
  const std::string text = "f = 3\n" + scale("factor = \"${f}\"\nmode = \"plain\"\n");
  EXPECT_EQ(read(text).find("x")->options.number("factor"), 3.0);
  EXPECT_EQ(read(text, {"f=4"}).find("x")->options.number("factor"), 4.0);
  EXPECT_THAT(mistakes("titel = \"x\"\n" + scale("")),
              HasSubstr("error[unknown-key]: `titel` is not a key of a pipeline definition, nor a variable "
                        "that a text uses\n  --> d.toml:1:1\n"));
}

TEST_F(DefinitionTest, BadSettingsAreTold) {
  EXPECT_THAT(mistakes(scale(""), {"factor"}),
              HasSubstr("error[bad-setting]: `factor` is not of the form KEY=VALUE"));
  EXPECT_THAT(
      mistakes(scale(""), {"y.factor=1"}),
      HasSubstr("error[unknown-setting]: `y` is neither a stage, a variable nor a part of this pipeline"));
  EXPECT_THAT(
      mistakes(scale(""), {"x.factr=1"}),
      HasSubstr(
          "error[unknown-key]: `factr` is not an option of stage `fake.scale`\n  --> --set x.factr=1\n"));
  EXPECT_THAT(mistakes("[variables]\nr = { help = \"recordings\" }\n" + scale("mode = \"${r}\"\n")),
              HasSubstr("error[unset-variable]: variable `r` has no value: recordings"));
  EXPECT_THAT(mistakes("[variables]\nff = 1\n" + scale("mode = \"${fff}\"\n")),
              HasSubstr("error[unknown-variable]: there is no variable `fff`"));
}

TEST_F(DefinitionTest, ResolvedTextReadsBackAsTheSameDefinition) {
  const Definition d = read(chain +
                            "[[expect]]\nstage = \"total\"\ntable = \"total\"\nwhere = { what = \"all\" "
                            "}\ncolumn = \"sum\"\nmin = 0\n");
  const Definition again = read(resolved_text(d));
  EXPECT_EQ(resolved_text(again), resolved_text(d));
  EXPECT_EQ(again.expectations.size(), 1u);
  EXPECT_THAT(resolved_text(d), HasSubstr("lowpass_hz = 6.0"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
