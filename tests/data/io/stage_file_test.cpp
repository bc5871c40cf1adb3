#include "data/io/stage_file.hpp"

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>
#include <limits>

#include "data/io/subject_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using testing::HasSubstr;
using tests::error_of;
using tests::scratch_dir;
using tests::small_session;

data::Subject small_subject() {
  data::Subject subject;
  subject.name = "S1 \"quoted\" \\ \n";
  data::SubjectMuscle muscle;
  muscle.name = "BIClong";
  muscle.group = "flexors";
  muscle.parameters = {624.3, 0.1157, 0.2723 / 3.0, 0.1, 10.0, 0.1, 1.1};
  muscle.activation = {0.04, 0.015, 0.035, -1.0 / 3.0};
  subject.muscles.push_back(muscle);
  muscle.name = "TRI.lat";
  subject.muscles.push_back(muscle);
  subject.channel_gains = {{"biceps", 1.0 / 7.0}};
  subject.model = {{"curves", "thelen"}, {"tendon", "rigid"}};
  subject.statistics = {{"training_rmse_N_m", 1e-17}, {"training_r2", 0.91}};
  subject.provenance = {{"session", "s.h5"}, {"key with spaces", "v"}};
  data::ParameterVerdict verdict;
  verdict.muscle = "BIClong";
  verdict.parameter = "optimal_fibre_length_m";
  verdict.unit = "m";
  verdict.start = 0.1157;
  verdict.fitted = 0.12;
  verdict.lower = 0.0;
  verdict.upper = std::numeric_limits<double>::infinity();
  verdict.standard_error = std::numeric_limits<double>::infinity();
  verdict.interval_lower = -std::numeric_limits<double>::infinity();
  verdict.interval_upper = std::numeric_limits<double>::infinity();
  verdict.verdict = "NOT IDENTIFIED";
  subject.verdicts.push_back(verdict);
  return subject;
}

void expect_equal(const data::Subject& a, const data::Subject& b) {
  EXPECT_EQ(a.name, b.name);
  EXPECT_EQ(a.channel_gains, b.channel_gains);
  EXPECT_EQ(a.model, b.model);
  EXPECT_EQ(a.statistics, b.statistics);
  EXPECT_EQ(a.provenance, b.provenance);
  ASSERT_EQ(a.muscles.size(), b.muscles.size());
  for (std::size_t i = 0; i < a.muscles.size(); ++i) {
    const data::SubjectMuscle &x = a.muscles[i], &y = b.muscles[i];
    EXPECT_EQ(x.name, y.name);
    EXPECT_EQ(x.group, y.group);
    EXPECT_EQ(x.parameters.max_isometric_force_N, y.parameters.max_isometric_force_N);
    EXPECT_EQ(x.parameters.optimal_fibre_length_m, y.parameters.optimal_fibre_length_m);
    EXPECT_EQ(x.parameters.tendon_slack_length_m, y.parameters.tendon_slack_length_m);
    EXPECT_EQ(x.parameters.pennation_at_optimal_rad, y.parameters.pennation_at_optimal_rad);
    EXPECT_EQ(x.parameters.max_contraction_velocity, y.parameters.max_contraction_velocity);
    EXPECT_EQ(x.parameters.fibre_damping, y.parameters.fibre_damping);
    EXPECT_EQ(x.parameters.strength, y.parameters.strength);
    EXPECT_EQ(x.activation.delay_s, y.activation.delay_s);
    EXPECT_EQ(x.activation.time_constant_1_s, y.activation.time_constant_1_s);
    EXPECT_EQ(x.activation.time_constant_2_s, y.activation.time_constant_2_s);
    EXPECT_EQ(x.activation.shape, y.activation.shape);
  }
  ASSERT_EQ(a.verdicts.size(), b.verdicts.size());
  for (std::size_t i = 0; i < a.verdicts.size(); ++i) {
    const data::ParameterVerdict &x = a.verdicts[i], &y = b.verdicts[i];
    EXPECT_EQ(x.muscle, y.muscle);
    EXPECT_EQ(x.parameter, y.parameter);
    EXPECT_EQ(x.unit, y.unit);
    EXPECT_EQ(x.start, y.start);
    EXPECT_EQ(x.fitted, y.fitted);
    EXPECT_EQ(x.lower, y.lower);
    EXPECT_EQ(x.upper, y.upper);
    EXPECT_EQ(x.standard_error, y.standard_error);
    EXPECT_EQ(x.interval_lower, y.interval_lower);
    EXPECT_EQ(x.interval_upper, y.interval_upper);
    EXPECT_EQ(x.bias, y.bias);
    EXPECT_EQ(x.verdict, y.verdict);
    EXPECT_EQ(x.remark, y.remark);
  }
}

StageFileContent small_content() {
  StageFileContent content;
  data::Table table{"Fit \xC3\xA4", {}};
  table.columns.push_back({"verdict", "", std::vector<std::string>{"identified", "AT UPPER BOUND \xC3\xA4"}});
  table.columns.push_back({"fitted", "m", std::vector<double>{0.1, std::numeric_limits<double>::infinity()}});
  content.tables["fit"] = table;
  content.tables["empty"] = {"no rows",
                             {{"a", "1", std::vector<double>{}}, {"b", "", std::vector<std::string>{}}}};
  content.attributes = {{"method", "high-pass 30 Hz"}, {"empty", ""}};
  content.diagnostics.push_back(
      {data::Severity::warning, "clipping", "channel `x` clips", std::nullopt, "lower the gain"});
  content.diagnostics.push_back(
      {data::Severity::note, "n", "m", data::SourceSpan{"f.toml", 3, 4, 5, "text"}, ""});
  content.subject = small_subject();
  content.fingerprint = {{"options", "abc"}, {"program", "0.1.0"}};
  return content;
}

TEST(SubjectFile, RoundTripIsExact) {
  const auto file = scratch_dir() / "subject.toml";
  write_subject(small_subject(), file);
  expect_equal(small_subject(), read_subject(file));
}

TEST(SubjectFile, AnInfiniteStandardErrorIsTheTextNotIdentified) {
  EXPECT_THAT(subject_to_toml(small_subject()), HasSubstr("standard_error = \"not identified\"\n"));
}

TEST(SubjectFile, EveryMistakeIsReportedAtOnceWithItsPlace) {
  const std::string text =
      "format = \"brachium-subject\"\nformat_version = 1\nname = \"s\"\nweight = 3\n\n[[muscle]]\nname = "
      "\"B\"\n"
      "max_isometric_force_N = -1.0\noptimal_fibre_lenght_m = 0.1\ntendon_slack_length_m = 0.1\n"
      "pennation_at_optimal_rad = 1.6\nmax_contraction_velocity_per_s = 10\nfibre_damping_norm = "
      "0.1\nstrength = \"big\"\n\n"
      "[muscle.activation]\ndelay_s = 0.04\ntime_constant_1_s = 0.01\ntime_constant_2_s = 0.03\nshape = "
      "-1.0\n\n"
      "[[muscle]]\nname = \"B\"\n";
  EXPECT_EQ(
      error_of([&] { parse_subject(text.substr(0, text.rfind("\n[[muscle]]")), "s.toml"); }),
      "error[out-of-range]: `max_isometric_force_N` must lie in (0, inf), not be -1\n"
      "  --> s.toml:8:25\n  |\n8 | max_isometric_force_N = -1.0\n  |                         ^^^^\n"
      "error[missing-key]: `optimal_fibre_length_m` is missing in [[muscle]]\n"
      "  --> s.toml:6:1\n  |\n6 | [[muscle]]\n  | ^^^^^^^^^^\n"
      "error[out-of-range]: `pennation_at_optimal_rad` must lie in [0, 1.5707963267948966), not be 1.6\n"
      "  --> s.toml:11:28\n   |\n11 | pennation_at_optimal_rad = 1.6\n   |                            ^^^\n"
      "error[wrong-type]: `strength` of [[muscle]] must be a number, not a text\n"
      "  --> s.toml:14:12\n   |\n14 | strength = \"big\"\n   |            ^^^^^\n"
      "error[unknown-key]: `optimal_fibre_lenght_m` is not a key of [[muscle]]\n"
      "  --> s.toml:9:1\n  |\n9 | optimal_fibre_lenght_m = 0.1\n  | ^^^^^^^^^^^^^^^^^^^^^^ did you mean "
      "`optimal_fibre_length_m`?\n"
      "error[unknown-key]: `weight` is not a key of this file\n"
      "  --> s.toml:4:1\n  |\n4 | weight = 3\n  | ^^^^^^ known: channel_gains, format, format_version, "
      "model, muscle, "
      "name, provenance, statistics, verdict\n");
  EXPECT_THAT(error_of([&] { parse_subject(text, "s.toml"); }),
              HasSubstr("error[duplicate-muscle]: there are two muscles `B`"));
  EXPECT_THAT(
      error_of([&] { parse_subject("name = \"s\"\n", "s.toml"); }),
      HasSubstr(
          "error[wrong-format]: `s.toml` is not a calibrated subject (no `format = \"brachium-subject\"`)"));
}

TEST(StageFile, RoundTripIsExact) {
  const auto file = scratch_dir() / "stage.h5";
  {
    StageFileWriter writer(file);
    data::store(small_session(), writer);
    writer.finish(small_content());
  }
  const StageFileContent wanted = small_content(), found = read_stage_content(file);
  EXPECT_EQ(found.attributes, wanted.attributes);
  EXPECT_EQ(found.fingerprint, wanted.fingerprint);
  ASSERT_EQ(found.tables.size(), 2u);
  for (const auto& [name, table] : wanted.tables) {
    const data::Table& other = found.tables.at(name);
    EXPECT_EQ(other.title, table.title);
    ASSERT_EQ(other.columns.size(), table.columns.size());
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      EXPECT_EQ(other.columns[i].name, table.columns[i].name);
      EXPECT_EQ(other.columns[i].unit, table.columns[i].unit);
      EXPECT_EQ(other.columns[i].values, table.columns[i].values);
    }
  }
  ASSERT_EQ(found.diagnostics.size(), 2u);
  EXPECT_EQ(data::render(found.diagnostics), data::render(wanted.diagnostics));
  ASSERT_TRUE(found.subject.has_value());
  expect_equal(*found.subject, *wanted.subject);
  tests::expect_equal(small_session(), read_session(file));
}

TEST(StageFile, TablesOpenInXarray) {
  const auto file = scratch_dir() / "stage.h5";
  {
    StageFileWriter writer(file);
    data::store(small_session(), writer);
    writer.finish(small_content());
  }
  const std::string command = "/usr/bin/python3 " +
                              (tests::source_dir() / "tests/data/io/read_session.py").string() + " " +
                              file.string() + " tables > " + file.string() + ".log 2>&1";
  const int status = std::system(command.c_str());
  if (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127) {
    GTEST_SKIP() << "needs python3 with h5py, xarray and h5netcdf: " << tests::slurp(file.string() + ".log");
  }
  EXPECT_EQ(status, 0) << tests::slurp(file.string() + ".log");
}

TEST(StageFile, WithoutFinishThereIsNoFile) {
  const auto dir = scratch_dir();
  {
    StageFileWriter writer(dir / "stage.h5");
    data::store(small_session(), writer);
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir));
  EXPECT_FALSE(read_fingerprint(dir / "stage.h5").has_value());
}

TEST(StageFile, TheFingerprintOfADamagedOrForeignFileIsNone) {
  const auto dir = scratch_dir();
  {
    StageFileWriter writer(dir / "stage.h5");
    data::store(small_session(), writer);
    writer.finish(small_content());
  }
  EXPECT_EQ(read_fingerprint(dir / "stage.h5"), small_content().fingerprint);
  const std::string bytes = tests::slurp(dir / "stage.h5");
  tests::write_file(dir / "cut.h5", bytes.substr(0, bytes.size() - 1));
  EXPECT_FALSE(read_fingerprint(dir / "cut.h5").has_value());
  write_session(small_session(), dir / "session.h5");
  EXPECT_FALSE(read_fingerprint(dir / "session.h5").has_value());
  EXPECT_EQ(error_of([&] { read_stage_content(dir / "session.h5"); }, dir),
            "error[missing-group]: `session.h5` has no group `attributes`: it is not the output of a stage\n"
            "  help: a session file holds signals only\n");
}

}  // namespace
}  // namespace brachium::io
