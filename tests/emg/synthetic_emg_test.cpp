#include "emg/synthetic_emg.hpp"

#include <numbers>

#include "emg/welch.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::input_error;

std::vector<double> ones(double seconds) {
  return std::vector<double>(static_cast<std::size_t>(seconds * 100) + 1, 1.0);
}

double rms(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double v : x) sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

TEST(SyntheticEmg, HasTheStatedAmplitudeAndMeanRectifiedValue) {
  const SyntheticEmg emg = synthesise_emg(ones(100.0), 100.0, {});
  EXPECT_NEAR(rms(emg.clean), 0.5e-3, 0.01 * 0.5e-3);
  double mean = 0.0;
  for (const double v : emg.clean) mean += std::abs(v) / static_cast<double>(emg.clean.size());
  EXPECT_NEAR(mean / emg.mean_rectified_at_unit_V, 1.0, 0.01);
  EXPECT_EQ(emg.raw, emg.clean);
}

TEST(SyntheticEmg, HasTheStatedSpectrum) {
  const Periodogram p = welch(synthesise_emg(ones(200.0), 100.0, {}).clean, 2000.0, 0.25);
  const auto P = [](double f) {
    const double fl = 60.0, fh = 120.0;
    const double band = 1.0 / ((1.0 + std::pow(20.0 / f, 4)) * (1.0 + std::pow(f / 450.0, 4)));
    return band * std::pow(fh, 4) * f * f / ((f * f + fl * fl) * std::pow(f * f + fh * fh, 2));
  };
  const double reference = p.density[20] / P(80.0);
  for (const std::size_t bin :
       {8u, 15u, 25u, 40u, 60u}) {  // 32 to 240 Hz: below, the bilinear warping is small
    const double f = static_cast<double>(bin) * p.resolution_hz;
    EXPECT_NEAR(p.density[bin] / (reference * P(f)), 1.0, 0.15) << f << " Hz";
  }
  EXPECT_LT(p.density[200], 0.01 * p.density[20]);
}

TEST(SyntheticEmg, FollowsTheExcitation) {
  std::vector<double> e(1001, 0.0);
  for (std::size_t k = 500; k < 1001; ++k) e[k] = 0.25;
  const SyntheticEmg emg = synthesise_emg(e, 100.0, {});
  EXPECT_EQ(emg.raw.size(), 20001u);
  for (std::size_t k = 0; k <= 9980; ++k) ASSERT_EQ(emg.raw[k], 0.0);
  EXPECT_NEAR(rms({emg.raw.begin() + 10000, emg.raw.end()}), 0.125e-3, 0.1 * 0.125e-3);
  EXPECT_NEAR(emg.excitation[9990], 0.125, 1e-9);
}

TEST(SyntheticEmg, SameSeedSameDataOtherStreamOtherDataAndDisturbancesDoNotMixUp) {
  SyntheticEmgOptions options;
  options.seed = 9;
  const auto base = synthesise_emg(ones(2.0), 100.0, options);
  EXPECT_EQ(synthesise_emg(ones(2.0), 100.0, options).raw, base.raw);
  options.hum_V = 1e-4;
  options.snr_db = 20.0;
  options.dropouts_per_minute = 30.0;
  EXPECT_EQ(synthesise_emg(ones(2.0), 100.0, options).clean, base.clean);
  options.stream = 1;
  const auto other = synthesise_emg(ones(20.0), 100.0, options).clean;
  options.stream = 2;
  const auto third = synthesise_emg(ones(20.0), 100.0, options).clean;
  double correlation = 0.0;
  for (std::size_t k = 0; k < other.size(); ++k) correlation += other[k] * third[k];
  EXPECT_NEAR(correlation / (static_cast<double>(other.size()) * 0.25e-6), 0.0, 0.05);
}

TEST(SyntheticEmg, DisturbancesHaveTheStatedSize) {
  const std::vector<double> rest(6001, 0.0);
  SyntheticEmgOptions options;
  options.snr_db = 20.0;
  EXPECT_NEAR(rms(synthesise_emg(rest, 100.0, options).raw), 0.05e-3, 0.02 * 0.05e-3);
  options = {};
  options.hum_V = 1e-4;
  options.hum_harmonics = 1;
  EXPECT_NEAR(rms(synthesise_emg(rest, 100.0, options).raw), 1e-4 / std::numbers::sqrt2, 1e-8);
  options = {};
  options.motion_V = 2e-4;
  EXPECT_NEAR(rms(synthesise_emg(rest, 100.0, options).raw), 2e-4, 0.1 * 2e-4);
  options = {};
  options.ecg_V = 1e-3;
  EXPECT_NEAR(tests::largest(synthesise_emg(rest, 100.0, options).raw), 1e-3, 0.05e-3);
  options = {};
  options.offset_V = 0.01;
  options.drift_V_per_s = 0.001;
  const auto drifting = synthesise_emg(rest, 100.0, options).raw;
  EXPECT_DOUBLE_EQ(drifting.front(), 0.01);
  EXPECT_NEAR(drifting.back(), 0.07, 1e-12);
}

TEST(SyntheticEmg, ClippingAndDropoutsAreCounted) {
  SyntheticEmgOptions options;
  options.clip_V = 1e-3;
  options.dropouts_per_minute = 20.0;
  const SyntheticEmg emg = synthesise_emg(ones(60.0), 100.0, options);
  EXPECT_LE(tests::largest(emg.raw), 1e-3);
  EXPECT_NEAR(static_cast<double>(emg.clipped_samples) / 120000.0, 0.0455, 0.004);  // P(|z| > 2)
  EXPECT_NEAR(static_cast<double>(emg.dropout_first.size()), 20.0, 13.0);
  for (const std::size_t first : emg.dropout_first) EXPECT_EQ(emg.raw[first], 0.0);
}

TEST(SyntheticEmg, BadOptionsAreRefusedAtOnce) {
  SyntheticEmgOptions options;
  options.amplitude_V = 0.0;
  options.band_high_hz = 1000.0;
  options.dropout_s = -1.0;
  EXPECT_EQ(input_error([&] {
              (void)synthesise_emg(std::vector<double>{0.1, -0.1}, 100.0, options);
            }),
            "out-of-range: `amplitude_V` = 0 must be > 0\n"
            "out-of-range: `band_high_hz` = 1000 must lie below half the rate\n"
            "out-of-range: `dropout_s` = -1 must be > 0\n"
            "not-finite: the excitation is `-0.1` at sample 1; it must be finite and >= 0");
}

}  // namespace
}  // namespace brachium::emg
