#include "emg/quality.hpp"

#include <numbers>

#include "emg/synthetic_emg.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using testing::Contains;
using testing::HasSubstr;
using tests::input_error;

// Rest, contraction, rest: 2 s each.
std::vector<double> excitation() {
  std::vector<double> e(601, 0.0);
  for (std::size_t k = 200; k < 400; ++k) e[k] = 0.6;
  return e;
}

SyntheticEmgOptions clean_options() {
  SyntheticEmgOptions options;
  options.snr_db = 35.0;
  options.seed = 5;
  return options;
}

ChannelQuality judged(const SyntheticEmgOptions& options) {
  return assess(synthesise_emg(excitation(), 100.0, options).raw, options.rate_hz, "t", "BIC", {});
}

TEST(Quality, CleanEmgIsGoodAndMeasuredRight) {
  const ChannelQuality q = judged(clean_options());
  EXPECT_TRUE(q.good()) << testing::PrintToString(q.reasons);
  EXPECT_NEAR(q.snr_db, 35.0 - 4.4, 2.0);  // 20 log10(0.6) = -4.4
  EXPECT_EQ(q.clipped_fraction, 0.0);
  EXPECT_EQ(q.dropouts, 0u);
  EXPECT_NEAR(q.median_hz, 100.0, 25.0);
}

TEST(Quality, EachDisturbanceIsNamed) {
  SyntheticEmgOptions options = clean_options();
  options.clip_V = 0.4e-3;
  EXPECT_THAT(judged(options).reasons, Contains(HasSubstr("clipping: ")));
  options = clean_options();
  options.dropouts_per_minute = 60.0;
  EXPECT_THAT(judged(options).reasons, Contains(HasSubstr("dropouts: ")));
  options = clean_options();
  options.hum_V = 0.3e-3;
  EXPECT_THAT(judged(options).reasons, Contains(HasSubstr("line noise: ")));
  options = clean_options();
  options.snr_db = 6.0;
  EXPECT_THAT(judged(options).reasons, Contains(HasSubstr("above rest")));
  options = clean_options();
  options.drift_V_per_s = 0.2e-3;
  EXPECT_THAT(judged(options).reasons, Contains(HasSubstr("baseline drift: ")));
  options = clean_options();
  options.motion_V = 3e-3;
  EXPECT_THAT(judged(options).reasons, Contains(HasSubstr("median frequency")));
}

TEST(Quality, DropoutsAreCountedWithTheirShareAndLongestRun) {
  SyntheticEmgOptions options = clean_options();
  options.dropouts_per_minute = 60.0;
  const SyntheticEmg emg = synthesise_emg(excitation(), 100.0, options);
  const ChannelQuality q = assess(emg.raw, 2000.0, "t", "BIC", {});
  ASSERT_GT(emg.dropout_first.size(), 1u);
  EXPECT_EQ(q.dropouts, emg.dropout_first.size());
  EXPECT_NEAR(q.longest_dropout_s, 0.05, 1e-9);
}

TEST(Quality, LineShareIsThePowerOfTheHumOverAllPower) {
  std::vector<double> x = tests::white_noise(20000);
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] += std::sin(2 * std::numbers::pi * 60.0 * static_cast<double>(k) / 1000.0);
  QualityOptions options;
  options.line_hz = 0.0;
  const ChannelQuality q = assess(x, 1000.0, "t", "BIC", options);
  EXPECT_EQ(q.line_hz, 60.0);
  EXPECT_NEAR(q.line_ratio, 0.5 / 1.5, 0.02);
}

TEST(Quality, ConstantFlatAndNonFiniteChannelsAreNamed) {
  const ChannelQuality constant = assess(std::vector<double>(4000, 0.25), 1000.0, "t", "BIC", {});
  EXPECT_TRUE(constant.constant);
  EXPECT_EQ(constant.reasons, std::vector<std::string>{"constant: every sample is 0.25"});
  std::vector<double> x = tests::white_noise(4000);
  std::fill(x.begin() + 1000, x.end() - 500, x[1000]);
  EXPECT_THAT(assess(x, 1000.0, "t", "BIC", {}).reasons,
              Contains(HasSubstr("flat line: 62.5 % of the trial")));
  x[7] = std::nan("");
  EXPECT_EQ(assess(x, 1000.0, "t", "BIC", {}).reasons, std::vector<std::string>{"1 samples are not finite"});
}

TEST(Quality, TooShortATrialAndBadOptionsAreRefused) {
  EXPECT_EQ(input_error([] { (void)assess(std::vector<double>(500, 0.0), 1000.0, "rest", "BIC", {}); }),
            "trial-too-short: channel `BIC` of trial `rest` has 0.5 s; judging its quality needs 1 s");
  QualityOptions options;
  options.welch_s = 0.0;
  EXPECT_EQ(input_error([&] { (void)assess(tests::white_noise(5000), 1000.0, "rest", "BIC", options); }),
            "out-of-range: `welch_s` = 0 must be > 0");
}

TEST(Quality, TableHasOneRowPerChannelAndTrial) {
  const std::vector<ChannelQuality> rows{judged(clean_options()),
                                         assess(std::vector<double>(4000, 0.25), 1000.0, "t", "BRA", {})};
  const data::Table table = quality_table(rows);
  EXPECT_EQ(table.rows(), 2u);
  EXPECT_EQ(table.texts("verdict"), (std::vector<std::string>{"good", "BAD"}));
}

// scipy.signal.welch, printed by `scipy_reference.py numbers`.
TEST(Welch, EqualsScipys) {
  const Periodogram p = welch(tests::chirp(), 1000.0, 0.256);
  ASSERT_EQ(p.density.size(), 129u);
  const std::vector<std::pair<std::size_t, double>> reference{{0, 0.016660168261836843},
                                                              {1, 0.06409160671943613},
                                                              {3, 0.0003754926644129881},
                                                              {45, 0.006709443833484486}};
  for (const auto& [k, value] : reference) EXPECT_NEAR(p.density[k], value, 1e-12);
  EXPECT_DOUBLE_EQ(p.resolution_hz, 1000.0 / 256);
}

TEST(Welch, PowerOfWhiteNoiseAndMedianFrequencyOfAFlatSpectrum) {
  const Periodogram p = welch(tests::white_noise(200000), 1000.0, 0.5);
  double power = 0.0;
  for (const double d : p.density) power += d * p.resolution_hz;
  EXPECT_NEAR(power, 1.0, 0.02);
  EXPECT_NEAR(median_frequency(p, 0.0, 500.0), 250.0, 4.0);
  EXPECT_NEAR(median_frequency(p, 100.0, 200.0), 150.0, 3.0);
}

}  // namespace
}  // namespace brachium::emg
