#include <gmock/gmock.h>

#include <chrono>
#include <cmath>

#include "data/io/session_description.hpp"
#include "data/io/session_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

SessionDescription elbow_curls() {
  return read_session_description(tests::source_dir() / "pipelines/sessions/elbow_curls.toml",
                                  {{"recordings", (tests::sessions_dir() / "elbow_curls_noraxon").string()}});
}

TEST(ElbowCurls, TheSixNoraxonTrialsAreImportedAsTheyAre) {
  BRACHIUM_NEEDS_SESSIONS();
  const auto begin = std::chrono::steady_clock::now();
  data::MemorySession memory;
  EXPECT_EQ(data::render(import_session(elbow_curls(), memory)), "");
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  RecordProperty("import_seconds", std::to_string(seconds));
  std::printf("imported in %.2f s\n", seconds);
  EXPECT_LT(seconds, 5.0);  // far above what it takes, so that a busy machine does not fail it
  const data::SessionInfo& info = memory.info();
  ASSERT_EQ(info.trials.size(), 6u);
  EXPECT_EQ(info.trials[5].name, "curl-5.5lb-2");
  EXPECT_DOUBLE_EQ(info.trials[5].conditions.at("load_mass_kg"), 5.5 * 0.45359237);
  EXPECT_EQ(info.trials[5].attributes.at("load_mass"), "5.5 lb");
  EXPECT_EQ(info.anthropometry.at("body_mass_kg"), 75.0);
  for (const data::TrialInfo& trial : info.trials) {
    ASSERT_EQ(trial.signals.size(), 20u);
    EXPECT_EQ(trial.signals[0].rate_hz, 2000.0);
    EXPECT_EQ(trial.signals[3].rate_hz, 200.0);
    EXPECT_NEAR(trial.signals[0].duration_s(), trial.signals[3].duration_s(), 0.0051) << trial.name;
  }
  // Single samples as they stand in the files.
  const data::Signal biceps = memory.signal("curl-5.5lb-2", "biceps");
  EXPECT_EQ(biceps.info.unit, "V");
  EXPECT_EQ(biceps.info.count, 53240u);
  EXPECT_DOUBLE_EQ(biceps.samples[2], -0.005643274905e-6);
  EXPECT_DOUBLE_EQ(biceps.samples.back(), -0.921226498e-6);
  EXPECT_EQ(biceps.info.attributes.at("source_file"), "EMG/555/2/Noraxon Ultium-RT BICEPS BR..csv");
  const data::Signal angle = memory.signal("curl-5.5lb-2", "elbow_flexion");
  EXPECT_DOUBLE_EQ(angle.samples[0], -0.5168018801 * M_PI / 180.0);
  EXPECT_DOUBLE_EQ(memory.signal("curl-5.5lb-2", "forearm_orientation_w").samples[0], 0.7076646696);
  EXPECT_DOUBLE_EQ(memory.signal("curl-5.5lb-2", "forearm_acceleration_x").samples[0],
                   -17.53412615e-3 * 9.80665);
  EXPECT_DOUBLE_EQ(memory.signal("curl-5.5lb-2", "ulnar_styloid_position_z").samples[0], 0.9057129661);
}

TEST(ElbowCurls, QuaternionsAreOfUnitLengthAndTheForearmDoesNotStretch) {
  BRACHIUM_NEEDS_SESSIONS();
  data::MemorySession memory;
  import_session(elbow_curls(), memory);
  for (const data::TrialInfo& trial : memory.info().trials) {
    std::vector<std::vector<double>> q, elbow, wrist;
    for (const char* axis : {"x", "y", "z", "w"})
      q.push_back(memory.signal(trial.name, std::string("forearm_orientation_") + axis).samples);
    for (const char* axis : {"x", "y", "z"}) {
      elbow.push_back(memory.signal(trial.name, std::string("elbow_position_") + axis).samples);
      wrist.push_back(memory.signal(trial.name, std::string("ulnar_styloid_position_") + axis).samples);
    }
    double shortest = 1e9, longest = 0.0;
    for (std::size_t i = 0; i < q[0].size(); ++i) {
      ASSERT_NEAR(std::hypot(std::hypot(q[0][i], q[1][i]), std::hypot(q[2][i], q[3][i])), 1.0, 1e-6);
      const double length =
          std::hypot(wrist[0][i] - elbow[0][i], wrist[1][i] - elbow[1][i], wrist[2][i] - elbow[2][i]);
      shortest = std::min(shortest, length);
      longest = std::max(longest, length);
    }
    EXPECT_GT(shortest, 0.2);
    EXPECT_LT(longest - shortest, 0.01);
  }
}

TEST(ElbowCurls, TheSessionFileHoldsWhatWasImported) {
  BRACHIUM_NEEDS_SESSIONS();
  const auto file = tests::scratch_dir() / "curls.h5";
  data::MemorySession memory;
  import_session(elbow_curls(), memory);
  SessionFileWriter writer(file);
  import_session(elbow_curls(), writer);
  writer.commit();
  tests::expect_equal(memory.session(), read_session(file));
}

TEST(ElbowCurls, WithoutTheRecordingsTheMessageSaysHowToGiveThem) {
  const SessionDescription description = read_session_description(
      tests::source_dir() / "pipelines/sessions/elbow_curls.toml", {{"recordings", "/no/such/folder"}});
  EXPECT_EQ(tests::error_of([&] { resolve_files(description); }),
            "error[missing-folder]: there is no folder of recordings `/no/such/folder`\n"
            "  --> --set\n  help: give it with `--set recordings=FOLDER`\n");
}

}  // namespace
}  // namespace brachium::io
