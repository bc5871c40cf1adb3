// A run that is killed or runs out of disk at any moment, and is then started again, ends as one that was left alone.

#include <gmock/gmock.h>

#include <chrono>
#include <map>
#include <thread>

#include "data/io/stage_file.hpp"
#include "runner_child.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

// Signals in parallel trials, an export, a subject with its own file, tables, a report.
const std::string study =
    "[pipeline]\ntitle = \"t\"\n"
    "[[stage]]\nname = \"source\"\nrun = \"fake.source\"\nvalue = 1\ncount = 4000\n"
    "[[stage]]\nname = \"scaled\"\nrun = \"fake.scale\"\ninput = { signal = \"source\" }\nexport_sto = true\n"
    "[[stage]]\nname = \"fit\"\nrun = \"fake.fit\"\ninput = { signal = \"scaled\" }\n"
    "[[stage]]\nname = \"forces\"\nrun = \"fake.predict\"\ninput = { signal = \"scaled\", subject = \"fit\" "
    "}\n"
    "[[stage]]\nname = \"total\"\nrun = \"fake.sum\"\ninput = { parts = [\"scaled\"] }\n";

class RecoveryTest : public ::testing::Test {
 protected:
  RecoveryTest() : folder_(brachium::tests::scratch_dir()) {
    write_file(folder_ / "study.toml", study);
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(start("alone").wait(), 0);
    whole_ = std::chrono::steady_clock::now() - begin;
  }

  Child start(const std::string& out, rlim_t file_limit = RLIM_INFINITY) const {
    return Child(folder_, {"run", "study.toml", "--out", out}, file_limit);
  }

  /// The run in `out`, started again, is the one that was left alone.
  void expect_recovery(const std::string& out, const std::string& what) const {
    const Child again = start(out);
    ASSERT_EQ(again.wait(), 0) << what << again.err();
    for (const auto& entry : fs::directory_iterator(folder_ / out))
      EXPECT_EQ(entry.path().filename().string().find(".partial"), std::string::npos) << what << entry.path();
    std::size_t compared = 0;
    for (const auto& entry : fs::directory_iterator(folder_ / "alone")) {
      const fs::path name = entry.path().filename(), other = folder_ / out / name;
      ASSERT_TRUE(fs::exists(other)) << what << name;
      if (name.extension() == ".sto" || name == "definition.toml") {
        EXPECT_EQ(file_text(other), file_text(entry.path())) << what << name;
      } else if (name.extension() == ".h5") {
        expect_same_content(entry.path(), other, what);
      } else {
        continue;
      }
      ++compared;
    }
    EXPECT_EQ(compared, 5u + 3u + 1u);
    EXPECT_THAT(file_text(folder_ / out / "result.json"), HasSubstr("\"outcome\": \"done\"")) << what;
    EXPECT_THAT(file_text(folder_ / out / "report.html"), HasSubstr("</html>")) << what;
    EXPECT_EQ(without_comments(file_text(folder_ / out / "fit.subject.toml")),
              without_comments(file_text(folder_ / "alone" / "fit.subject.toml")))
        << what;
  }

  std::chrono::duration<double> whole_{};
  const fs::path folder_;

 private:
  static void expect_same_content(const fs::path& a, const fs::path& b, const std::string& what) {
    const io::StageFileContent one = io::read_stage_content(a), two = io::read_stage_content(b);
    ASSERT_EQ(one.tables.size(), two.tables.size()) << what << b;
    for (const auto& [name, table] : one.tables) {
      for (const data::Column& column : table.columns)
        EXPECT_TRUE(column.values == two.tables.at(name).column(column.name).values) << what << b << name;
    }
    const io::SessionFile first(a), second(b);
    ASSERT_EQ(first.info().trials.size(), second.info().trials.size()) << what << b;
    for (std::size_t t = 0; t < first.info().trials.size(); ++t) {
      ASSERT_EQ(first.info().trials[t].signals.size(), second.info().trials[t].signals.size()) << what << b;
      for (std::size_t s = 0; s < first.info().trials[t].signals.size(); ++s)
        EXPECT_EQ(first.read(t, s), second.read(t, s)) << what << b;
    }
  }

  /// A comment may carry the moment of writing.
  static std::string without_comments(const std::string& text) {
    std::string kept;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
      if (!line.starts_with("#")) kept += line + "\n";
    return kept;
  }
};

TEST_F(RecoveryTest, KilledAtAnyMoment) {
  constexpr int moments = 30;
  int killed = 0;
  for (int i = 0; i < moments; ++i) {
    const std::string out = "run-" + std::to_string(i), what = "killed at moment " + std::to_string(i) + ": ";
    const Child run = start(out);
    std::this_thread::sleep_for(whole_ * (i + 0.5) / moments);
    run.send(SIGKILL);
    killed += run.wait() == -SIGKILL;
    expect_recovery(out, what);
    fs::remove_all(folder_ / out);
  }
  EXPECT_GT(killed, moments / 3);  // the machine may be faster now than before, but not so much
}

TEST_F(RecoveryTest, OutOfDiskAtAnyFile) {
  int failed = 0;
  for (rlim_t limit = 16; limit < (rlim_t{1} << 20); limit = limit * 3 / 2) {
    const std::string out = "run-" + std::to_string(limit), what = std::to_string(limit) + " bytes: ";
    const Child run = start(out, limit);
    const int code = run.wait();
    if (code != 0) {
      ++failed;
      EXPECT_EQ(code, 2) << what << run.err();
      if (limit > 1000) {
        EXPECT_THAT(run.err(), HasSubstr("error[write-failed]")) << what;
      }
    }
    expect_recovery(out, what);
    fs::remove_all(folder_ / out);
  }
  EXPECT_GT(failed, 10);
}

}  // namespace
}  // namespace brachium::pipelines::tests
