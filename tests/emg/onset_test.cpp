#include "emg/onset.hpp"

#include "emg/butterworth.hpp"
#include "emg/synthetic_emg.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::input_error;

// Bursts of excitation 0.5 at 2-3 s and 5-5.8 s of 8 s, with sensor noise.
std::vector<double> bursts(double snr_db, std::uint64_t seed) {
  std::vector<double> e(8001, 0.0);
  for (std::size_t k = 2000; k < 3000; ++k) e[k] = 0.5;
  for (std::size_t k = 5000; k < 5800; ++k) e[k] = 0.5;
  SyntheticEmgOptions options;
  options.snr_db = snr_db;
  options.seed = seed;
  std::vector<double> x = synthesise_emg(e, 1000.0, options).raw;
  const std::span<double> channel(x);
  filter_zero_lag(design(FilterSpec::band_pass(20.0, 450.0), 2000.0).sections, {&channel, 1});
  return x;
}

TEST(Onset, BothMethodsFindKnownBurstsWithin25MillisecondsForEverySeed) {
  for (const OnsetMethod method : {OnsetMethod::threshold, OnsetMethod::tkeo}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      OnsetOptions options;
      options.method = method;
      options.factor = method == OnsetMethod::threshold ? 8.0 : 15.0;
      const OnsetResult r = detect_onsets(bursts(30.0, seed), 2000.0, 100.0, "BIC", options);
      ASSERT_EQ(r.bursts.size(), 2u) << to_string(method) << " seed " << seed;
      EXPECT_NEAR(r.bursts[0].onset_s, 102.0, 0.025);
      EXPECT_NEAR(r.bursts[0].offset_s, 103.0, 0.025);
      EXPECT_NEAR(r.bursts[1].onset_s, 105.0, 0.025);
      EXPECT_NEAR(r.bursts[1].offset_s, 105.8, 0.025);
      EXPECT_FALSE(r.bursts[0].cut_at_start);
    }
  }
}

TEST(Onset, BothMethodsStillSeeTheTwoBurstsAt20DecibelAndDateThemWithin60Milliseconds) {
  for (const OnsetMethod method : {OnsetMethod::threshold, OnsetMethod::tkeo}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      OnsetOptions options;
      options.method = method;
      options.factor = method == OnsetMethod::threshold ? 8.0 : 15.0;
      const OnsetResult r = detect_onsets(bursts(20.0, seed), 2000.0, 0.0, "BIC", options);
      ASSERT_EQ(r.bursts.size(), 2u) << to_string(method) << " seed " << seed;
      EXPECT_NEAR(r.bursts[0].onset_s, 2.0, 0.06);
      EXPECT_NEAR(r.bursts[1].onset_s, 5.0, 0.06);
    }
  }
}

TEST(Onset, RestMayBeNamedOrIsFound) {
  OnsetOptions options;
  options.baseline_from_s = 0.5;
  options.baseline_to_s = 1.5;
  const OnsetResult named = detect_onsets(bursts(30.0, 1), 2000.0, 0.0, "BIC", options);
  EXPECT_DOUBLE_EQ(named.baseline_from_s, 0.5);
  EXPECT_EQ(named.bursts.size(), 2u);
  options.baseline_to_s = 50.0;
  EXPECT_THAT(input_error([&] { (void)detect_onsets(bursts(30.0, 1), 2000.0, 0.0, "BIC", options); }),
              testing::HasSubstr(
                  "out-of-range: the baseline 0.5 s to 50 s of channel `BIC` must lie inside the trial"));
}

TEST(Onset, ShortBurstsAndGapsDoNotCount) {
  std::vector<double> e(4001, 0.0);
  for (std::size_t k = 1000; k < 2000; ++k) e[k] = k >= 1400 && k < 1420 ? 0.0 : 0.5;  // 20 ms gap
  for (std::size_t k = 3000; k < 3010; ++k) e[k] = 0.5;                                // 10 ms burst
  SyntheticEmgOptions synthetic;
  synthetic.snr_db = 40.0;
  OnsetOptions options;
  const OnsetResult r = detect_onsets(synthesise_emg(e, 1000.0, synthetic).raw, 2000.0, 0.0, "BIC", options);
  ASSERT_EQ(r.bursts.size(), 1u);
  EXPECT_NEAR(r.bursts[0].onset_s, 1.0, 0.025);
  EXPECT_NEAR(r.bursts[0].offset_s, 2.0, 0.025);
}

TEST(Onset, BadInputIsRefusedByName) {
  EXPECT_EQ(input_error([] { (void)detect_onsets(std::vector<double>(100, 0.0), 1000.0, 0.0, "BIC", {}); }),
            "trial-too-short: channel `BIC` has 0.1 s; finding onsets needs at least 0.55 s");
  EXPECT_EQ(input_error([] { (void)detect_onsets(std::vector<double>(3000, 0.0), 1000.0, 0.0, "BIC", {}); }),
            "constant-channel: channel `BIC` does not vary at rest (0 s to 0.5 s): no threshold can be set");
  std::vector<double> x = tests::white_noise(3000);
  x[5] = INFINITY;
  EXPECT_EQ(input_error([&] { (void)detect_onsets(x, 1000.0, 0.0, "BIC", {}); }),
            "not-finite: channel `BIC` is `inf` at sample 5");
  EXPECT_EQ(input_error([] { (void)parse_onset_method("teo"); }),
            "unknown-onset-method: `teo` is not a method of onset detection");
}

}  // namespace
}  // namespace brachium::emg
