// When a stage runs, when it does not, and what the runner says about it.

#include <gmock/gmock.h>

#include "data/io/stage_file.hpp"
#include "pipelines/fingerprint.hpp"
#include "pipelines/sha256.hpp"
#include "runner_fake_stages.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RunnerTest : public ::testing::Test {
 protected:
  RunnerTest() : study_(brachium::tests::scratch_dir()) { study_.define(chain); }
  Study study_;
};

TEST(Sha256, EqualsThePublishedVectors) {  // FIPS 180-4 examples; NIST CAVP
  EXPECT_EQ(sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  Sha256 million;
  for (int i = 0; i < 1000; ++i) million.add(std::string(1000, 'a'));
  EXPECT_EQ(million.finish(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

TEST_F(RunnerTest, FirstRunRunsEverythingAndLeavesItsFiles) {
  const RunResult result = study_.run();
  EXPECT_EQ(result.outcome, Outcome::done);
  EXPECT_THAT(study_.watcher.began, ElementsAre("source", "scaled", "total"));
  EXPECT_EQ(study_.reason(result, "scaled"), "no output yet");
  EXPECT_EQ(result.verdict, "the sum is there");
  for (const char* file : {"01-source.h5", "02-scaled.h5", "03-total.h5", "definition.toml",
                           "provenance.json", "result.json", "log.txt", "report.html"}) {
    EXPECT_TRUE(fs::exists(study_.folder / "run" / file)) << file;
  }
  EXPECT_THAT(file_text(study_.folder / "run" / "report.html"), HasSubstr("the sum is there"));
}

TEST_F(RunnerTest, SecondRunReusesEverything) {
  study_.run();
  const RunResult result = study_.run();
  EXPECT_THAT(study_.watcher.began, IsEmpty());
  EXPECT_EQ(result.find("total")->status, StageStatus::reused);
  EXPECT_EQ(result.find("total")->started.size(), 20u);  // when the output was computed is still known
}

TEST_F(RunnerTest, ChangedOptionRunsTheStageAndWhatReadsIt) {
  study_.run();
  const RunResult result = study_.run({"scaled.lowpass_hz=4"});
  EXPECT_THAT(study_.watcher.began, ElementsAre("scaled", "total"));
  EXPECT_EQ(study_.reason(result, "scaled"), "option lowpass_hz changed 6.0 -> 4.0");
  EXPECT_EQ(study_.reason(result, "total"), "input `scaled` ran again");
  EXPECT_EQ(study_.reason(result, "source"), "its output stands");
}

TEST_F(RunnerTest, ChangedTrialsAndWiringAreReasons) {
  study_.run();
  EXPECT_EQ(study_.reason(study_.run({"scaled.trials=[\"a\", \"c\"]"}), "scaled"),
            "trials changed all -> a, c");
  study_.define(chain + "[[stage]]\nname = \"other\"\nrun = \"fake.source\"\nvalue = 9\n");
  EXPECT_EQ(
      study_.reason(study_.run({"scaled.input.signal=other", "scaled.trials=[\"a\", \"c\"]"}), "scaled"),
      "input signal reads `other` instead of `source`");
}

TEST_F(RunnerTest, DamagedAndForeignOutputsAreMadeAgain) {
  study_.run();
  const fs::path output = study_.folder / "run" / "02-scaled.h5";
  const std::string whole = file_text(output);
  write_file(output, whole.substr(0, whole.size() / 2));
  RunResult result = study_.run();
  EXPECT_EQ(study_.reason(result, "scaled"), "its output is unreadable");
  EXPECT_EQ(result.outcome, Outcome::done);
  fs::copy_file(study_.folder / "run" / "01-source.h5", output, fs::copy_options::overwrite_existing);
  EXPECT_THAT(study_.reason(study_.run(), "scaled"),
              HasSubstr("it ran as fake.source (version 1), now as fake.scale (version 1)"));
}

TEST_F(RunnerTest, OnlyRunsOneStageFromStoredInputs) {
  study_.request.only = "total";
  EXPECT_EQ(study_.run().outcome, Outcome::input_error);
  study_.request.only.reset();
  study_.run();
  study_.request.only = "total";
  const RunResult result = study_.run({"source.value=8"});  // not asked for: the stored output is used
  EXPECT_THAT(study_.watcher.began, ElementsAre("total"));
  EXPECT_EQ(study_.reason(result, "total"), "asked for with --only");
  EXPECT_EQ(study_.reason(result, "source"),
            "not asked for; its stored output is out of date: option value changed 3.0 -> 8.0");
}

TEST_F(RunnerTest, OnlyWithoutStoredInputsSaysWhatToRunFirst) {
  study_.request.only = "total";
  const RunResult result = study_.run();
  ASSERT_EQ(result.errors.size(), 1u);
  EXPECT_EQ(result.errors[0].code, "no-stored-output");
  EXPECT_EQ(result.errors[0].help, "run it first: --until scaled");
}

TEST_F(RunnerTest, UntilStopsThereAndFromRunsAgain) {
  study_.request.until = "scaled";
  study_.run();
  EXPECT_THAT(study_.watcher.began, ElementsAre("source", "scaled"));
  study_.request.until.reset();
  study_.request.from = "scaled";
  study_.run();
  EXPECT_THAT(study_.watcher.began, ElementsAre("scaled", "total"));
}

TEST_F(RunnerTest, MovedStageKeepsItsOutput) {
  study_.run();
  study_.define(
      "[pipeline]\ntitle = \"A chain\"\n[[stage]]\nname = \"new\"\nrun = \"fake.source\"\nvalue = 1\n" +
      chain.substr(chain.find("[[stage]]")));
  study_.run();
  EXPECT_THAT(study_.watcher.began, ElementsAre("new"));
  EXPECT_TRUE(fs::exists(study_.folder / "run" / "04-total.h5"));
  EXPECT_FALSE(fs::exists(study_.folder / "run" / "03-total.h5"));
}

TEST_F(RunnerTest, ResultsDoNotDependOnTheNumberOfThreads) {
  std::vector<std::vector<double>> means, samples;
  for (const std::size_t threads : {1u, 2u, 7u}) {
    study_.request.threads = threads;
    study_.request.out = study_.folder / ("run" + std::to_string(threads));
    const RunResult result = study_.run();
    const fs::path output = result.find("scaled")->output;
    means.push_back(io::read_stage_content(output).tables.at("means").numbers("mean"));
    samples.push_back(io::SessionFile(output).signal("c", "x").samples);
  }
  EXPECT_EQ(means[0], means[1]);
  EXPECT_EQ(means[0], means[2]);
  EXPECT_EQ(samples[0], samples[1]);
  EXPECT_EQ(samples[0], samples[2]);
}

TEST_F(RunnerTest, UnmatchedTrialsAreToldWithTheirPlace) {
  const RunResult result = study_.run({"scaled.trials=[\"z*\"]"});
  EXPECT_EQ(result.outcome, Outcome::input_error);
  EXPECT_EQ(result.failed_stage, "scaled");
  EXPECT_EQ(result.errors.at(0).message, "no trial of `source` matches `z*`");
  EXPECT_EQ(result.errors.at(0).where->file, "--set scaled.trials=[\"z*\"]");
  EXPECT_EQ(result.find("total")->status, StageStatus::skipped);
}

TEST_F(RunnerTest, SubjectIsAFileOfItsOwnThatOtherPipelinesRead) {
  study_.define(
      "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"source\"\nrun = \"fake.source\"\nvalue = 1\n"
      "[[stage]]\nname = \"who\"\nrun = \"fake.fit\"\ninput = { signal = \"source\" }\nforce_N = 612.0\n");
  study_.run();
  ASSERT_TRUE(fs::exists(study_.folder / "run" / "who.subject.toml"));
  const std::string predict =
      "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"source\"\nrun = \"fake.source\"\nvalue = 1\n"
      "[[stage]]\nname = \"forces\"\nrun = \"fake.predict\"\n"
      "input = { signal = \"source\", subject = \"file:run/who.subject.toml\" }\n"
      "[[expect]]\nstage = \"forces\"\ntable = \"forces\"\nrow = 0\ncolumn = \"force\"\nvalue = "
      "612\ntolerance = 1e-9\n";
  Study other(study_.folder);
  other.define(predict);
  other.request.out = study_.folder / "prediction";
  const RunResult result = other.run();
  EXPECT_EQ(result.outcome, Outcome::done);
  EXPECT_TRUE(result.expectations.at(0).passed);
  std::string subject = file_text(study_.folder / "run" / "who.subject.toml");
  subject.replace(subject.find("612"), 3, "700");
  write_file(study_.folder / "run" / "who.subject.toml", subject);
  const RunResult changed = other.run();
  EXPECT_EQ(other.reason(changed, "forces"), "input `file:who.subject.toml` has another content");
  EXPECT_EQ(changed.outcome, Outcome::expectation_failed);
}

TEST_F(RunnerTest, StorageFilesAreWrittenOnRequest) {
  study_.run({"scaled.export_sto=true"});
  EXPECT_THAT(file_text(study_.folder / "run" / "02-scaled-a.sto"), HasSubstr("endheader"));
  EXPECT_FALSE(fs::exists(study_.folder / "run" / "01-source-a.sto"));
}

TEST_F(RunnerTest, ExpectedNumbersFailTheRun) {
  const auto expect = [&](const std::string& lines) {
    study_.define(
        chain +
        "[[expect]]\nstage = \"total\"\ntable = \"total\"\nwhere = { what = \"all\" }\ncolumn = \"sum\"\n" +
        lines);
    return study_.run();
  };
  const double sum = [&] {
    study_.run();
    return io::read_stage_content(study_.folder / "run" / "03-total.h5")
        .tables.at("total")
        .numbers("sum")
        .at(0);
  }();
  EXPECT_EQ(expect("value = " + std::to_string(sum) + "\ntolerance = 1e-5\n").outcome, Outcome::done);
  const RunResult missed = expect("min = 1000\n");
  EXPECT_EQ(missed.outcome, Outcome::expectation_failed);
  EXPECT_EQ(exit_code(missed.outcome), 1);
  EXPECT_THAT(expectation_table(missed.expectations),
              HasSubstr("total/total[what=all].sum  at least 1000  "));
  EXPECT_THAT(expectation_table(missed.expectations), HasSubstr("FAILED"));
  EXPECT_EQ(study_.run({"expect=false"}).outcome, Outcome::done);
  EXPECT_EQ(study_.run({"expect.1.min=-1000"}).outcome, Outcome::done);
}

TEST(Expectation, AsksOneRowOrEveryRowOfATable) {
  StageData output;
  output.tables["folds"] = data::Table{"Folds",
                                       {{"parameter", "", std::vector<std::string>{"gain", "gain", "delay"}},
                                        {"at_bound", "1", std::vector<double>{0.0, 1.0, 3.0}}}};
  Expectation e;
  e.stage = "validation";
  e.table = "folds";
  e.column = "at_bound";
  e.where = {{"parameter", "gain"}};
  e.maximum = 2.0;
  EXPECT_EQ(check_expectation(e, &output).remark, "2 rows of `folds` are selected instead of one");
  e.every = true;
  EXPECT_TRUE(check_expectation(e, &output).passed);
  EXPECT_EQ(place_text(e), "validation/folds[parameter=gain, every row].at_bound");
  e.where.clear();
  EXPECT_FALSE(check_expectation(e, &output).passed);
  EXPECT_EQ(check_expectation(e, &output).found, 3.0);
  e.where = {{"parameter", "shape"}};
  EXPECT_EQ(check_expectation(e, &output).remark, "no row of `folds` is selected");
}

/// A description of two trials recorded as CSV.
class ImportTest : public ::testing::Test {
 protected:
  ImportTest() : study_(brachium::tests::scratch_dir()) {
    fs::create_directories(study_.folder / "here");
    write_file(study_.folder / "session.toml",
               "[session]\nsubject = \"s1\"\nrecordings = \"elsewhere\"\n[[trial]]\nname = \"{n}\"\nkind = "
               "\"test\"\neach = [{ n = \"a\" }, { n = \"b\" }]\n"
               "[[file]]\npath = \"{n}.csv\"\ntime = \"time\"\n[[file.signal]]\ncolumn = \"x\"\nname = "
               "\"x\"\nquantity = "
               "\"other\"\nunit = \"1\"\n");
    record("a", 1.0);
    record("b", 2.0);
    study_.define(
        "[pipeline]\ntitle = \"t\"\nsession = \"session.toml\"\n[[stage]]\nname = \"scaled\"\nrun = "
        "\"fake.scale\"\n");
  }
  void record(const std::string& trial, double value) const {
    std::string text = "time,x\n";
    for (int i = 0; i < 20; ++i) text += std::to_string(0.01 * i) + "," + std::to_string(value + i) + "\n";
    write_file(study_.folder / "here" / (trial + ".csv"), text);
  }
  std::string here() const { return "recordings=" + (study_.folder / "here").string(); }
  Study study_;
};

TEST_F(ImportTest, DescriptionIsImportedOnceAsTheStageSession) {
  const RunResult first = study_.run({here()});
  EXPECT_EQ(first.outcome, Outcome::done) << (first.errors.empty() ? "" : first.errors[0].message);
  EXPECT_THAT(study_.watcher.began, ElementsAre("session", "scaled"));
  EXPECT_TRUE(fs::exists(study_.folder / "run" / "00-session.h5"));
  EXPECT_THAT(file_text(study_.folder / "run" / "provenance.json"), HasSubstr("a.csv"));
  study_.run({here()});
  EXPECT_THAT(study_.watcher.began, IsEmpty());
}

TEST_F(ImportTest, ChangedRecordingIsAReason) {
  study_.run({here()});
  record("b", 7.0);
  const RunResult result = study_.run({here()});
  EXPECT_EQ(study_.reason(result, "session"), "the recording `b.csv` changed");
  EXPECT_EQ(study_.reason(result, "scaled"), "input `session` ran again");
}

TEST_F(ImportTest, MistakesOfTheDescriptionAreThoseOfThePipeline) {
  EXPECT_THAT(mistakes_of([&] { study_.run(); }), HasSubstr("error[missing-folder]"));
  EXPECT_THAT(mistakes_of([&] {
                study_.run({here(), "scaled.trials=[\"q\"]", "scaled.factor=-1"});
              }),
              ::testing::AllOf(HasSubstr("error[no-match]: no trial of the session matches `q`"),
                               HasSubstr("error[out-of-range]")));
}

TEST_F(ImportTest, ReportCanBeWrittenAgainFromTheResolvedDefinition) {
  study_.run({here()});
  fs::remove(study_.folder / "run" / "report.html");
  const Catalogue catalogue = fake_catalogue();
  write_report_again(catalogue, study_.folder / "run");
  EXPECT_THAT(file_text(study_.folder / "run" / "report.html"), HasSubstr("subject s1, 2 trials"));
}

TEST(Fingerprint, DiffersInEveryPart) {
  const Fingerprint one{{"a", "b"}}, two{{"a", "c"}}, three{{"ab", ""}}, four{{"a", "b"}, {"c", "d"}};
  EXPECT_NE(digest(one), digest(two));
  EXPECT_NE(digest(one), digest(three));
  EXPECT_NE(digest(one), digest(four));
  EXPECT_EQ(difference_text({{"program", "1"}}, {{"program", "2"}}), "the program changed 1 -> 2");
  EXPECT_EQ(difference_text({{"scene", "1"}}, {{"scene", "2"}}), "the scene changed");
  EXPECT_EQ(difference_text({{"file.a.csv", "1"}}, {{"file.a.csv", "2"}}), "the recording `a.csv` changed");
}

}  // namespace
}  // namespace brachium::pipelines::tests
