#include "data/io/session_description.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::error_of;
using tests::scratch_dir;
using tests::write_file;

/// A folder with two trials of one CSV file each.
struct Study {
  std::filesystem::path dir = scratch_dir();

  Study() {
    write_file(dir / "rec/a-10/run 1.csv",
               "time,emg1,emg2,angle\ns,uV,uV,deg\n0,1,10,90\n0.5,2,20,45\n1,-3,30,0\n");
    write_file(dir / "rec/b-20/run 1.csv",
               "time,emg1,emg2,angle\ns,uV,uV,deg\n0,4,40,9\n0.5,5,50,18\n1,6,60,27\n");
  }

  std::string head = R"([session]
subject = "s1"
recordings = "rec"
body_mass_kg = 70

[[trial]]
name = "{group}"
kind = "{kind}"
each = [ { group = "a", load = 10, kind = "mvc" }, { group = "b", load = 20, kind = "test" } ]
conditions = { load_mass = { value = "{load}", unit = "lb" }, cadence_hz = 0.5 }
)";
  std::string files = R"(
[[file]]
path = "*-{load}/run 1.csv"
units_row = 2
time = "time"
  [[file.signal]]
  column = "emg1"
  name = "biceps"
  quantity = "emg"
  muscle = "biceps brachii"
  [[file.signal]]
  column = "angle"
  name = "elbow"
  quantity = "joint_angle"
  coordinate = "elbow_flexion"
  sign = -1
  offset = 0.25
)";

  SessionDescription read(const std::map<std::string, std::string>& overrides = {}) const {
    return read_session_description(write_file(dir / "s.toml", head + files), overrides);
  }
  std::string error(const std::map<std::string, std::string>& overrides = {}) const {
    return error_of(
        [&] {
          data::MemorySession memory;
          import_session(read(overrides), memory);
        },
        dir);
  }
  data::Session import(std::string* warnings = nullptr) const {
    data::MemorySession memory;
    const auto found = import_session(read(), memory);
    if (warnings) *warnings = data::render(found);
    return memory.session();
  }
};

TEST(SessionDescription, OneShortFileDescribesAllTrials) {
  const data::Session session = Study().import();
  EXPECT_EQ(session.subject, "s1");
  EXPECT_EQ(session.anthropometry.at("body_mass_kg"), 70.0);
  ASSERT_EQ(session.trials.size(), 2u);
  EXPECT_EQ(session.trials[0].kind, data::TrialKind::mvc);
  EXPECT_EQ(session.trials[1].kind, data::TrialKind::test);
  EXPECT_DOUBLE_EQ(session.trials[1].conditions.at("load_mass_kg"), 20.0 * 0.45359237);
  EXPECT_EQ(session.trials[1].conditions.at("cadence_hz"), 0.5);
  const data::Signal& biceps = session.trial("a").signal("biceps");
  EXPECT_EQ(biceps.info.unit, "V");
  EXPECT_EQ(biceps.info.rate_hz, 2.0);
  EXPECT_EQ(biceps.info.muscle, "biceps brachii");
  EXPECT_THAT(biceps.samples, ElementsAre(1e-6, 2e-6, -3e-6));
  const data::Signal& elbow = session.trial("a").signal("elbow");
  EXPECT_NEAR(elbow.samples[0], -M_PI / 2.0 + 0.25, 1e-15);
  EXPECT_EQ(elbow.info.attributes.at("source_file"), "a-10/run 1.csv");
  EXPECT_EQ(elbow.info.attributes.at("source_scale"), "-1");
}

TEST(SessionDescription, OneNameWithTheColumnInItTakesAllColumns) {
  Study study;
  study.files =
      "[[file]]\npath = \"*-{load}/run 1.csv\"\ntime = \"time\"\nunits_row = 2\nname = \"{trial} {column}\"\n"
      "columns = [\"emg2\", \"emg1\"]\nquantity = \"emg\"\ntime_offset_s = 2.5\n";
  const data::Session session = study.import();
  EXPECT_EQ(session.trials[1].signals[0].info.name, "b emg2");
  EXPECT_EQ(session.trials[1].signals[1].info.name, "b emg1");
  EXPECT_EQ(session.trials[1].signals[1].info.start_time_s, 2.5);
}

TEST(SessionDescription, OverridesReplaceKeysAndAreCheckedLikeThem) {
  const Study study;
  std::filesystem::rename(study.dir / "rec", study.dir / "elsewhere");
  data::MemorySession memory;
  import_session(
      study.read({{"recordings", (study.dir / "elsewhere").string()}, {"session.body_mass_kg", "81.5"}}),
      memory);
  EXPECT_EQ(memory.info().anthropometry.at("body_mass_kg"), 81.5);
  EXPECT_EQ(study.error({{"recordngs", "x"}}),
            "error[unknown-key]: `recordngs` is not a key of `session`\n  --> --set\n  help: did you mean "
            "`recordings`?\n");
}

TEST(SessionDescription, EveryMistakeIsReportedAtOnceWithItsPlace) {
  Study study;
  study.head.replace(study.head.find("recordings"), 10, "recordngs");
  study.files =
      "[[file]]\npath = \"x.csv\"\nformat = \"cvs\"\ntime = \"time\"\nname = \"n\"\nquantity = "
      "\"emgg\"\nunit = \"uVV\"\nsign = 2\n";
  EXPECT_EQ(study.error(),
            "error[unknown-key]: `recordngs` is not a key of `session`\n  --> s.toml:3:1\n  |\n3 | recordngs "
            "= \"rec\"\n"
            "  | ^^^^^^^^^ did you mean `recordings`?\n"
            "error[unknown-format]: `cvs` is not a format that can be read\n  --> s.toml:13:10\n   |\n13 | "
            "format = \"cvs\"\n"
            "   |          ^^^^^ did you mean `csv`?\n"
            "error[unknown-quantity]: `emgg` is not a quantity a signal can have\n  --> s.toml:16:12\n   "
            "|\n16 | quantity = \"emgg\"\n"
            "   |            ^^^^^^ did you mean `emg`?\n"
            "error[unknown-unit]: `uVV` is not a unit Brachium knows\n  --> s.toml:17:8\n   |\n17 | unit = "
            "\"uVV\"\n"
            "   |        ^^^^^ did you mean `uV`?\n"
            "error[out-of-range]: `sign` must be 1 or -1, not 2\n  --> s.toml:18:8\n   |\n18 | sign = 2\n   "
            "|        ^\n");
}

TEST(SessionDescription, FilesThatAreMissingOrAmbiguousAreNamedForAllTrials) {
  Study study;
  std::filesystem::rename(study.dir / "rec/a-10/run 1.csv", study.dir / "rec/a-10/run 2.csv");
  std::filesystem::copy(study.dir / "rec/b-20", study.dir / "rec/c-20");
  const std::string place =
      "  --> s.toml:13:8\n   |\n13 | path = \"*-{load}/run 1.csv\"\n   |        ^^^^^^^^^^^^^^^^^^^^ ";
  EXPECT_EQ(study.error(), "error[missing-file]: trial `a`: there is no file `*-10/run 1.csv`\n" + place +
                               "no `run 1.csv` in `a-10`; did you mean `run 2.csv`?\n"
                               "error[ambiguous-file]: trial `b`: 2 files match `*-20/run 1.csv`\n" +
                               place + "b-20/run 1.csv | c-20/run 1.csv\n");
}

TEST(SessionDescription, ColumnsUnitsAndNamesAreCheckedAgainstTheFiles) {
  Study study;
  const std::string start =
      "[[file]]\npath = \"a-10/run 1.csv\"\ntrials = \"a\"\ntime = \"time\"\nunits_row = 2\n";
  study.files = start + "column = \"emg3\"\nname = \"n\"\nquantity = \"emg\"\n";
  EXPECT_EQ(study.error(),
            "error[missing-column]: `rec/a-10/run 1.csv` has no column `emg3`\n  --> s.toml:17:8\n   |\n17 | "
            "name = \"n\"\n"
            "   |        ^^^ did you mean `emg1`?\n");
  study.files = start + "column = \"emg1\"\nname = \"n\"\nquantity = \"joint_angle\"\n";
  EXPECT_THAT(
      study.error(),
      HasSubstr("error[wrong-unit]: column `emg1` of `a-10/run 1.csv` is in `uV`, a unit of voltage, but "
                "`joint_angle` needs a unit of angle\n"));
  study.files = start + "column = \"emg1\"\nname = \"n\"\nunit = \"mV\"\nquantity = \"emg\"\n";
  EXPECT_THAT(
      study.error(),
      HasSubstr(
          "error[wrong-unit]: column `emg1` of `a-10/run 1.csv` is in `uV`, the description says `mV`\n"));
  study.files = start + "columns = [\"emg1\", \"emg2\"]\nname = \"n\"\nquantity = \"emg\"\n";
  EXPECT_THAT(study.error(), HasSubstr("error[duplicate-signal]: trial `a` has two signals `n`\n"));
  study.files = start + "name = \"n\"\nquantity = \"emg\"\n";
  EXPECT_THAT(
      study.error(),
      HasSubstr("error[ambiguous-column]: `rec/a-10/run 1.csv` has 3 columns, but one signal is named\n"));
  study.files =
      "[[file]]\npath = \"a-10/run 1.csv\"\ntrials = \"a\"\ntime = \"time\"\nfirst_data_row = 3\ncolumn = "
      "\"emg1\"\nname = \"n\"\nquantity = \"emg\"\n";
  EXPECT_THAT(study.error(),
              HasSubstr("error[missing-unit]: the unit of column `emg1` of `a-10/run 1.csv` is not known\n"));
  study.files = start + "column = \"emg1\"\nname = \"{grp}\"\nquantity = \"emg\"\n";
  EXPECT_THAT(study.error(), HasSubstr("error[unknown-variable]: `{grp}` is not a variable of this trial\n"));
  study.files = start +
                "column = \"emg1\"\nname = \"n\"\nquantity = \"emg\"\n[[file]]\npath = \"x\"\ntrials = "
                "\"z*\"\nrate_hz = 1\nname = \"n\"\nquantity = \"emg\"\n";
  EXPECT_THAT(study.error(), HasSubstr("error[no-match]: no trial matches `z*`\n"));
}

TEST(SessionDescription, MistakesInTheSamplesOfAllFilesAreReportedAtOnce) {
  Study study;
  write_file(study.dir / "rec/a-10/run 1.csv", "time,emg1,angle\ns,uV,deg\n0,1,2\n0.5,nan,2\n");
  write_file(study.dir / "rec/b-20/run 1.csv", "time,emg1,angle\ns,uV,deg\n0,1,2\n0.5,2,2\n0.25,2,2\n");
  EXPECT_EQ(
      study.error(),
      "error[non-finite-sample]: column `emg1` has `nan`\n  --> rec/a-10/run 1.csv:4:5\n  |\n4 | 0.5,nan,2\n"
      "  |     ^^^ mend or cut the recording; Brachium does not replace samples\n"
      "error[time-backwards]: time goes back from 0.5 s to 0.25 s\n  --> rec/b-20/run 1.csv:5\n"
      "  help: sort the rows, or cut the recording where its clock was reset\n");
}

TEST(SessionDescription, AConstantChannelIsAWarning) {
  Study study;
  write_file(study.dir / "rec/a-10/run 1.csv", "time,emg1,angle\ns,uV,deg\n0,7,2\n0.5,7,3\n");
  std::string warnings;
  study.import(&warnings);
  EXPECT_THAT(warnings,
              HasSubstr("warning[constant-signal]: signal `biceps` of trial `a` never changes from 7 uV\n"));
}

TEST(SessionDescription, AFullSinkIsNotAMistakeOfTheRecording) {
  struct Full final : data::SessionSink {
    void begin(const data::SessionInfo&) override {}
    void begin_trial(const data::TrialInfo&) override {}
    void begin_signal(const std::string&, const data::SignalInfo&) override {}
    void write_samples(const std::string&, const std::string&, std::size_t,
                       std::span<const double>) override {
      throw data::InputError("write-failed", "the disk is full");
    }
  } full;
  EXPECT_EQ(error_of([&] { import_session(Study().read(), full); }),
            "error[write-failed]: the disk is full\n");
}

TEST(SessionDescription, CheckFindsWhatTheHeadersTell) {
  Study study;
  EXPECT_TRUE(check_session(study.read()).empty());
  study.files += "  [[file.signal]]\n  column = \"torque\"\n  name = \"t\"\n  quantity = \"joint_moment\"\n";
  EXPECT_THAT(error_of([&] { check_session(study.read()); }, study.dir),
              HasSubstr("`rec/b-20/run 1.csv` has no column `torque`"));
}

}  // namespace
}  // namespace brachium::io
