// The claims that are made about public recordings. Nothing of them is kept here: the reference is computed beside.

#include "emg/conditioning.hpp"
#include "emg/onset.hpp"
#include "emg/quality.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::relative_difference;
using tests::scipy;

std::vector<double> plux(const std::string& name) {
  const auto out = tests::scratch_dir() / "channel";
  const std::string file = (tests::sessions_dir() / "biceps_emg/plux" / name).string();
  const std::string command =
      "/usr/bin/python3 '" + tests::script() + "' hdf5 '" + file + "' '" + out.string() + "'";
  if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
  return tests::read_doubles(out);
}

// The protocol as a user of scipy writes it: offset, high-pass 30 Hz, rectify, low-pass 6 Hz, plain cut-offs.
std::vector<double> per_pass_envelope(std::vector<double> x, double rate) {
  ConditioningOptions options;
  options.cutoff = CutoffConvention::per_pass;
  options.offset_edge_s = 0.0;
  options.trim_edges = false;
  const std::span<double> channel(x);
  const std::string name = "biceps";
  condition(design_conditioning(options, rate), {&channel, 1}, {&name, 1}, "recording");
  return x;
}

TEST(Recordings, PerPassEnvelopeOfTheBicepsEqualsScipysSosfiltfiltTo1eMinus9) {
  BRACHIUM_NEEDS_SESSIONS();
  BRACHIUM_NEEDS_SCIPY();
  const auto compare = [](const std::vector<double>& x, double rate, const std::string& arguments) {
    const double difference =
        relative_difference(per_pass_envelope(x, rate), scipy("envelope", x, arguments));
    EXPECT_LT(difference, 1e-9);
    ::testing::Test::RecordProperty("relative_difference", std::to_string(difference * 1e12) + "e-12");
  };
  compare(tests::csv_column(tests::sessions_dir() / "biceps_emg/bmc/emg.csv", 1), 1000.0, "1000 30 6 2");
  compare(tests::curl("275/1", "BICEPS BR..csv"), 2000.0, "2000 30 6 2");
  compare(tests::curl("444/2", "LAT. TRICEPS.csv"), 2000.0, "2000 30 6 2");
  compare(tests::curl("555/1", "BRACHIORAD..csv"), 2000.0, "2000 30 6 2");
  if (tests::python_has("h5py")) {
    compare(plux("emg_bursts.h5"), 1000.0, "1000 30 6 2");
    compare(plux("emg_fatigue.h5"), 1000.0, "1000 30 6 2");
  }
}

TEST(Recordings, MedianFrequencyOfTheFatigueTrialFallsFrom71To58Hertz) {
  BRACHIUM_NEEDS_SESSIONS();
  BRACHIUM_NEEDS_SCIPY();
  if (!tests::python_has("h5py")) GTEST_SKIP() << "needs h5py";
  const std::vector<double> x = plux("emg_fatigue.h5");
  const std::span<const double> all(x);
  const std::size_t fifth = x.size() / 5;
  const double fresh = median_frequency(welch(all.first(fifth), 1000.0, 1.0), 20.0, 450.0);
  const double tired = median_frequency(welch(all.last(fifth), 1000.0, 1.0), 20.0, 450.0);
  EXPECT_NEAR(fresh, 71.0, 3.0);
  EXPECT_NEAR(tired, 58.0, 3.0);
}

TEST(Recordings, ElbowCurlsAreGoodEnoughToUse) {
  BRACHIUM_NEEDS_SESSIONS();
  QualityOptions options;
  options.line_hz = 0.0;
  for (const std::string trial : {"275/1", "275/2", "444/1", "444/2", "555/1", "555/2"}) {
    const ChannelQuality q = assess(tests::curl(trial, "BICEPS BR..csv"), 2000.0, trial, "BIC", options);
    EXPECT_TRUE(q.good()) << trial << ": " << testing::PrintToString(q.reasons);
    EXPECT_GT(q.median_hz, 40.0);
    EXPECT_LT(q.median_hz, 150.0);
  }
}

TEST(Recordings, BothDetectorsFindTheSameBurstsOfTheBiceps) {
  BRACHIUM_NEEDS_SESSIONS();
  BRACHIUM_NEEDS_SCIPY();
  if (!tests::python_has("h5py")) GTEST_SKIP() << "needs h5py";
  std::vector<double> x = plux("emg_bursts.h5");
  const std::span<double> channel(x);
  filter_zero_lag(design(FilterSpec::band_pass(20.0, 400.0), 1000.0).sections, {&channel, 1});
  OnsetOptions options;
  options.minimum_active_s = 0.2;
  options.minimum_gap_s = 0.3;
  const OnsetResult tkeo = detect_onsets(x, 1000.0, 0.0, "biceps", options);
  options.method = OnsetMethod::threshold;
  options.factor = 8.0;
  const OnsetResult amplitude = detect_onsets(x, 1000.0, 0.0, "biceps", options);
  // Nine contractions. The first begins so softly that the two thresholds date it differently; of the others, none.
  ASSERT_EQ(tkeo.bursts.size(), 9u);
  ASSERT_EQ(amplitude.bursts.size(), 9u);
  for (std::size_t i = 1; i < 9; ++i) EXPECT_NEAR(tkeo.bursts[i].onset_s, amplitude.bursts[i].onset_s, 0.05);
  EXPECT_LT(tkeo.bursts[0].onset_s, amplitude.bursts[0].onset_s);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_LT(std::max(tkeo.bursts[i].onset_s, amplitude.bursts[i].onset_s),
              std::min(tkeo.bursts[i].offset_s, amplitude.bursts[i].offset_s));
  }
}

}  // namespace
}  // namespace brachium::emg
