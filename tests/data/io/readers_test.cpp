#include <gmock/gmock.h>

#include <cmath>

#include "data/io/csv.hpp"
#include "data/io/noraxon.hpp"
#include "data/io/opensim_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using tests::error_of;
using tests::scratch_dir;
using tests::write_file;

std::vector<data::Signal> read_csv(const std::string& text, const CsvLayout& layout) {
  Recording recording = open_csv(write_file(scratch_dir() / "a.csv", text), layout);
  return read_all(recording);
}

std::string csv_error(const std::string& text, CsvLayout layout = {.time_column = "time"}) {
  const auto dir = scratch_dir();
  write_file(dir / "a.csv", text);
  return error_of(
      [&] {
        Recording r = open_csv(dir / "a.csv", layout);
        read_all(r);
      },
      dir);
}

TEST(Csv, CommonLayoutsGiveTheSameNumbers) {
  const std::vector<std::pair<std::string, CsvLayout>> files{
      {"\xEF\xBB\xBFtime,a,b\n0,1.5,-2\n0.1,2.5,-3e0\n0.2,3.5,+4\n", {.time_column = "time"}},
      {"time,a,b\r\n0,1.5,-2\r\n0.1,2.5,-3\r\n0.2,3.5,4\r\n", {.time_column = "time"}},
      {"time\ta\tb\n0\t1.5\t-2\n0.1\t2.5\t-3\n0.2\t3.5\t4", {.delimiter = "tab", .time_column = "time"}},
      {"zeit;a;b\n0;1,5;-2\n0,1;2,5;-3\n0,2;3,5;4\n",
       {.delimiter = ";", .decimal_comma = true, .time_column = "zeit"}},
      {"  time  a   b\n 0.0  1.5 -2\n 0.1\t2.5  -3\n\n 0.2 3.5 4  \n",
       {.delimiter = "whitespace", .time_column = "time"}},
      {"\"time\",\"a\",\"b\"\n\"0\",\"1.5\",\"-2\"\n0.1,2.5,-3\n0.2,3.5,4\n", {.time_column = "time"}},
      {"# made by x\ntime,a,b\n# a remark, with commas,,,\n0,1.5,-2\n0.1,2.5,-3\n0.2,3.5,4\n",
       {.comment = "#", .time_column = "time"}},
      {"Recorder 3\n\ntime,a,b\nms,uV,mm\n0,1.5,-2\n100,2.5,-3\n200,3.5,4\n",
       {.skip_rows = 2, .units_row = 2, .time_column = "time"}},
      {"frame,sub,a,b\n,,V,V\n1,0,1.5,-2\n1,1,2.5,-3\n1,2,3.5,4\n", {.units_row = 2, .rate_hz = 10.0}},
      {"time [ms],a (uV),b (uV)\n0,1.5,-2\n100,2.5,-3\n200,3.5,4\n", {.time_column = "time"}},
  };
  for (const auto& [text, layout] : files) {
    const std::vector<data::Signal> signals = read_csv(text, layout);
    const std::size_t a = signals.size() - 2;
    EXPECT_EQ(signals[a].info.name, "a") << text;
    EXPECT_THAT(signals[a].samples, ElementsAre(1.5, 2.5, 3.5)) << text;
    EXPECT_THAT(signals[a + 1].samples, ElementsAre(-2.0, -3.0, 4.0)) << text;
    EXPECT_DOUBLE_EQ(signals[a].info.rate_hz, 10.0) << text;
  }
}

TEST(Csv, ColumnsWithoutAHeaderAreNumbered) {
  const auto signals =
      read_csv("1E-3,0\n0.002,-0.02197\n0.003,-0.01465\n", {.header_row = std::nullopt, .time_column = "1"});
  ASSERT_EQ(signals.size(), 1u);
  EXPECT_EQ(signals[0].info.name, "2");
  EXPECT_EQ(signals[0].info.rate_hz, 1000.0);
  EXPECT_DOUBLE_EQ(signals[0].info.start_time_s, 1e-3);
}

TEST(Csv, QuotedFieldsMayHoldDelimitersAndQuotes) {
  EXPECT_THAT(split_fields("\"a,b\", c ,\"d \"\"e\"\"\",", ","), ElementsAre("a,b", "c", "d \"e\"", ""));
  EXPECT_THAT(split_fields(" \"a b\"  c ", "whitespace"), ElementsAre("a b", "c"));
}

TEST(Csv, BadInputIsNamedWithItsPlace) {
  EXPECT_EQ(csv_error(""), "error[empty-file]: `a.csv` is empty\n  help: export the recording again\n");
  EXPECT_EQ(
      csv_error("time,a\n"),
      "error[empty-recording]: `a.csv` has a header but no samples\n  help: export the recording again\n");
  EXPECT_EQ(csv_error("tme,a\n0,1\n"),
            "error[missing-column]: `a.csv` has no time column `time`\n  help: did you mean `tme`?\n");
  EXPECT_EQ(csv_error("time,a\n0,1\n0.1,NaN\n"),
            "error[non-finite-sample]: column `a` has `NaN`\n  --> a.csv:3:5\n  |\n3 | 0.1,NaN\n"
            "  |     ^^^ mend or cut the recording; Brachium does not replace samples\n");
  EXPECT_THAT(csv_error("time,a\n0,1\n0.1,-inf\n"),
              HasSubstr("error[non-finite-sample]: column `a` has `-inf`\n  --> a.csv:3:5"));
  EXPECT_THAT(csv_error("time,a\n0,1\n0.1,1e999\n"),
              HasSubstr("error[not-a-number]: `1e999` in column `a` is beyond what a number can hold"));
  EXPECT_THAT(csv_error("time,a\n0,1\n0.1,\n"),
              HasSubstr("error[missing-field]: column `a` is empty\n  --> a.csv:3:5"));
  EXPECT_THAT(
      csv_error("time,a\n0,1\n0.1\n"),
      HasSubstr("error[missing-field]: a row of `a.csv` has 1 fields, 2 are needed\n  --> a.csv:3:4"));
  EXPECT_EQ(csv_error("time,a\n0,1\n0.1,x1\n"),
            "error[not-a-number]: `x1` in column `a` is not a number\n  --> a.csv:3:5\n  |\n3 | 0.1,x1\n  |  "
            "   ^^\n");
  EXPECT_THAT(csv_error("time;a\n0,0;1\n0,1;2\n", {.delimiter = ";", .time_column = "time"}),
              HasSubstr("say `decimal_comma = true`"));
  EXPECT_THAT(csv_error("time,a,a\n0,1,1\n"),
              HasSubstr("error[duplicate-column]: `a.csv` has two columns `a`"));
  EXPECT_THAT(csv_error(std::string("time,a\n0,\0\n", 11)),
              HasSubstr("error[not-text]: `a.csv` is not a text table: line 2 holds a null byte"));
  EXPECT_THAT(csv_error("\xFF\xFEt\0i\0"),
              HasSubstr("error[wrong-encoding]: `a.csv` is UTF-16 text\n  help: save it as UTF-8"));
  EXPECT_EQ(csv_error("a\n1\n2\n", {}),
            "error[no-time]: `a.csv` has neither a time column nor a rate\n  help: name the time column with "
            "`time`, or give `rate_hz`\n");
}

TEST(Timing, UnevenTimeStampsAreNamed) {
  EXPECT_EQ(csv_error("time,a\n0,1\n0.1,2\n0.05,3\n"),
            "error[time-backwards]: time goes back from 0.1 s to 0.05 s\n  --> a.csv:4\n"
            "  help: sort the rows, or cut the recording where its clock was reset\n");
  EXPECT_THAT(csv_error("time,a\n0,1\n0.1,2\n0.1,3\n"),
              HasSubstr("time stands still from 0.1 s to 0.1 s\n  --> a.csv:4\n"));
  EXPECT_EQ(csv_error("time,a\n0,1\n0.1,2\n0.2,3\n0.6,4\n0.7,5\n0.8,1\n"),
            "error[time-gap]: 1 gap in time, the longest 0.4 s at a sample period of 0.1 s\n  --> a.csv:5\n"
            "  help: cut the recording there, or bridge gaps with `timing = \"interpolate\"`\n");
  EXPECT_EQ(
      csv_error("time,a\n0,1\n0.1,2\n0.23,3\n0.3,4\n0.4,5\n0.5,1\n"),
      "error[time-jitter]: a time stamp lies 0.3 sample periods off the even grid of 10 Hz\n  --> a.csv:4\n"
      "  help: give the true `rate_hz`, or bring the samples onto an even grid with `timing = "
      "\"interpolate\"`\n");
  const auto dir = scratch_dir();
  write_file(dir / "a.csv", "time,a\n0,1\n0.1,2\n0.2,3\n");
  EXPECT_EQ(error_of(
                [&] {
                  Recording r = open_csv(dir / "a.csv", {.time_column = "time"});
                  read_all(r, {.rate_hz = 20.0});
                },
                dir),
            "error[rate-mismatch]: `a.csv`: the rate is stated as 20 Hz, but the time stamps run at 10 Hz\n"
            "  help: correct the stated rate, or leave it out\n");
}

TEST(Timing, GapsAndJitterMayBeBridgedByStraightLinesWithAWarning) {
  const auto dir = scratch_dir();
  write_file(dir / "a.csv", "time,a\n1,0\n1.1,1\n1.23,2.3\n1.3,3\n1.7,7\n1.8,8\n");
  Recording recording = open_csv(dir / "a.csv", {.time_column = "time"});
  std::vector<data::Diagnostic> warnings;
  const Timing timing = check_timing(recording, {.rule = TimingRule::interpolate, .rate_hz = 10.0}, warnings);
  EXPECT_EQ(timing.samples, 9u);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].message,
            "1 gap (longest 0.4 s) and time stamps up to 0.3 sample periods off were bridged by straight "
            "lines onto 10 Hz");
  const auto signals = read_all(recording, {.rule = TimingRule::interpolate, .rate_hz = 10.0});
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(signals[0].samples[i], static_cast<double>(i), 1e-12);
}

TEST(Timing, BridgingMayChooseTheRateButNotMakeUpARecording) {
  const auto dir = scratch_dir();
  write_file(dir / "a.csv", "time,a\n0,0\n0.3,3\n0.5,5\n1.1,11\n");
  Recording recording = open_csv(dir / "a.csv", {.time_column = "time"});
  const auto signals = read_all(recording, {.rule = TimingRule::interpolate, .rate_hz = 10.0});
  ASSERT_EQ(signals[0].samples.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_NEAR(signals[0].samples[i], static_cast<double>(i), 1e-12);
  EXPECT_EQ(error_of([&] { read_all(recording, {.rule = TimingRule::interpolate, .rate_hz = 1000.0}); }, dir),
            "error[time-gap]: `a.csv`: 4 rows cannot be bridged to 1101 samples at 1000 Hz\n"
            "  help: give a lower `rate_hz`, or cut the recording at its gaps\n");
}

TEST(Timing, RoundedTimeStampsGiveTheWholeRate) {
  std::string text = "time,a\n";
  for (int i = 0; i < 500; ++i) text += std::to_string(i / 120.0) + "," + std::to_string(i) + "\n";
  EXPECT_EQ(read_csv(text, {.time_column = "time"})[0].info.rate_hz, 120.0);
}

const std::string noraxon_head = "\xEF\xBB\xBFtype,name,time_units,begin_time,frequency,count,units\n";

std::string noraxon_error(const std::string& text) {
  const auto dir = scratch_dir();
  write_file(dir / "a..csv", text);
  return error_of(
      [&] {
        Recording r = open_noraxon(dir / "a..csv");
        read_all(r);
      },
      dir);
}

TEST(Noraxon, BadInputIsNamed) {
  EXPECT_EQ(noraxon_error(""), "error[empty-file]: `a..csv` is empty\n  help: export the recording again\n");
  EXPECT_EQ(noraxon_error("time,value\n0,1\n"),
            "error[not-noraxon]: `a..csv` is not a Noraxon signal export: the first row must be "
            "`type,name,time_units,begin_time,frequency,count,units`\n  --> a..csv:1\n"
            "  help: export single signals as CSV, or describe the file with `format = \"csv\"`\n");
  EXPECT_EQ(
      noraxon_error(noraxon_head + "signal,\"x\",\"s\",0.0,10,4,\"uV\"\n\ntime,value\n0.0,1\n0.1,2\n0.2,3\n"),
      "error[row-count-mismatch]: `a..csv` states 4 rows but has 3\n"
      "  help: the file may be cut off; if it is whole, say `ignore_stated_rows = true`\n");
  EXPECT_EQ(
      noraxon_error(noraxon_head + "signal,\"x\",\"s\",0.0,20,3,\"uV\"\n\ntime,value\n0.0,1\n0.1,2\n0.2,3\n"),
      "error[rate-mismatch]: `a..csv`: the rate is stated as 20 Hz, but the time stamps run at 10 Hz\n"
      "  help: correct the stated rate, or leave it out\n");
  EXPECT_EQ(noraxon_error(noraxon_head + "signal_2d,\"x\",\"s\",0.0,20,3,\"uV\"\n\ntime,x,y\n"),
            "error[unknown-type]: `signal_2d` is not a type of Noraxon signal that can be read\n"
            "  --> a..csv:2:1\n  |\n2 | signal_2d,\"x\",\"s\",0.0,20,3,\"uV\"\n  | ^^^^^^^^^ known: signal, "
            "signal_3d, signal_4d\n");
  EXPECT_THAT(noraxon_error(noraxon_head + "signal_3d,\"x\",\"s\",0.0,20,3,\"uV\"\n\ntime,x,y\n"),
              HasSubstr("the columns of a `signal_3d` must be `time,x,y,z`\n  --> a..csv:4\n"));
}

std::string storage_error(const std::string& text) {
  const auto dir = scratch_dir();
  write_file(dir / "a.sto", text);
  return error_of(
      [&] {
        Recording r = open_storage(dir / "a.sto");
        read_all(r);
      },
      dir);
}

TEST(Storage, AllDialectsGiveTheSameNumbers) {
  const std::string rows = "0.0\t1.5\t2\t\n 0.1\t2.5\t 3\n0.2\t3.5\t4\n";
  for (const std::string& head : {
           std::string("Results\nversion=1\nnRows=3\nnColumns=3\ninDegrees=no\nendheader\ntime\ta\tb_tx\n"),
           std::string("Results\nnRows=3\nnColumns=3\n\nendheader\ntime\ta\tb_tx\t\n"),
           std::string("Results\nUnits are S.I. (a = b says nothing)\nendheader\n\ntime\ta\tb_tx\n"),
           std::string("Coordinates\ninDegrees=no\nDataType=double\nversion=3\nOpenSimVersion=4.5-"
                       "x\nendheader\r\ntime\ta\tb_tx\n"),
           std::string("CEINMS output\ndatacolumns 3\ndatarows 3\nrange 0 0.2\nendheader\ntime\ta\tb_tx\t\n"),
           std::string("/path/x.mot\nversion=2\nendheader\ntime\ta\tb_tx\n"),
       }) {
    Recording recording = open_storage(write_file(scratch_dir() / "a.sto", head + rows));
    const auto signals = read_all(recording);
    ASSERT_EQ(signals.size(), 2u) << head;
    EXPECT_THAT(signals[0].samples, ElementsAre(1.5, 2.5, 3.5)) << head;
    EXPECT_THAT(signals[1].samples, ElementsAre(2.0, 3.0, 4.0)) << head;
    EXPECT_EQ(signals[0].info.rate_hz, 10.0) << head;
    EXPECT_EQ(signals[0].info.unit, "") << head;
  }
}

TEST(Storage, InDegreesConcernsRotationalColumnsOnly) {
  StorageHeader header;
  const Recording recording = open_storage(
      write_file(scratch_dir() / "a.mot",
                 "Coordinates\nversion=1\ninDegrees=yes\nendheader\ntime\telbow_flex\tpelvis_tx\n0\t1\t2\n"),
      &header);
  EXPECT_TRUE(header.in_degrees);
  EXPECT_EQ(recording.header().columns[0].unit, "deg");
  EXPECT_EQ(recording.header().columns[1].unit, "");
  EXPECT_TRUE(is_rotational_column("/jointset/knee_r/knee_angle_r/value"));
  EXPECT_TRUE(is_rotational_column("r_elbow_flex_u"));
  EXPECT_FALSE(is_rotational_column("/jointset/ground_pelvis/pelvis_tx/value"));
  EXPECT_FALSE(is_rotational_column("/forceset/soleus/activation"));
  EXPECT_FALSE(is_rotational_column("TRIlong.activation"));
  EXPECT_FALSE(is_rotational_column("hip_flexion_r_moment"));
}

TEST(Storage, BadInputIsNamed) {
  EXPECT_EQ(storage_error(""), "error[empty-file]: `a.sto` is empty\n  help: export the recording again\n");
  EXPECT_EQ(
      storage_error("time\ta\n0\t1\n"),
      "error[not-a-storage-file]: `a.sto` is not an OpenSim storage file: there is no line `endheader`\n"
      "  help: describe the file with `format = \"csv\"`\n");
  EXPECT_EQ(storage_error("x\nnRows=3\nendheader\ntime\ta\n0\t1\n0.1\t2\n"),
            "error[row-count-mismatch]: `a.sto` states 3 rows but has 2\n"
            "  help: the file may be cut off; if it is whole, say `ignore_stated_rows = true`\n");
  const Recording wrong_count =
      open_storage(write_file(scratch_dir() / "a.sto", "x\nnColumns=3\nendheader\ntime\ta\n0\t1\n"));
  ASSERT_EQ(wrong_count.header().notes.size(), 1u);
  EXPECT_EQ(wrong_count.header().notes[0].message, "the header states 3 columns, but 2 are labelled");
  EXPECT_THAT(
      storage_error("x\nDataType=Vec3\nendheader\ntime\ta\n0\t1,2,3\n"),
      HasSubstr("error[unsupported-data-type]: columns of type `Vec3` cannot be read\n  --> a.sto:2\n"));
  EXPECT_THAT(storage_error("x\nendheader\ntime\ta\ta\n0\t1\t2\n"),
              HasSubstr("error[duplicate-column]: there are two columns `a`"));
  EXPECT_THAT(storage_error("x\nendheader\ntime\ta\n0\t1\n0.1\n"),
              HasSubstr("error[missing-field]: a row of `a.sto` has 1 fields, 2 are needed"));
  EXPECT_THAT(storage_error("x\nendheader\ntime\ta\n0\t1\n0.1\t2\t3\n"),
              HasSubstr("error[extra-field]: a row of `a.sto` has 3 fields, not 2"));
  EXPECT_THAT(storage_error("x\nversion=9\nendheader\ntime\ta\n"),
              HasSubstr("error[unsupported-version]: storage version `9` is not known"));
}

TEST(Storage, EveryPublicFileIsReadOrRefusedForAStatedReason) {
  BRACHIUM_NEEDS_SESSIONS();
  BRACHIUM_NEEDS_REFERENCE();
  std::size_t even = 0, uneven = 0, cut = 0;
  for (const auto& root : {tests::sessions_dir(), tests::reference_dir()}) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const std::string ending = entry.path().extension().string();
      if (ending != ".sto" && ending != ".mot") continue;
      Recording recording = open_storage(entry.path());
      const std::string name = entry.path().filename().string();
      std::string code = "even";
      try {
        EXPECT_EQ(read_all(recording).size(), recording.header().columns.size());
      } catch (const data::InputError& error) {
        code = error.diagnostics().front().code;
      }
      if (code == "even") {
        ++even;
      } else if (code == "row-count-mismatch") {  // two files cut short by whoever published them
        ++cut;
        EXPECT_TRUE(name == "inverse_kin.mot" || name == "inverse_dyn.sto") << entry.path();
        const auto signals = read_all(recording, {.ignore_stated_rows = true});
        EXPECT_EQ(signals[0].info.rate_hz, 100.0);
        EXPECT_NEAR(signals[0].info.start_time_s, 1.56, 1e-12);
      } else {  // integrators with steps of their own
        ++uneven;
        EXPECT_TRUE(code == "time-gap" || code == "time-jitter") << entry.path() << " " << code;
        EXPECT_TRUE(name == "arm26_states.sto" || name == "arm26_controls.sto") << entry.path();
        EXPECT_GT(read_all(recording, {.rule = TimingRule::interpolate, .rate_hz = std::nullopt})
                      .front()
                      .samples.size(),
                  100u);
      }
    }
  }
  EXPECT_GE(even, 20u);
  EXPECT_EQ(uneven, 2u);
  EXPECT_EQ(cut, 2u);
}

TEST(Storage, WrittenFilesReadBackExactly) {
  const auto dir = scratch_dir();
  std::vector<data::Signal> signals{
      tests::make_signal("elbow_flexion", data::Quantity::joint_angle, "rad", 200.0, 0.25, 50),
      tests::make_signal("m", data::Quantity::joint_moment, "N m", 200.0, 0.25, 50)};
  write_storage(signals, "results", dir / "r.sto");
  Recording recording = open_storage(dir / "r.sto");
  auto back = read_all(recording);
  EXPECT_EQ(back[0].samples, signals[0].samples);
  EXPECT_EQ(back[1].samples, signals[1].samples);
  EXPECT_EQ(back[0].info.rate_hz, 200.0);
  EXPECT_EQ(back[0].info.start_time_s, 0.25);
  write_storage(signals, "results", dir / "d.sto", true);
  Recording degrees = open_storage(dir / "d.sto");
  EXPECT_EQ(degrees.header().columns[0].unit, "deg");
  EXPECT_NEAR(read_all(degrees)[0].samples[7], signals[0].samples[7] * 180.0 / M_PI, 1e-12);
  signals[1].info.rate_hz = 100.0;
  EXPECT_EQ(error_of([&] { write_storage(signals, "results", dir / "r.sto"); }),
            "error[unequal-time-stamps]: signals `elbow_flexion` and `m` do not share their time stamps\n  "
            "help: align them before writing\n");
}

}  // namespace
}  // namespace brachium::io
