#include "emg/conditioning.hpp"

#include <numbers>
#include <numeric>

#include "data/model/parallel.hpp"
#include "emg/synthetic_emg.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::input_error;
using tests::white_noise;

struct Conditioned {
  OutputLayout layout;
  std::vector<double> envelope;
  std::vector<double> offsets;
};

Conditioned run(const ConditioningOptions& options, double rate, std::vector<double> x,
                ConditioningSteps* steps = nullptr) {
  const ConditioningChain chain = design_conditioning(options, rate);
  const std::span<double> channel(x);
  const std::string name = "BIC";
  Conditioned result;
  result.layout = condition(chain, {&channel, 1}, {&name, 1}, "trial", steps, &result.offsets);
  x.resize(result.layout.count);
  result.envelope = std::move(x);
  return result;
}

std::vector<double> constant_emg(double seconds, double offset = 0.0, std::uint64_t seed = 1) {
  SyntheticEmgOptions options;
  options.seed = seed;
  options.offset_V = offset;
  const std::vector<double> e(static_cast<std::size_t>(seconds * 100.0) + 1, 1.0);
  return synthesise_emg(e, 100.0, options).raw;
}

TEST(Conditioning, EnvelopeOfAConstantContractionIsItsMeanRectifiedValue) {
  ConditioningOptions options;
  options.highpass_hz = 1.0;  // almost all of the power passes
  const Conditioned result = run(options, 2000.0, constant_emg(60.0));
  const double mean = std::accumulate(result.envelope.begin(), result.envelope.end(), 0.0) /
                      static_cast<double>(result.envelope.size());
  EXPECT_NEAR(mean, 0.5e-3 * std::sqrt(2.0 / std::numbers::pi), 0.01 * 0.5e-3);
}

TEST(Conditioning, OffsetDoesNotReachTheEnvelope) {
  const Conditioned without = run({}, 2000.0, constant_emg(5.0));
  const Conditioned with = run({}, 2000.0, constant_emg(5.0, 0.02));
  EXPECT_LT(tests::relative_difference(with.envelope, without.envelope), 1e-9);
  EXPECT_NEAR(with.offsets[0] - without.offsets[0], 0.02, 1e-12);
}

TEST(Conditioning, SixteenChannelsOnAnyNumberOfThreadsGiveTheBitsOfOneAlone) {
  ConditioningOptions options;
  options.notch_hz = 50.0;
  options.output_rate_hz = 200.0;
  const ConditioningChain chain = design_conditioning(options, 2000.0);
  std::vector<Conditioned> alone;
  for (unsigned c = 0; c < 16; ++c) alone.push_back(run(options, 2000.0, white_noise(9001, c)));
  for (const std::size_t threads : {1u, 2u, 5u}) {
    std::vector<std::vector<double>> x;
    for (unsigned c = 0; c < 16; ++c) x.push_back(white_noise(9001, c));
    const std::size_t groups = threads;  // channels split over threads
    data::parallel_for(groups, threads, [&](std::size_t g) {
      std::vector<std::span<double>> mine;
      std::vector<std::string> names;
      for (std::size_t c = g; c < 16; c += groups) {
        mine.emplace_back(x[c]);
        names.emplace_back("channel");
      }
      condition(chain, mine, names, "trial");
    });
    for (std::size_t c = 0; c < 16; ++c) {
      x[c].resize(alone[c].layout.count);
      ASSERT_EQ(x[c], alone[c].envelope) << threads << " threads, channel " << c;
    }
  }
}

TEST(Conditioning, StepsInAWindowAreThoseOfTheWholeTrial) {
  const std::vector<double> x = constant_emg(4.0, 0.01);
  ConditioningOptions options;
  options.trim_edges = false;
  ConditioningSteps steps;
  steps.first = 3000;
  steps.count = 500;
  const Conditioned result = run(options, 2000.0, x, &steps);
  for (std::size_t k = 0; k < 500; ++k) {
    ASSERT_EQ(steps.raw[k], x[3000 + k]);
    ASSERT_EQ(steps.offset_removed[k], x[3000 + k] - result.offsets[0]);
    ASSERT_EQ(steps.rectified[k], std::abs(steps.filtered[k]));
    ASSERT_EQ(steps.envelope[k], result.envelope[3000 + k]);
  }
}

TEST(Conditioning, EdgesAreTrimmedAndSaid) {
  const ConditioningChain chain = design_conditioning({}, 2000.0);
  const double transient = chain.band_report.transient_s + chain.envelope_report.transient_s;
  EXPECT_EQ(chain.edge_start_samples, static_cast<std::size_t>(std::ceil(transient * 2000.0)));
  EXPECT_EQ(chain.edge_end_samples, chain.edge_start_samples);
  EXPECT_NEAR(transient, 0.26, 0.03);
  const OutputLayout layout = output_layout(chain, 20000, "t");
  EXPECT_EQ(layout.kept, 20000 - 2 * chain.edge_start_samples);
  EXPECT_DOUBLE_EQ(layout.start_shift_s, static_cast<double>(chain.edge_start_samples) / 2000.0);
  EXPECT_EQ(attributes(chain).at("emg.edges_trimmed"), "yes");
  EXPECT_EQ(attributes(chain).at("emg.envelope_edges_hz"), "6");
  EXPECT_EQ(attributes(chain).at("emg.edges_before_rectification_hz"), "30");
  EXPECT_EQ(attributes(chain).at("emg.effective_order_envelope"), "4");
}

TEST(Conditioning, WhatIsKeptDoesNotDependOnWhatWasRecordedBeforeAndAfter) {
  // The same muscle, recorded from 2 s later on and 2 s less long: inside the kept part both agree to the stated level.
  std::vector<double> x = constant_emg(14.0);
  ConditioningOptions options;
  options.remove_offset = false;
  const Conditioned whole = run(options, 2000.0, x);
  const Conditioned part = run(options, 2000.0, {x.begin() + 4000, x.end() - 4000});
  double worst = 0.0;
  for (std::size_t k = 0; k < part.envelope.size(); ++k)
    worst = std::max(worst, std::abs(part.envelope[k] - whole.envelope[4000 + k]));
  EXPECT_LT(worst / tests::largest(whole.envelope), 5e-3);
}

TEST(Conditioning, CausalChainDelaysByItsReportedGroupDelay) {
  ConditioningOptions options;
  options.highpass_hz = 0.0;
  options.remove_offset = false;
  options.rectify = false;
  options.trim_edges = false;
  options.phase = Phase::causal;
  const ConditioningChain chain = design_conditioning(options, 1000.0);
  EXPECT_EQ(chain.edge_end_samples, 0u);
  std::vector<double> x(4000);
  for (std::size_t k = 0; k < x.size(); ++k)
    x[k] = std::sin(2 * std::numbers::pi * 0.5 * static_cast<double>(k) / 1000.0);
  const Conditioned result = run(options, 1000.0, x);
  for (std::size_t k = 2000; k < 4000; ++k) {
    const double t = static_cast<double>(k) / 1000.0 - chain.group_delay_s;
    ASSERT_NEAR(result.envelope[k], std::sin(2 * std::numbers::pi * 0.5 * t), 1e-3);
  }
}

TEST(OutputRate, WholeRatiosPickSamplesAndOthersInterpolateBandLimited) {
  const std::vector<double> x = constant_emg(6.0);
  ConditioningOptions full, tenth, odd;
  tenth.output_rate_hz = 200.0;
  odd.output_rate_hz = 300.0;
  const Conditioned at2000 = run(full, 2000.0, x), at200 = run(tenth, 2000.0, x), at300 = run(odd, 2000.0, x);
  for (std::size_t k = 0; k < at200.envelope.size(); ++k)
    ASSERT_EQ(at200.envelope[k], at2000.envelope[10 * k]);
  EXPECT_EQ(at300.layout.count, (at2000.layout.count - 1) * 3 / 20 + 1);
  // Sample 3 m of 300 Hz is sample 20 m of 2000 Hz.
  for (std::size_t m = 0; 3 * m < at300.envelope.size(); ++m)
    ASSERT_NEAR(at300.envelope[3 * m], at2000.envelope[20 * m], 1e-9);
  // In between: cubic interpolation of the dense envelope, whose own error is far smaller.
  for (std::size_t k = 9; k + 30 < at300.envelope.size(); ++k) {
    const double p = static_cast<double>(k) * 20.0 / 3.0;
    const auto i = static_cast<std::size_t>(p);
    const double s = p - static_cast<double>(i);
    const double* y = &at2000.envelope[i - 1];
    const double cubic =
        y[1] + 0.5 * s *
                   (y[2] - y[0] +
                    s * (2 * y[0] - 5 * y[1] + 4 * y[2] - y[3] + s * (3 * (y[1] - y[2]) + y[3] - y[0])));
    ASSERT_NEAR(at300.envelope[k], cubic, 1e-6 * tests::largest(at2000.envelope));
  }
}

TEST(OutputRate, TooLowForTheEnvelopeIsRefusedWithTheLowestThatIsNot) {
  ConditioningOptions options;
  options.output_rate_hz = 20.0;
  EXPECT_EQ(input_error([&] { (void)design_conditioning(options, 2000.0); }),
            "output-rate-too-low: `output_rate_hz` = 20 Hz would fold frequencies above 10 Hz back: the "
            "envelope filter "
            "still has a gain of 0.238 there, the limit is 0.01");
}

TEST(Conditioning, BadInputIsRefusedByName) {
  ConditioningOptions high;
  high.highpass_hz = 600.0;
  high.lowpass_hz = -1.0;
  EXPECT_EQ(
      input_error([&] { (void)design_conditioning(high, 1000.0); }),
      "cutoff-above-nyquist: `highpass_hz` = 600 Hz is not below 500 Hz, half the sampling rate of 1000 Hz\n"
      "out-of-range: `lowpass_hz` = -1 Hz must be >= 0");
  EXPECT_EQ(
      input_error([] { (void)run({}, 2000.0, std::vector<double>(300, 0.0)); }),
      "trial-too-short: trial `trial` has 300 samples (0.15 s); its filters need at least 1126 (0.563 s)");
  ConditioningOptions untrimmed;
  untrimmed.trim_edges = false;
  EXPECT_EQ(
      input_error([&] { (void)run(untrimmed, 2000.0, std::vector<double>(9, 0.0)); }),
      "trial-too-short: trial `trial` has 9 samples (0.0045 s); its filters need at least 10 (0.005 s)");
  EXPECT_EQ(
      input_error([] { (void)run({}, 2000.0, std::vector<double>(4000, 1e307)); }),
      "not-finite: the sum of the samples of channel `BIC` of trial `trial` is beyond the range of numbers");
  std::vector<double> x = white_noise(4000);
  x[100] = std::nan("");
  x[200] = INFINITY;
  EXPECT_EQ(input_error([&] { (void)run({}, 2000.0, x); }),
            "not-finite: channel `BIC` of trial `trial` has 2 samples that are not finite, the first, nan, "
            "at 0.05 s");
}

TEST(Streaming, GivesTheBitsOfTheWholeInMemoryForAnyMemoryBudget) {
  data::Session session;
  data::Trial trial;
  trial.name = "curl";
  std::vector<std::size_t> signals;
  for (unsigned c = 0; c < 5; ++c) {
    data::Signal signal;
    signal.info.name = "emg" + std::to_string(c);
    signal.info.quantity = data::Quantity::emg;
    signal.info.unit = "V";
    signal.info.rate_hz = 1000.0;
    signal.info.start_time_s = 2.0;
    signal.samples = white_noise(3000, c);
    signal.info.count = signal.samples.size();
    trial.signals.push_back(signal);
    signals.push_back(c);
  }
  session.trials.push_back(trial);
  const data::MemorySession source(session);
  ConditioningOptions options;
  options.output_rate_hz = 100.0;
  for (const std::size_t budget : {std::size_t{1}, 3000 * sizeof(double) * 2, std::size_t{1} << 30}) {
    data::MemorySession sink;
    sink.begin(source.info());
    sink.begin_trial(source.info().trials[0]);
    const StreamResult result = condition_trial(options, source, 0, signals, sink, budget);
    for (unsigned c = 0; c < 5; ++c) {
      const data::Signal& out = sink.session().trials[0].signals[c];
      EXPECT_EQ(out.samples, run(options, 1000.0, white_noise(3000, c)).envelope);
      EXPECT_EQ(out.info.rate_hz, 100.0);
      EXPECT_DOUBLE_EQ(out.info.start_time_s, 2.0 + result.layout.start_shift_s);
      EXPECT_EQ(out.info.attributes.at("emg.cutoff"), "after_all_passes");
    }
  }
  session.trials[0].signals[3].info.rate_hz = 500.0;
  const data::MemorySession mixed(session);
  data::MemorySession sink;
  EXPECT_EQ(input_error([&] { (void)condition_trial(options, mixed, 0, signals, sink); }),
            "rate-mismatch: signals `emg0` and `emg3` of trial `curl` differ: 3000 samples at 1000 Hz, 3000 "
            "samples at 500 Hz");
}

}  // namespace
}  // namespace brachium::emg
