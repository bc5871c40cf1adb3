#include "emg/normalisation.hpp"

#include <numeric>

#include "emg/conditioning.hpp"
#include "emg/synthetic_emg.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::input_error;

TEST(WindowMaximum, FindsTheLargestMeanAndItsPlace) {
  std::vector<double> x(1000, 1.0);
  for (std::size_t k = 400; k < 500; ++k) x[k] = 3.0;
  x[800] = 50.0;  // one sample is not a contraction
  const WindowMaximum best = moving_window_maximum(x, 100.0, 1.0);
  EXPECT_EQ(best.first, 400u);
  EXPECT_NEAR(best.value, 3.0, 1e-13);
  EXPECT_EQ(moving_window_maximum(x, 100.0, 0.0).first, 800u);
  EXPECT_EQ(moving_window_maximum(x, 100.0, 10.0).width, 1000u);
}

TEST(Reference, IsTheMaximumOverAllNamedTrialsWithItsTrialAndTime) {
  std::vector<double> one(400, 0.2), two(400, 0.1);
  for (std::size_t k = 200; k < 300; ++k) two[k] = 0.4;
  NormalisationOptions options;
  const std::vector<EnvelopeView> trials{{"mvc-1", one, 100.0, 0.0}, {"mvc-2", two, 100.0, 10.0}};
  const NormalisationReference r = find_reference("BIC", trials, options);
  EXPECT_NEAR(r.value, 0.4, 1e-13);
  EXPECT_EQ(r.trial, "mvc-2");
  EXPECT_NEAR(r.time_s, 10.0 + 2.0 + 0.245, 1e-12);
  EXPECT_EQ(r.trials, 2u);
  EXPECT_TRUE(r.diagnostics.empty());
  EXPECT_GT(r.expected_bias, 0.05);
}

TEST(Reference, OverOrdinaryTrialsWarnsAndNoneSaysThatTheGainIsFitted) {
  const std::vector<double> x(400, 0.2);
  NormalisationOptions options;
  options.method = Normalisation::trials_maximum;
  const std::vector<EnvelopeView> trials{{"curl-1", x, 100.0, 0.0}};
  const NormalisationReference r = find_reference("BIC", trials, options);
  ASSERT_EQ(r.diagnostics.size(), 1u);
  EXPECT_EQ(r.diagnostics[0].severity, data::Severity::warning);
  EXPECT_EQ(r.diagnostics[0].message,
            "channel `BIC` is normalised by its maximum over 1 trials, not by an MVC: excitations cannot be "
            "compared "
            "between channels, days or people");
  options.method = Normalisation::none;
  EXPECT_EQ(find_reference("BIC", {}, options).value, 1.0);
}

TEST(Reference, RefusesAbsentMvcShortTrialsAndSilentChannels) {
  NormalisationOptions options;
  EXPECT_EQ(input_error([&] { (void)find_reference("BIC", {}, options); }),
            "mvc-absent: channel `BIC` has no MVC trial to normalise by");
  const std::vector<double> zero(400, 0.0), brief(20, 1.0);
  EXPECT_EQ(input_error([&] {
              (void)find_reference("BIC", std::vector<EnvelopeView>{{"mvc-1", zero, 100.0, 0.0}}, options);
            }),
            "constant-channel: the largest envelope of channel `BIC` is 0: there is nothing to normalise by");
  EXPECT_EQ(input_error([&] {
              (void)find_reference("BIC", std::vector<EnvelopeView>{{"mvc-1", brief, 100.0, 0.0}}, options);
            }),
            "trial-too-short: trial `mvc-1` has 0.2 s of channel `BIC`, the normalisation's window is 0.5 s");
  options.window_s = -1.0;
  EXPECT_EQ(input_error([&] { (void)find_reference("BIC", {}, options); }),
            "out-of-range: `window_s` = -1 must be >= 0");
}

TEST(Normalise, CountsAndTimesExcitationsAboveOneAndClampsNothing) {
  std::vector<double> x{0.5, 1.0, 2.2, 2.4, 1.0, 3.0, 0.0};
  const Excess excess = normalise(x, 2.0, 10.0, 5.0);
  EXPECT_EQ(excess.samples, 3u);
  EXPECT_DOUBLE_EQ(excess.maximum, 1.5);
  EXPECT_DOUBLE_EQ(excess.maximum_time_s, 5.5);
  ASSERT_EQ(excess.intervals.size(), 2u);
  EXPECT_DOUBLE_EQ(excess.intervals[0].from_s, 5.2);
  EXPECT_DOUBLE_EQ(excess.intervals[0].to_s, 5.3);
  EXPECT_DOUBLE_EQ(x[5], 1.5);
  EXPECT_EQ(input_error([&] { (void)normalise(x, 0.0, 10.0, 0.0); }),
            "out-of-range: the reference `0` must be > 0");
}

// Known statistics of white noise limited to 30-450 Hz (statistical bandwidth 420 Hz): CV 9 % at 6 Hz; a .5 s window
// is biased by +6.5 %, the best of three by +8 %, one sample by +25 %.
TEST(ExpectedBias, MeetsTheKnownStatisticsOfBandLimitedNoise) {
  EXPECT_NEAR(envelope_variation(0.0, 6.0, 420.0), 0.09, 0.005);
  EXPECT_NEAR(expected_bias(0.5, 6.0, 3.0, 1, 420.0), 0.065, 0.008);
  EXPECT_NEAR(expected_bias(0.5, 6.0, 3.0, 3, 420.0), 0.08, 0.008);
  EXPECT_NEAR(expected_bias(0.0, 6.0, 5.0, 1, 420.0), 0.25, 0.035);
}

TEST(ExpectedBias, PredictsWhatSyntheticEmgOfAConstantContractionShows) {
  ConditioningOptions options;
  options.highpass_hz = 0.0;
  const ConditioningChain chain = design_conditioning(options, 2000.0);
  const int seeds = 60;
  double window = 0.0, sample = 0.0, variation = 0.0;
  for (int seed = 0; seed < seeds; ++seed) {
    SyntheticEmgOptions synthetic;
    synthetic.seed = static_cast<std::uint64_t>(seed);
    SyntheticEmg emg = synthesise_emg(std::vector<double>(401, 1.0), 100.0, synthetic);
    const std::span<double> channel(emg.raw);
    const std::string name = "BIC";
    const OutputLayout layout = condition(chain, {&channel, 1}, {&name, 1}, "mvc");
    const std::span<const double> plateau = channel.subspan(0, std::min<std::size_t>(layout.count, 6000));
    const double truth = emg.mean_rectified_at_unit_V;
    window += (moving_window_maximum(plateau, 2000.0, 0.5).value / truth - 1.0) / seeds;
    sample += (moving_window_maximum(plateau, 2000.0, 0.0).value / truth - 1.0) / seeds;
    for (const double e : plateau)
      variation += std::pow(e / truth - 1.0, 2) / static_cast<double>(plateau.size()) / seeds;
  }
  EXPECT_NEAR(std::sqrt(variation), envelope_variation(0.0, 6.0, 190.0), 0.01);
  EXPECT_NEAR(window, expected_bias(0.5, 6.0, 3.0, 1, 190.0), 0.02);
  EXPECT_NEAR(sample, expected_bias(0.0, 6.0, 3.0, 1, 190.0), 0.06);
}

}  // namespace
}  // namespace brachium::emg
