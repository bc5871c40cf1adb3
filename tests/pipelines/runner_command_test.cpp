// The commands beside `run`, and that every code of a finding is explained.

#include <gmock/gmock.h>

#include <chrono>
#include <regex>
#include <set>
#include <sstream>
#include <thread>

#include "pipelines/command_line.hpp"
#include "pipelines/describe.hpp"
#include "pipelines/error_codes.hpp"
#include "pipelines/progress.hpp"
#include "runner_fake_stages.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class CommandTest : public ::testing::Test {
 protected:
  CommandTest() : folder_(brachium::tests::scratch_dir()) { write_file(folder_ / "study.toml", chain); }
  int call(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "brachium");
    std::vector<const char*> argv;
    for (const std::string& a : arguments) argv.push_back(a.c_str());
    std::ostringstream out, err;
    const int code = command_line(static_cast<int>(argv.size()), argv.data(), fake_catalogue(),
                                  {out, err, false, nullptr});
    out_ = out.str();
    err_ = err.str();
    return code;
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  const fs::path folder_;
  std::string out_, err_;
};

TEST_F(CommandTest, CheckFindsMistakesWithoutRunning) {
  EXPECT_EQ(call({"check", path("study.toml")}), 0);
  EXPECT_THAT(out_, HasSubstr("3 stages, no mistakes"));
  EXPECT_EQ(call({"check", path("study.toml"), "--set", "scaled.factor=-1"}), 2);
  EXPECT_THAT(err_, HasSubstr("error[out-of-range]: `factor` = -1"));
}

TEST_F(CommandTest, ExplainTellsOfStagesAndCodes) {
  EXPECT_EQ(call({"explain", "fake.scale"}), 0);
  EXPECT_THAT(
      out_, AllOf(HasSubstr("fake.scale: a stage for tests"),
                  HasSubstr("signal  (signals; the session where not wired)"), HasSubstr("lowpass_hz = 6.0"),
                  HasSubstr("number [Hz], greater than 0 Hz."), HasSubstr("one of plain, fancy")));
  EXPECT_EQ(call({"explain", "unknown-key"}), 0);
  EXPECT_THAT(out_, HasSubstr("unknown-key: "));
  EXPECT_EQ(call({"explain", "fake.scal"}), 2);
  EXPECT_THAT(err_, HasSubstr("did you mean `fake.scale`?"));
}

TEST_F(CommandTest, ManualAndListHoldEveryStage) {
  EXPECT_EQ(call({"manual"}), 0);
  for (const std::string& name : fake_catalogue().names()) EXPECT_THAT(out_, HasSubstr("## " + name + "\n"));
  EXPECT_THAT(out_, HasSubstr("| `bounds.upper` | number | `required` |"));
  EXPECT_EQ(call({"stages"}), 0);
  EXPECT_THAT(out_, HasSubstr("fake.scale    a stage for tests\n"));
}

TEST_F(CommandTest, InspectTellsWhatAFileHolds) {
  ASSERT_EQ(call({"run", path("study.toml"), "--out", path("run"), "--quiet"}), 0) << err_;
  EXPECT_EQ(call({"inspect", path("run/02-scaled.h5")}), 0);
  EXPECT_THAT(out_, AllOf(HasSubstr("stage output"), HasSubstr("trial a (test)"),
                          HasSubstr("50 samples at 100 Hz"), HasSubstr("table means"),
                          HasSubstr("made from option.factor: 2.0"), HasSubstr("warning[fake-warning]")));
  EXPECT_EQ(call({"inspect", path("run")}), 0);
  EXPECT_THAT(out_, HasSubstr("scaled"));
  EXPECT_EQ(call({"inspect", path("study.toml")}), 0);
  EXPECT_THAT(out_, HasSubstr("02 scaled (fake.scale)  signal <- source"));
  EXPECT_EQ(call({"inspect", path("nothing.h5")}), 2);
  EXPECT_EQ(call({"inspect", path("run/report.html")}), 2);
  EXPECT_THAT(err_, HasSubstr("error[unknown-file]"));
}

TEST_F(CommandTest, CompareFindsDifferencesOfRuns) {
  ASSERT_EQ(call({"run", path("study.toml"), "--out", path("a"), "--quiet"}), 0);
  ASSERT_EQ(call({"run", path("study.toml"), "--out", path("b"), "--quiet"}), 0);
  EXPECT_EQ(call({"compare", path("a"), path("b")}), 0);
  EXPECT_EQ(out_, "no differences\n");
  ASSERT_EQ(call({"run", path("study.toml"), "--out", path("b"), "--quiet", "--set", "scaled.factor=3"}), 0);
  EXPECT_EQ(call({"compare", path("a"), path("b")}), 0);
  EXPECT_THAT(out_, AllOf(HasSubstr("made differently: option factor changed 2.0 -> 3.0"),
                          HasSubstr("means.mean: 3 of 3 rows differ")));
  EXPECT_EQ(call({"compare", path("a"), path("nothing")}), 2);
}

TEST_F(CommandTest, ReportIsWrittenAgain) {
  ASSERT_EQ(call({"run", path("study.toml"), "--out", path("a"), "--quiet"}), 0);
  fs::remove(folder_ / "a" / "report.html");
  EXPECT_EQ(call({"report", path("a")}), 0) << err_;
  EXPECT_THAT(file_text(folder_ / "a" / "report.html"), HasSubstr("the sum is there"));
}

TEST_F(CommandTest, QuietRunsAreQuietAndOthersSayWhy) {
  call({"run", path("study.toml"), "--out", path("a"), "--quiet"});
  EXPECT_EQ(err_, "");
  call({"run", path("study.toml"), "--out", path("a"), "--set", "scaled.factor=3"});
  EXPECT_THAT(err_, AllOf(HasSubstr("source reused: its output stands\n"),
                          HasSubstr("[2/3] scaled (fake.scale): option factor changed 2.0 -> 3.0\n"),
                          HasSubstr("warning[fake-warning]")));
  EXPECT_THAT(out_, HasSubstr("report: "));
}

TEST(Progress, IsOneLineWrittenOverOnATerminalAndPlainLinesElsewhere) {
  StageRecord stage;
  stage.name = "fit";
  stage.run = "fake.fit";
  stage.reason = "no output yet";
  stage.status = StageStatus::done;
  stage.seconds = 1.2;
  std::ostringstream terminal, file, nothing;
  ProgressPrinter on_terminal(terminal, true, false), in_file(file, false, false), quiet(nothing, true, true);
  for (ProgressPrinter* p : {&on_terminal, &in_file, &quiet}) {
    p->stage_begins(stage, 1, 2);
    p->stage_progress(stage, 0.01, "trial a");  // nothing in the first second
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  for (ProgressPrinter* p : {&on_terminal, &in_file, &quiet}) {
    p->stage_progress(stage, 0.5, "trial b");
    p->stage_ends(stage, {});
  }
  const std::string begin = "[1/2] fit (fake.fit): no output yet\n", end = "  fit done in 1.2\u202fs\n";
  EXPECT_THAT(terminal.str(), AllOf(::testing::StartsWith(begin + "\r\x1b[K  fit   50 %  1."),
                                    ::testing::EndsWith("\u202fs left  trial b\r\x1b[K" + end)));
  EXPECT_EQ(file.str(), begin + end);  // there, a line every ten seconds
  EXPECT_EQ(nothing.str(), "");
}

TEST(ErrorCodes, EveryCodeInTheSourcesIsExplained) {
  // Codes are kebab-case; every such text in the sources is one, but for these. Codes of one word stand as
  // arguments of InputError or beside a severity.
  const std::set<std::string> others{"brachium-session", "brachium-subject", "ft-lb", "multi-start"};
  const std::vector<std::regex> patterns{
      std::regex(R"rx("([a-z0-9]+(?:-[a-z0-9]+)+)")rx"),
      std::regex(R"rx(InputError[({]\s*"([a-z0-9]+(?:-[a-z0-9]+)*)")rx"),
      std::regex(R"rx(Severity::(?:error|warning|note),\s*"([a-z0-9]+(?:-[a-z0-9]+)*)")rx")};
  const std::regex trial_name("(ramp|hold|sweep|curl|random|mvc)-[0-9]+");
  std::set<std::string> unexplained;
  std::size_t found = 0;
  for (const char* folder : {"data", "emg", "fem", "hill", "optimise", "pipelines"}) {
    for (const auto& entry : fs::recursive_directory_iterator(brachium::tests::source_dir() / folder)) {
      const std::string path = entry.path().generic_string();
      // The report's names are those of HTML and style sheets.
      if (entry.path().extension() != ".cpp" || path.find("/pipelines/report/") != std::string::npos)
        continue;
      const std::string text = file_text(entry.path());
      for (const std::regex& pattern : patterns) {
        for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
          ++found;
          const std::string code = (*match)[1];
          const bool severity =
              code == "error" || code == "warning" || code == "note";  // names of the severities
          if (severity || others.contains(code) || std::regex_match(code, trial_name) || explain_error(code))
            continue;
          unexplained.insert(code + " in " + entry.path().filename().string());
        }
      }
    }
  }
  EXPECT_GT(found, 100u);
  EXPECT_THAT(unexplained, ::testing::IsEmpty()) << "add a sentence to pipelines/error_code_list.cpp";
}

TEST(ErrorCodes, AreSortedAndUnique) {
  const auto& all = error_codes();
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_LT(all[i - 1].code, all[i].code);
  for (const ErrorCode& code : all) EXPECT_EQ(code.meaning.back(), '.') << code.code;
}

}  // namespace
}  // namespace brachium::pipelines::tests
