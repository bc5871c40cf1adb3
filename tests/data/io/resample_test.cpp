#include "data/model/resample.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "tests/data/io/io_test_support.hpp"

namespace brachium::data {
namespace {

using testing::HasSubstr;
using tests::error_of;

constexpr double two_pi = 2.0 * std::numbers::pi;

Signal sampled(double rate_hz, double start_s, std::size_t count, const std::function<double(double)>& f) {
  Signal signal{{"x", Quantity::other, "1", rate_hz, start_s, count, "", "", {}}, {}};
  for (std::size_t i = 0; i < count; ++i) signal.samples.push_back(f(signal.info.time_s(i)));
  return signal;
}

/// Largest distance from f, leaving out what leans on the continuation beyond the ends.
double largest_error(const Signal& out, const std::function<double(double)>& f, double margin_s,
                     double first_s, double last_s) {
  double worst = 0.0;
  for (std::size_t i = 0; i < out.samples.size(); ++i) {
    const double t = out.info.time_s(i);
    if (t < first_s + margin_s || t > last_s - margin_s) continue;
    worst = std::max(worst, std::abs(out.samples[i] - f(t)));
  }
  return worst;
}

double sine_error(double from_hz, double to_hz, double frequency_hz, double offset_s) {
  const auto f = [=](double t) { return std::sin(two_pi * frequency_hz * t + 0.3); };
  const Signal in = sampled(from_hz, 0.013, static_cast<std::size_t>(4.0 * from_hz), f);
  const TimeGrid grid{to_hz, 0.013 + offset_s, static_cast<std::size_t>(3.9 * to_hz)};
  return largest_error(resample(in, grid), f, design_resampling(from_hz, to_hz).half_width_s,
                       in.info.start_time_s, in.info.end_time_s());
}

TEST(Resample, SinesInThePassbandAreReproduced) {
  for (const auto& [from, to] :
       {std::pair{2000.0, 200.0}, {200.0, 2000.0}, {2000.0, 600.0}, {148.148, 200.0}, {1000.0, 999.0}}) {
    const double passband = 0.9 * 0.5 * std::min(from, to);
    for (const double part : {0.05, 0.5, 1.0}) {
      for (const double offset : {0.0, 0.00031, 0.0017})
        EXPECT_LT(sine_error(from, to, part * passband, offset), 2e-5)
            << from << " -> " << to << " at " << part;
    }
  }
}

TEST(Resample, SinesAboveTheNewNyquistFrequencyAreSuppressed) {
  for (const double frequency : {100.0, 130.0, 500.0, 990.0}) {
    const auto f = [=](double t) { return std::sin(two_pi * frequency * t + 0.3); };
    const Signal in = sampled(2000.0, 0.0, 8000, f);
    const Signal out = resample(in, {200.0, 0.0, 790});
    EXPECT_LT(
        largest_error(
            out, [](double) { return 0.0; }, design_resampling(2000.0, 200.0).half_width_s, 0.0, 3.9995),
        2e-5)
        << frequency;  // -94 dB; 60 dB are promised
  }
}

// The wrong twin: plain decimation lets the same sine through as an alias.
TEST(Resample, PlainInterpolationWouldAlias) {
  const Signal in = sampled(2000.0, 0.0, 8000, [](double t) { return std::sin(two_pi * 130.0 * t + 0.3); });
  const TimeGrid grid{200.0, 0.0, 790};
  std::vector<double> times;
  for (std::size_t i = 0; i < grid.count; ++i) times.push_back(grid.time_s(i));
  const std::vector<double> out = evaluate_at(in, times, Interpolation::linear);
  EXPECT_GT(*std::max_element(out.begin(), out.end()), 0.9);
}

TEST(Resample, AgreesWithScipysPolyphaseEngine) {
  Signal in = sampled(2000.0, 0.0, 4000, [](double) { return 0.0; });
  for (std::size_t i = 0; i < in.samples.size(); ++i) {
    const auto t = static_cast<double>(i);
    in.samples[i] = std::sin(0.05 * t) + 0.5 * std::cos(0.31 * t + 0.2) +
                    0.1 * (static_cast<double>((i * 7919) % 101) - 50.0) / 50.0;
  }
  const Signal out = resample(in, {600.0, 0.0, 1200});
  // tests/data/io/resample_scipy.py, scipy 1.10
  const std::pair<std::size_t, double> wanted[] = {{400, -0.4349866758113596},
                                                   {401, -0.24981041863556297},
                                                   {577, 1.376819808071006},
                                                   {700, -0.13514924544652968},
                                                   {801, 1.0344255635977857}};
  for (const auto& [i, value] : wanted) EXPECT_NEAR(out.samples[i], value, 1e-12) << i;
  const ResampleFilter filter = design_resampling(2000.0, 600.0);
  EXPECT_NEAR(filter.beta, 10.06126, 1e-12);
  EXPECT_NEAR(filter.half_width_s, 0.1068578593115169, 1e-15);
}

TEST(Resample, ConstantsAndStraightLinesPassToTheVeryEnds) {
  const Signal flat = sampled(2000.0, 0.0, 1000, [](double) { return 3.7; });
  for (const double v : resample(flat, {170.0, 0.0, 84}).samples) EXPECT_NEAR(v, 3.7, 1e-13);
  const auto line = [](double t) { return 2.0 + 5.0 * t; };
  const Signal out = resample(sampled(2000.0, 0.0, 1000, line), {200.0, 0.0, 100});
  EXPECT_LT(largest_error(out, line, 0.0, 0.0, 1.0), 1e-4);
}

TEST(Resample, TheSameGridCopiesAndSaysNothing) {
  const Signal in = sampled(200.0, 0.5, 100, [](double t) { return t * t; });
  const Signal out = resample(in, {200.0, 0.6, 50});
  EXPECT_EQ(out.samples, std::vector<double>(in.samples.begin() + 20, in.samples.begin() + 70));
  EXPECT_TRUE(out.info.attributes.empty());
}

TEST(Resample, IsRecordedInTheSignalsAttributes) {
  const Signal in = sampled(2000.0, 0.0, 2000, [](double t) { return t; });
  EXPECT_EQ(resample(in, {200.0, 0.0, 100}).info.attributes.at("resampled"),
            "from 2000 Hz to 200 Hz by a Kaiser-windowed sinc (gain 1 up to 90 Hz, -100 dB from 100 Hz, beta "
            "10.06, 0.3206 s to each "
            "side); point reflection at both ends");
}

TEST(Resample, AlignTakesTheCommonWindowOnOwnTimeStamps) {
  const auto f = [](double t) { return std::sin(two_pi * 3.0 * t); };
  const std::vector<Signal> signals{sampled(2000.0, 0.0, 8000, f), sampled(200.0, 0.0123, 780, f)};
  const std::vector<Signal> out = align(signals, 500.0);
  EXPECT_EQ(out[0].info.start_time_s, 0.0123);
  EXPECT_EQ(out[1].info.start_time_s, 0.0123);
  ASSERT_EQ(out[0].samples.size(), out[1].samples.size());
  EXPECT_LE(out[0].info.end_time_s(), signals[1].info.end_time_s() + 1e-9);
  EXPECT_GT(out[0].info.end_time_s(), signals[1].info.end_time_s() - 0.002);
  for (std::size_t i = 300; i + 300 < out[0].samples.size(); ++i)
    ASSERT_NEAR(out[0].samples[i], out[1].samples[i], 1e-4);
}

TEST(Resample, CubicEvaluationIsExactForCubics) {
  const auto f = [](double t) { return 1.0 - t + 2.0 * t * t - 3.0 * t * t * t; };
  const Signal in = sampled(10.0, -0.2, 12, f);
  const std::vector<double> times{-0.2, -0.17, 0.0, 0.333, 0.81, 0.9};
  const std::vector<double> out = evaluate_at(in, times);
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(out[i], f(times[i]), 1e-13);
}

TEST(Resample, MistakesAreNamed) {
  const Signal in = sampled(200.0, 1.0, 100, [](double t) { return t; });
  EXPECT_EQ(
      error_of([&] {
        resample(in, {100.0, 0.5, 10});
      }),
      "error[outside-signal]: signal `x` lasts from 1 s to 1.495 s; samples from 0.5 s to 0.59 s are wanted\n"
      "  help: use the common time span of the signals\n");
  EXPECT_EQ(error_of([&] {
              resample(in, {0.0, 1.0, 10});
            }),
            "error[bad-rate]: a rate must be greater than 0, not 0 Hz\n");
  EXPECT_THAT(error_of([&] {
                resample(in, {std::numeric_limits<double>::quiet_NaN(), 1.0, 10});
              }),
              HasSubstr("bad-rate"));
  EXPECT_EQ(error_of([&] { design_resampling(1.0, 1.0, {.passband = 1.0}); }),
            "error[bad-option]: `passband` must lie in (0, 1), not be 1\n");
  EXPECT_EQ(
      error_of([&] { evaluate_at(in, std::vector<double>{1.6}); }),
      "error[outside-signal]: signal `x` lasts from 1 s to 1.495 s; samples from 1.6 s to 1.6 s are wanted\n"
      "  help: use the common time span of the signals\n");
  Signal late = in;
  late.info.name = "late";
  late.info.start_time_s = 5.0;
  EXPECT_EQ(
      error_of([&] {
        align(std::vector<Signal>{in, late}, 100.0);
      }),
      "error[no-common-window]: signals `x` and `late` do not overlap in time: one ends at 1.495 s, the "
      "other begins at 5 s\n"
      "  help: check the start times; `time_offset_s` of a session description moves a recorder's clock\n");
  Signal broken = in;
  broken.samples[3] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(error_of([&] {
              resample(broken, {100.0, 1.0, 10});
            }),
            "error[non-finite-sample]: signal `x` has inf at 1.015 s\n");
  broken.samples.resize(1);
  EXPECT_THAT(error_of([&] {
                resample(broken, {100.0, 1.0, 1});
              }),
              HasSubstr("[too-short]: signal `x` has 1 samples, at least 2 are needed"));
}

}  // namespace
}  // namespace brachium::data
