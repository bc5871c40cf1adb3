#include "emg/butterworth.hpp"

#include <numbers>

#include "tests/emg/support.hpp"

namespace brachium::emg {
namespace {

using tests::input_error;
constexpr double root_half = 1.0 / std::numbers::sqrt2;

FilterSpec with(FilterSpec spec, Phase phase, CutoffConvention cutoff = CutoffConvention::after_all_passes) {
  spec.phase = phase;
  spec.cutoff = cutoff;
  return spec;
}

TEST(Butterworth, GainAtTheStatedEdgesIsRootHalfForEveryKindOrderPhaseAndRate) {
  for (const double rate : {500.0, 1000.0, 2000.0, 4000.0}) {
    for (int order = 1; order <= 6; ++order) {
      for (const Phase phase : {Phase::zero_lag, Phase::causal}) {
        for (const double edge : {3.0, 6.0, 30.0, 0.225 * rate, 0.45 * rate}) {
          EXPECT_NEAR(design(with(FilterSpec::low_pass(edge, order), phase), rate).gain(edge), root_half,
                      1e-9);
          EXPECT_NEAR(design(with(FilterSpec::high_pass(edge, order), phase), rate).gain(edge), root_half,
                      1e-9);
        }
        const DesignedFilter band =
            design(with(FilterSpec::band_pass(20.0, 0.45 * rate, order), phase), rate);
        EXPECT_NEAR(band.gain(20.0), root_half, 1e-9) << rate << " " << order;
        EXPECT_NEAR(band.gain(0.45 * rate), root_half, 1e-9) << rate << " " << order;
      }
    }
  }
}

TEST(Butterworth, GainIsOneInThePassBandAndZeroAtTheTransmissionZeros) {
  EXPECT_NEAR(design(FilterSpec::low_pass(6.0), 1000.0).gain(0.0), 1.0, 1e-11);
  EXPECT_NEAR(design(FilterSpec::high_pass(30.0), 1000.0).gain(500.0), 1.0, 1e-12);
  EXPECT_NEAR(design(FilterSpec::high_pass(30.0), 1000.0).gain(0.0), 0.0, 1e-15);
  const double centre =  // the frequency whose prewarped value is the geometric mean of the edges'
      1000.0 / std::numbers::pi *
      std::atan(std::sqrt(std::tan(std::numbers::pi * 0.03) * std::tan(std::numbers::pi * 0.3)));
  EXPECT_NEAR(design(FilterSpec::band_pass(30.0, 300.0, 4), 1000.0).gain(centre), 1.0, 1e-12);
}

TEST(Butterworth, PerPassTwoPassesOfSixHertzReachMinusThreeDecibelAt4_81Hertz) {
  const FilterSpec spec = with(FilterSpec::low_pass(6.0), Phase::zero_lag, CutoffConvention::per_pass);
  const FilterReport report = describe(design(spec, 1000.0));
  ASSERT_EQ(report.edges_hz.size(), 1u);
  EXPECT_NEAR(report.edges_hz[0], 4.81, 0.005);
  EXPECT_NEAR(design(spec, 1000.0).gain(6.0), 0.5, 1e-9);
}

TEST(Butterworth, CorrectingTheEdgeItselfInsteadOfThePrewarpedEdgeIsWrongBy0_095At450HertzOf2Kilohertz) {
  const double C = std::pow(std::numbers::sqrt2 - 1.0, 0.25);
  const FilterSpec naive = with(FilterSpec::low_pass(450.0 / C), Phase::zero_lag, CutoffConvention::per_pass);
  EXPECT_NEAR(std::abs(design(naive, 2000.0).gain(450.0) - root_half), 0.095, 0.001);
}

TEST(Butterworth, CorrectingABandPassEdgeByEdgeGives45To350InsteadOf30To300) {
  // The published practice: both edges divided by C.
  const double C = std::pow(std::numbers::sqrt2 - 1.0, 0.25);
  const FilterSpec naive =
      with(FilterSpec::band_pass(30.0 / C, 300.0 / C, 2), Phase::zero_lag, CutoffConvention::per_pass);
  const FilterReport wrong = describe(design(naive, 1000.0));
  ASSERT_EQ(wrong.edges_hz.size(), 2u);
  EXPECT_NEAR(wrong.edges_hz[0], 45.0, 1.0);
  EXPECT_NEAR(wrong.edges_hz[1], 350.0, 3.0);
  const FilterReport right = describe(design(FilterSpec::band_pass(30.0, 300.0), 1000.0));
  ASSERT_EQ(right.edges_hz.size(), 2u);
  EXPECT_NEAR(right.edges_hz[0], 30.0, 1e-6);
  EXPECT_NEAR(right.edges_hz[1], 300.0, 1e-6);
}

TEST(Butterworth, TheEdgesOfACascadeInteractAndTheTrueOnesAreReported) {
  const std::vector<DesignedFilter> cascade{design(FilterSpec::high_pass(30.0), 1000.0),
                                            design(FilterSpec::low_pass(300.0), 1000.0)};
  EXPECT_LT(gain(cascade, 30.0), root_half);
  EXPECT_NEAR(gain(cascade, 30.0), root_half * cascade[1].gain(30.0), 1e-12);
  const FilterReport report = describe(cascade);
  ASSERT_EQ(report.edges_hz.size(), 2u);
  for (const double edge : report.edges_hz) EXPECT_NEAR(gain(cascade, edge), root_half, 1e-9);
  EXPECT_GT(report.edges_hz[0], 30.0);
  EXPECT_LT(report.edges_hz[1], 300.0);
  EXPECT_EQ(report.effective_order, 8);
}

TEST(Butterworth, SlopeFarBelowTheEdgeIsThatOfTheEffectiveOrder) {
  const DesignedFilter filter = design(FilterSpec::high_pass(30.0, 3), 2000.0);
  EXPECT_EQ(describe(filter).effective_order, 6);
  EXPECT_NEAR(std::log10(filter.gain(0.4) / filter.gain(0.04)), 6.0, 1e-4);
}

TEST(Notch, RemovesEachHarmonicAndItsHalfPowerWidthIsTheStatedOne) {
  for (const Phase phase : {Phase::zero_lag, Phase::causal}) {
    const DesignedFilter one = design(with(FilterSpec::notch(50.0, 1, 2.0), phase), 1000.0);
    const FilterReport report = describe(one);
    ASSERT_EQ(report.edges_hz.size(), 2u);
    EXPECT_NEAR(report.edges_hz[1] - report.edges_hz[0], 2.0, 1e-9);
    EXPECT_NEAR(one.gain(report.edges_hz[0]), root_half, 1e-9);
    EXPECT_NEAR(one.gain(0.0), 1.0, 1e-12);
  }
  const DesignedFilter many = design(FilterSpec::notch(60.0, 10, 2.0), 1000.0);
  EXPECT_EQ(many.sections.size(), 8u);
  EXPECT_EQ(many.left_out_hz, (std::vector<double>{540.0, 600.0}));
  for (int k = 1; k <= 8; ++k) EXPECT_NEAR(many.gain(60.0 * k), 0.0, 1e-12);
  EXPECT_THAT(describe(many).description,
              testing::HasSubstr("left out, too close to half the sampling rate: 540, 600 Hz"));
}

TEST(Butterworth, CausalGroupDelayAtZeroFrequencyEqualsScipys) {
  const FilterSpec spec = with(FilterSpec::low_pass(6.0), Phase::causal);
  const FilterReport report = describe(design(spec, 1000.0));
  EXPECT_NEAR(report.group_delay_s, 37.50873685169817e-3, 1e-8);  // scipy.signal.group_delay
  EXPECT_EQ(report.delay_at_hz, 0.0);
  EXPECT_EQ(describe(design(FilterSpec::low_pass(6.0), 1000.0)).group_delay_s, 0.0);
}

TEST(Butterworth, ReportNamesOrderPhaseAndEdges) {
  EXPECT_EQ(describe(design(FilterSpec::low_pass(6.0), 1000.0)).description,
            "low_pass Butterworth, effective order 4, zero lag, -3 dB after all passes at 6 Hz");
  EXPECT_EQ(describe(design(with(FilterSpec::band_pass(20.0, 400.0), Phase::causal), 2000.0)).description,
            "band_pass Butterworth, effective order 2, causal, group delay 1.112 ms at 89.44 Hz, -3 dB after "
            "all passes "
            "at 20, 400 Hz");
}

TEST(Butterworth, TransientEndsWithinTheStatedTime) {
  const DesignedFilter filter = design(with(FilterSpec::low_pass(6.0), Phase::causal), 1000.0);
  const auto end = static_cast<std::size_t>(std::ceil(describe(filter).transient_s * 1000.0));
  std::vector<double> step(4000, 1.0);
  step[0] = 0.0;  // settled on 0, then 1
  const std::span<double> channel(step);
  filter_causal(filter.sections, {&channel, 1});
  for (std::size_t k = end; k < step.size(); ++k) ASSERT_NEAR(step[k], 1.0, 2.0 * transient_level);
  EXPECT_GT(std::abs(step[end / 4] - 1.0), transient_level);
}

TEST(Butterworth, MistakesAreReportedAtOnceAndByName) {
  EXPECT_EQ(
      input_error([] { (void)design(FilterSpec::low_pass(600.0), 1000.0); }),
      "cutoff-above-nyquist: `high_hz` = 600 Hz is not below 500 Hz, half the sampling rate of 1000 Hz");
  EXPECT_EQ(
      input_error([] { (void)design(FilterSpec::band_pass(-1.0, 500.0, 0), 1000.0); }),
      "out-of-range: `order` = 0 must lie between 1 and 10\n"
      "out-of-range: `low_hz` = -1 Hz must be > 0\n"
      "cutoff-above-nyquist: `high_hz` = 500 Hz is not below 500 Hz, half the sampling rate of 1000 Hz");
  EXPECT_EQ(input_error([] { (void)design(FilterSpec::band_pass(300.0, 30.0), 1000.0); }),
            "out-of-range: `low_hz` = 300 Hz must lie below `high_hz` = 30 Hz");
  EXPECT_EQ(input_error([] { (void)design(FilterSpec::low_pass(std::nan("")), 1000.0); }),
            "out-of-range: `high_hz` = nan Hz must be > 0");
  EXPECT_EQ(input_error([] { (void)parse_cutoff_convention("perpass"); }),
            "unknown-cutoff: `perpass` is not a cut-off convention");
}

}  // namespace
}  // namespace brachium::emg
