#include "emg/biquad.hpp"

#include "emg/butterworth.hpp"
#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::chirp;
using tests::relative_difference;
using tests::scipy;
using tests::white_noise;

DesignedFilter per_pass(FilterSpec spec, double rate) {
  spec.cutoff = CutoffConvention::per_pass;
  return design(spec, rate);
}

std::vector<double> zero_lag(const DesignedFilter& filter, std::vector<double> x) {
  const std::span<double> channel(x);
  filter_zero_lag(filter.sections, {&channel, 1});
  return x;
}

void expect_at(const std::vector<double>& y, const std::vector<double>& reference) {
  const std::vector<std::size_t> at{0, 1, 7, 500, 1234, 1999};
  for (std::size_t i = 0; i < at.size(); ++i)
    EXPECT_NEAR(y[at[i]], reference[i], 1e-11) << "sample " << at[i];
}

// scipy 1.10.1, printed by `scipy_reference.py numbers`.
TEST(ZeroLag, EqualsScipysSosfiltfiltOnADeterministicSignal) {
  const std::vector<double> x = chirp();
  expect_at(zero_lag(per_pass(FilterSpec::low_pass(6.0), 1000.0), x),
            {0.8103820141255419, 0.8134519578951821, 0.8370934663434368, -0.30411845821661626,
             -0.20533535633095568, 1.2107002072377102});
  expect_at(zero_lag(per_pass(FilterSpec::high_pass(30.0, 3), 1000.0), x),
            {0.007096949018602777, -0.12432490798207918, -0.0336181143544636, -0.4928134189865107,
             0.14859633136353456, -0.15666960049705952});
  expect_at(zero_lag(per_pass(FilterSpec::band_pass(20.0, 200.0, 4), 1000.0), x),
            {0.008583652404420605, -0.26156648004411653, -0.11739703870756209, -0.44889152561103013,
             0.10972481423686534, -0.030480451587847734});
  expect_at(zero_lag(per_pass(FilterSpec::notch(50.0, 1, 2.0), 1000.0), x),
            {0.49233224811389414, 0.35241170896903656, 0.40720362527673426, -0.8897421716066752,
             -0.08851510547022907, 1.4986365473764383});
}

TEST(Causal, EqualsScipysSosfiltFromTheSteadyStateOfTheFirstSample) {
  std::vector<double> x = chirp();
  FilterSpec spec = FilterSpec::low_pass(6.0);
  spec.phase = Phase::causal;
  const std::span<double> channel(x);
  filter_causal(design(spec, 1000.0).sections, {&channel, 1});
  expect_at(x, {0.5, 0.49995025223326384, 0.49249028103758985, 0.422706170738734, -0.7165102228618245,
                1.1577450058633518});
}

TEST(ZeroLag, EqualsScipyForOddAndEvenOrdersOfEveryKind) {
  BRACHIUM_NEEDS_SCIPY();
  const std::vector<double> x = white_noise(5000);
  for (const int order : {1, 4}) {
    const std::string n = std::to_string(order);
    EXPECT_LT(relative_difference(zero_lag(per_pass(FilterSpec::low_pass(20.0, order), 1000.0), x),
                                  scipy("filter", x, "1000 lowpass " + n + " 20")),
              1e-10);
    EXPECT_LT(relative_difference(zero_lag(per_pass(FilterSpec::high_pass(30.0, order), 1000.0), x),
                                  scipy("filter", x, "1000 highpass " + n + " 30")),
              1e-10);
    EXPECT_LT(relative_difference(zero_lag(per_pass(FilterSpec::band_pass(30.0, 300.0, order), 1000.0), x),
                                  scipy("filter", x, "1000 bandpass " + n + " 30 300")),
              1e-10);
  }
}

TEST(Lanes, GiveTheSameBitsForAnyNumberOfChannelsAndAnyPlaceAmongThem) {
  const DesignedFilter filter = design(FilterSpec::band_pass(20.0, 400.0, 3), 2000.0);
  for (const std::size_t length : {50u, 127u, 128u, 129u, 1003u}) {
    std::vector<std::vector<double>> alone;
    for (unsigned c = 0; c < 21; ++c) alone.push_back(zero_lag(filter, white_noise(length, c)));
    for (const std::size_t channels : {2u, 3u, 4u, 5u, 8u, 9u, 16u, 17u, 21u}) {
      std::vector<std::vector<double>> together;
      std::vector<std::span<double>> spans;
      for (unsigned c = 0; c < channels; ++c) together.push_back(white_noise(length, c));
      for (auto& channel : together) spans.emplace_back(channel);
      filter_zero_lag(filter.sections, spans);
      for (std::size_t c = 0; c < channels; ++c)
        ASSERT_EQ(together[c], alone[c]) << channels << " channels, channel " << c;
    }
  }
}

TEST(Lanes, GiveTheBitsOfAPlainLoop) {
  const DesignedFilter filter = design(FilterSpec::low_pass(40.0, 4), 2000.0);
  std::vector<double> plain = white_noise(777), lanes = plain;
  std::vector<double> level = steady_levels(filter.sections), last, before;
  for (const double l : level) last.push_back(l * plain[0]);
  before = last;
  for (double& sample : plain) {
    for (std::size_t s = 0; s < filter.sections.size(); ++s) {
      const Biquad& b = filter.sections[s];
      const double x = sample;
      sample = ((b.b0 * x + b.b1 * last[s]) + (b.b2 * before[s] - b.a2 * before[s + 1])) - b.a1 * last[s + 1];
      before[s] = last[s];
      last[s] = x;
    }
    before.back() = last.back();
    last.back() = sample;
  }
  const std::span<double> channel(lanes);
  filter_causal(filter.sections, {&channel, 1});
  EXPECT_EQ(lanes, plain);
}

TEST(Preparation, SubtractsThenRectifiesOnTheWayIn) {
  const DesignedFilter filter = design(FilterSpec::low_pass(6.0), 1000.0);
  std::vector<double> one = white_noise(3000), by_hand = one;
  for (double& x : by_hand) x = std::abs(x - 0.25);
  const double offset = 0.25;
  const std::span<double> channel(one);
  filter_zero_lag(filter.sections, {&channel, 1}, {{&offset, 1}, true});
  EXPECT_EQ(one, zero_lag(filter, by_hand));
}

TEST(ZeroLag, LeavesAConstantAsItIsAndDelaysNothing) {
  const DesignedFilter filter = design(FilterSpec::low_pass(6.0), 1000.0);
  for (const double y : zero_lag(filter, std::vector<double>(500, 3.7))) EXPECT_NEAR(y, 3.7, 1e-10);
  std::vector<double> pulse(2001, 0.0);
  pulse[1000] = 1.0;
  const std::vector<double> y = zero_lag(filter, pulse);
  for (std::size_t k = 1; k <= 900; ++k) ASSERT_NEAR(y[1000 - k], y[1000 + k], 1e-12);
}

}  // namespace
}  // namespace brachium::emg
