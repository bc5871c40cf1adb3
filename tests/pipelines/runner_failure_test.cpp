// Killed, stopped, out of space, refused: nothing half-written is ever trusted, and exit codes tell what
// happened.

#include <gmock/gmock.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "pipelines/run_folder.hpp"
#include "runner_child.hpp"
#include "runner_fake_stages.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

bool has_partial(const fs::path& folder) {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    if (entry.path().filename().string().find("02-slow.h5.partial-") != std::string::npos) return true;
  }
  return false;
}

const std::string with_slow =
    "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"first\"\nrun = \"fake.source\"\nvalue = "
    "1\n[[stage]]\nname = \"slow\"\nrun = \"fake.slow\"\n";

class FailureTest : public ::testing::Test {
 protected:
  FailureTest() : folder_(brachium::tests::scratch_dir()) {}
  void define(const std::string& text) const { write_file(folder_ / "study.toml", text); }
  Child start(std::vector<std::string> more = {}, rlim_t file_limit = RLIM_INFINITY) const {
    std::vector<std::string> arguments{"run", "study.toml", "--out", "run"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return Child(folder_, arguments, file_limit);
  }
  void wait_for_slow_stage() const {
    for (int i = 0; i < 1000 && !has_partial(folder_ / "run"); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_TRUE(has_partial(folder_ / "run"));
  }
  const fs::path folder_;
};

TEST_F(FailureTest, AKilledRunGoesOnWhereItStopped) {
  define(with_slow);
  const Child killed = start();
  wait_for_slow_stage();
  killed.send(SIGKILL);
  EXPECT_EQ(killed.wait(), -SIGKILL);
  EXPECT_FALSE(fs::exists(folder_ / "run" / "02-slow.h5"));
  const Child again = start({"--set", "slow.seconds=0"});
  EXPECT_EQ(again.wait(), 0) << again.err();
  EXPECT_THAT(again.err(), HasSubstr("was killed; going on where it stopped"));
  EXPECT_THAT(again.err(), HasSubstr("first reused: its output stands"));
  EXPECT_THAT(again.err(), HasSubstr("slow (fake.slow): no output yet"));
  EXPECT_FALSE(has_partial(folder_ / "run"));
}

TEST_F(FailureTest, AStoppedRunEndsInOrder) {
  define(with_slow);
  const Child stopped = start();
  wait_for_slow_stage();
  stopped.send(SIGINT);
  EXPECT_EQ(stopped.wait(), 130);
  EXPECT_THAT(stopped.err(), HasSubstr("error[interrupted]: the run was stopped in stage `slow`"));
  EXPECT_FALSE(has_partial(folder_ / "run"));
  EXPECT_FALSE(fs::exists(folder_ / "run" / "02-slow.h5"));
  EXPECT_THAT(file_text(folder_ / "run" / "result.json"), HasSubstr("\"outcome\": \"interrupted\""));
}

TEST_F(FailureTest, TwoRunsInOneFolderExcludeEachOther) {
  define(with_slow);
  const Child first = start();
  wait_for_slow_stage();
  const Child second = start();
  EXPECT_EQ(second.wait(), 2);
  EXPECT_THAT(second.err(), HasSubstr("error[run-in-progress]: process "));
  first.send(SIGKILL);
  first.wait();
}

TEST_F(FailureTest, AFullDiskLeavesNothingThatIsTrusted) {
  define(
      "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"big\"\nrun = \"fake.source\"\nvalue = 0.1\ncount = "
      "200000\n");
  const Child full = start({}, rlim_t{60000});
  EXPECT_EQ(full.wait(), 2) << full.err();
  EXPECT_THAT(full.err(), HasSubstr("error[write-failed]"));
  EXPECT_FALSE(fs::exists(folder_ / "run" / "01-big.h5"));
  const Child again = start();
  EXPECT_EQ(again.wait(), 0) << again.err();
  EXPECT_THAT(again.err(), HasSubstr("big (fake.source): no output yet"));
}

TEST_F(FailureTest, AFolderThatCannotBeMadeIsTold) {
  define(chain);
  write_file(folder_ / "run", "a file is in the way");
  const Child refused = start();
  EXPECT_EQ(refused.wait(), 2);
  EXPECT_THAT(refused.err(), HasSubstr("error[cannot-write]: cannot make the run folder `"));
}

TEST_F(FailureTest, AFolderThatCannotBeWrittenToIsTold) {
  // A folder of the kernel's: not even root may write there.
  if (!fs::is_directory("/sys/kernel")) GTEST_SKIP() << "no folder that is read-only for everybody";
  define(chain);
  const Child refused(folder_, {"run", "study.toml", "--out", "/sys/kernel"});
  EXPECT_EQ(refused.wait(), 2);
  EXPECT_THAT(refused.err(), ::testing::MatchesRegex(
                                 "error.cannot-write.: cannot write to the run folder `/sys/kernel`: .*\n"
                                 "  help: choose another with --out\n"));
}

TEST_F(FailureTest, ExitCodesTellWhatWentWrong) {
  define(chain + "[[stage]]\nname = \"bad\"\nrun = \"fake.fail\"\ninput = { signal = \"source\" }\n");
  const Child input = start();
  EXPECT_EQ(input.wait(), 2);
  EXPECT_THAT(
      input.err(),
      HasSubstr(
          "stage `bad` failed\nerror[bad-signal]: the signal `x` is no good\n  help: record it again\n"));
  const Child numbers = start({"--set", "bad.how=numbers"});
  EXPECT_EQ(numbers.wait(), 1);
  EXPECT_THAT(numbers.err(), HasSubstr("error[no-convergence]: trial `a`: the step became too small (after 7 "
                                       "iterations, residual 0.5, step 1e-09, worst: BIC)"));
  const Child defect = start({"--set", "bad.how=defect"});
  EXPECT_EQ(defect.wait(), 1);
  EXPECT_THAT(defect.err(), HasSubstr("error[internal-error]: stage `bad` broke down: index 7"));
  // What was done before the failure is kept, and the report tells of the failure.
  EXPECT_TRUE(fs::exists(folder_ / "run" / "03-total.h5"));
  EXPECT_THAT(file_text(folder_ / "run" / "report.html"), HasSubstr("broke down"));
}

TEST_F(FailureTest, AMissedExpectationIsExitCodeOne) {
  define(chain + "[[expect]]\nstage = \"total\"\ntable = \"total\"\nrow = 0\ncolumn = \"sum\"\nmin = 1000\n");
  const Child run = start();
  EXPECT_EQ(run.wait(), 1);
  EXPECT_THAT(run.err(), HasSubstr("total/total[row 0].sum"));
}

TEST_F(FailureTest, JsonIsAllThatStandardOutputGets) {
  define(chain);
  const Child run = start({"--json", "--quiet"});
  EXPECT_EQ(run.wait(), 0);
  const auto result = nlohmann::json::parse(run.out());
  EXPECT_EQ(result.at("outcome"), "done");
  EXPECT_EQ(result.at("exit_code"), 0);
  EXPECT_EQ(result.at("stages").size(), 3u);
  EXPECT_EQ(result.at("stages").at(1).at("status"), "done");
  EXPECT_EQ(result.at("verdict"), "the sum is there");
  define(chain + "[[stage]]\n");
  const Child wrong = start({"--json", "--quiet"});
  EXPECT_EQ(wrong.wait(), 2);
  EXPECT_EQ(nlohmann::json::parse(wrong.out()).at("errors").at(0).at("code"), "missing-key");
}

TEST_F(FailureTest, WrongUseOfTheCommandLineIsExitCodeTwo) {
  EXPECT_EQ(Child(folder_, {"run"}).wait(), 2);
  EXPECT_EQ(Child(folder_, {"dance"}).wait(), 2);
  EXPECT_EQ(Child(folder_, {"--help"}).wait(), 0);
  EXPECT_EQ(Child(folder_, {"run", "none.toml"}).wait(), 2);
}

}  // namespace
}  // namespace brachium::pipelines::tests
