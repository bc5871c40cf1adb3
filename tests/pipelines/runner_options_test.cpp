// Options in nested tables and tables of names, files that options name, and stages that fail but keep what
// they reached.

#include <gmock/gmock.h>

#include "pipelines/describe.hpp"
#include "pipelines/fingerprint.hpp"
#include "pipelines/options.hpp"
#include "pipelines/run_folder.hpp"
#include "runner_fake_stages.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

OptionSpec option(std::string key, OptionType type, bool optional = true) {
  OptionSpec spec;
  spec.key = std::move(key);
  spec.type = type;
  spec.doc = "for tests";
  spec.optional = optional;
  return spec;
}

/// body = { file, block = { size_m, cells } }, phase = [{ activation = {...} }], verdict.
Catalogue nested_catalogue() {
  StageSpec spec;
  spec.name = "fake.nested";
  spec.summary = "a stage for tests";
  OptionSpec file = option("file", OptionType::text), size = option("size_m", OptionType::numbers, false),
             cells = option("cells", OptionType::integer);
  file.is_file = true;
  size.unit = "m";
  size.length = 3;
  cells.fallback = std::int64_t{4};
  OptionSpec block = option("block", OptionType::table), body = option("body", OptionType::table, false);
  block.fields = {size, cells};
  body.fields = {file, block};
  OptionSpec activation = option("activation", OptionType::number_map),
             phase = option("phase", OptionType::tables);
  activation.fallback = std::map<std::string, double>{};
  activation.lower = 0.0;
  activation.upper = 1.0;
  phase.fields = {activation};
  phase.fallback = std::vector<Options>{};
  OptionSpec fail = option("fail", OptionType::boolean);
  fail.fallback = false;
  spec.options = {body, phase, fail};
  spec.output = PortType::tables;
  spec.run = [](const StageContext& context, StageOutput& output) {
    output.tables["reached"] = {"Reached", {{"x", "1", std::vector<double>{1.0, 2.0}}}};
    if (!context.beside.empty()) {
      write_file(context.beside.string() + ".extra", "more");
      output.files = {context.beside.filename().string() + ".extra"};
    }
    if (context.say) context.say("half way");
    if (context.options->boolean("fail")) output.failure = "the third step did not converge";
  };
  Catalogue catalogue;
  catalogue.add(std::move(spec));
  return catalogue;
}

Options read(const std::string& toml) {
  return options_from_text(toml, *nested_catalogue().find("fake.nested"));
}
std::string mistakes(const std::string& toml) {
  return mistakes_of([&] { read(toml); });
}

TEST(NestedOptions, ATableWithinATableIsReadWithItsDefaults) {
  const Options options = read("body = { block = { size_m = [1, 2, 3] } }");
  const Options* block = options.table("body").maybe_table("block");
  ASSERT_NE(block, nullptr);
  EXPECT_EQ(block->numbers("size_m"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(block->integer("cells"), 4);
  EXPECT_EQ(read("body = {}").table("body").maybe_table("block"), nullptr);
}

TEST(NestedOptions, NamesWithNumbersAreReadAndOneNumberStandsForAll) {
  const Options options = read(
      "body = {}\n[[phase]]\nactivation = { biceps = 0.5, brachialis = 1 }\n[[phase]]\nactivation = "
      "0.25\n[[phase]]");
  const auto& phases = options.tables("phase");
  EXPECT_EQ(phases[0].number_map("activation"),
            (std::map<std::string, double>{{"biceps", 0.5}, {"brachialis", 1.0}}));
  EXPECT_EQ(phases[1].number_map("activation"), (std::map<std::string, double>{{"*", 0.25}}));
  EXPECT_TRUE(phases[2].number_map("activation").empty());
}

TEST(NestedOptions, EveryMistakeInsideIsFoundWithItsPlace) {
  const std::string text = mistakes(
      "body = { blok = 1, block = { size_m = [1, 2], cells = 2.5 } }\n[[phase]]\nactivation = { biceps = "
      "1.5, triceps = \"full\" }");
  EXPECT_THAT(text, HasSubstr("`blok` is not an option of `body` of stage `fake.nested`"));
  EXPECT_THAT(text, HasSubstr("did you mean `block`?"));
  EXPECT_THAT(text, HasSubstr("`size_m` of `block` of `body` of stage `fake.nested` has 2 entries, not 3"));
  EXPECT_THAT(
      text,
      HasSubstr("`cells` of `block` of `body` of stage `fake.nested` must be a whole number, not a number"));
  EXPECT_THAT(text, HasSubstr("`activation` = 1.5 of `phase` of stage `fake.nested` is out of range"));
  EXPECT_THAT(
      text, HasSubstr("`activation.triceps` of `phase` of stage `fake.nested` must be a number, not a text"));
  EXPECT_THAT(text, HasSubstr("options:3:"));
}

TEST(NestedOptions, AListOfTablesIsNoTableAndTheOtherWayRound) {
  EXPECT_THAT(mistakes("body = [{}]"),
              HasSubstr("`body` of stage `fake.nested` must be a table, not a list"));
  EXPECT_THAT(mistakes("body = {}\nphase = {}"),
              HasSubstr("`phase` of stage `fake.nested` must be a list of tables, not a table"));
}

TEST(NestedOptions, WhatIsWrittenOutReadsBackTheSame) {
  const Catalogue catalogue = nested_catalogue();
  const StageSpec& spec = *catalogue.find("fake.nested");
  const Options options = read(
      "body = { block = { size_m = [1, 2, 3] } }\nphase = [{ activation = { biceps = 0.5 } }, { activation = "
      "1 }]");
  const std::string text = io::write_toml(options_tree(options, spec.options));
  EXPECT_EQ(io::write_toml(options_tree(read(text), spec.options)), text);
  EXPECT_THAT(explain_stage(spec), HasSubstr("size_m"));
}

class NestedRun : public ::testing::Test {
 protected:
  NestedRun() : folder_(brachium::tests::scratch_dir()) {}
  RunResult run(const std::string& options) {
    write_file(folder_ / "study.toml",
               "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"one\"\nrun = \"fake.nested\"\n" + options);
    RunRequest request;
    request.definition = folder_ / "study.toml";
    request.out = folder_ / "run";
    watcher_ = {};
    return run_pipeline(catalogue_, request, watcher_);
  }
  const std::filesystem::path folder_;
  const Catalogue catalogue_ = nested_catalogue();
  Watcher watcher_;
};

TEST_F(NestedRun, AFileThatAnOptionNamesBelongsToTheFingerprint) {
  write_file(folder_ / "arm.msh", "a mesh");
  EXPECT_EQ(run("body = { file = \"arm.msh\" }").outcome, Outcome::done);
  EXPECT_EQ(run("body = { file = \"arm.msh\" }").find("one")->status, StageStatus::reused);
  write_file(folder_ / "arm.msh", "another mesh");
  const RunResult changed = run("body = { file = \"arm.msh\" }");
  EXPECT_EQ(changed.find("one")->status, StageStatus::done);
  EXPECT_EQ(changed.find("one")->reason, "the file `arm.msh` changed");
}

TEST_F(NestedRun, AFileThatIsNotThereIsFoundBeforeAnythingRuns) {
  EXPECT_THAT(mistakes_of([&] { run("body = { file = \"leg.msh\" }"); }),
              HasSubstr("leg.msh` does not exist"));
}

TEST_F(NestedRun, APipelineNeedsNoSession) {
  EXPECT_EQ(run("body = {}").outcome, Outcome::done);
}

TEST_F(NestedRun, AFailedStageKeepsWhatItReachedAndRunsAgain) {
  const RunResult failed = run("body = {}\nfail = true");
  EXPECT_EQ(failed.outcome, Outcome::numerical_failure);
  EXPECT_EQ(exit_code(failed.outcome), 1);
  EXPECT_EQ(failed.find("one")->status, StageStatus::failed);
  EXPECT_THAT(failed.errors.at(0).message, HasSubstr("the third step did not converge"));
  EXPECT_EQ(load_stage(failed.find("one")->output, "one").tables.at("reached").rows(), 2u);
  EXPECT_THAT(file_text(folder_ / "run/report.html"), HasSubstr("Reached"));
  const RunResult again = run("body = {}\nfail = true");
  EXPECT_EQ(again.find("one")->status, StageStatus::failed);
  EXPECT_EQ(again.find("one")->reason, "it failed before");
}

TEST_F(NestedRun, FurtherFilesAreNamedAndAStageMaySpeak) {
  const RunResult result = run("body = {}");
  EXPECT_EQ(load_stage(result.find("one")->output, "one").attributes.at("files"), "01-one.extra");
  EXPECT_EQ(file_text(folder_ / "run/01-one.extra"), "more");
  EXPECT_THAT(watcher_.messages, ::testing::Contains("one: half way"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
