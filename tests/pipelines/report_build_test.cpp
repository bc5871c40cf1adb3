#include "pipelines/report/build.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace brachium::pipelines::report {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(ReportBuild, AFindingCarriesMessageHelpCodeAndPlace) {
  data::Diagnostic diagnostic{.severity = data::Severity::warning,
                              .code = "low-snr",
                              .message = "channel `BRA` is noisy",
                              .where = {},
                              .help = "exclude it by name"};
  EXPECT_EQ(make_finding(diagnostic).text, "channel `BRA` is noisy; exclude it by name (`low-snr`)");
  EXPECT_EQ(make_finding(diagnostic).tone, Tone::warning);
  diagnostic.where = data::SourceSpan{.file = "curls.toml", .line = 14, .column = 3, .length = 1, .text = ""};
  EXPECT_EQ(make_finding(diagnostic).text,
            "channel `BRA` is noisy; exclude it by name (`low-snr`, curls.toml:14:3)");
  EXPECT_EQ(tone_of(data::Severity::error), Tone::bad);
  EXPECT_EQ(tone_of(data::Severity::note), Tone::plain);
}

TEST(ReportBuild, VerdictsHaveTheToneOfTheirWords) {
  EXPECT_EQ(verdict_tone("NOT IDENTIFIED (cost changes 0.02 %)"), Tone::bad);
  EXPECT_EQ(verdict_tone("AT UPPER BOUND"), Tone::warning);
  EXPECT_EQ(verdict_tone("AT LOWER BOUND"), Tone::warning);
  EXPECT_EQ(verdict_tone("identified (+-2.1 %)"), Tone::good);
  EXPECT_EQ(verdict_tone("BIClong"), Tone::plain);
  EXPECT_EQ(verdict_tone("badly named"), Tone::plain);
}

TEST(ReportBuild, ThresholdsWorkInBothDirectionsAndNanIsBad) {
  EXPECT_EQ(threshold_tone(20.0, 15.0, 6.0), Tone::good);
  EXPECT_EQ(threshold_tone(9.0, 15.0, 6.0), Tone::warning);
  EXPECT_EQ(threshold_tone(5.0, 15.0, 6.0), Tone::bad);
  EXPECT_EQ(threshold_tone(0.01, 0.05, 0.2), Tone::good);
  EXPECT_EQ(threshold_tone(0.1, 0.05, 0.2), Tone::warning);
  EXPECT_EQ(threshold_tone(0.3, 0.05, 0.2), Tone::bad);
  EXPECT_EQ(threshold_tone(kNan, 15.0, 6.0), Tone::bad);
}

/// A session of one trial with one signal.
data::Session session_of(const data::Signal& signal) {
  data::Trial trial;
  trial.name = "trial";
  trial.signals = {signal};
  data::Session session;
  session.trials = {trial};
  return session;
}

TEST(ReportBuild, ASignalBecomesACurveOnItsOwnClockInTheUnitOfTheAxis) {
  data::Signal signal;
  signal.info.name = "elbow";
  signal.info.unit = "rad";
  signal.info.rate_hz = 100.0;
  signal.info.start_time_s = 2.0;
  signal.samples = {0.0, std::numbers::pi / 2.0};
  signal.info.count = 2;
  const Series series = make_series(signal, "angle", "deg");
  EXPECT_DOUBLE_EQ(series.x[1], 2.01);
  EXPECT_NEAR(series.y[1], 90.0, 1e-12);
  const data::Session session = session_of(signal);
  const std::size_t only[] = {0};
  const Plot plot = make_time_plot("Angle", "elbow angle", data::MemorySession(session), 0, only, "deg");
  EXPECT_EQ(plot.y_label, "elbow angle [deg]");
  EXPECT_EQ(plot.series[0].label, "elbow");
  EXPECT_THROW(make_series(signal, "angle", "N m"), data::InputError);
}

TEST(ReportBuild, ALongSignalIsThinnedPieceByPieceAndKeepsItsEndsAndExtremes) {
  data::Signal signal;
  signal.info.name = "emg";
  signal.info.unit = "V";
  signal.info.rate_hz = 2000.0;
  signal.samples.assign(1'000'003, 0.0);
  for (std::size_t i = 0; i < signal.samples.size(); ++i)
    signal.samples[i] = std::sin(0.37 * static_cast<double>(i));
  signal.samples[654'321] = 5.0;
  signal.samples[777'777] = -5.0;
  signal.info.count = signal.samples.size();
  const data::Session session = session_of(signal);
  const Series series = make_series(data::MemorySession(session), 0, 0, "emg", "mV");
  EXPECT_LE(series.x.size(), 4 * long_series);
  EXPECT_EQ(series.x.front(), 0.0);
  EXPECT_DOUBLE_EQ(series.x.back(), 1'000'002.0 / 2000.0);
  const auto [low, high] = std::minmax_element(series.y.begin(), series.y.end());
  EXPECT_DOUBLE_EQ(*high, 5000.0);
  EXPECT_DOUBLE_EQ(*low, -5000.0);
  EXPECT_DOUBLE_EQ(series.x[static_cast<std::size_t>(high - series.y.begin())], 654'321.0 / 2000.0);
  EXPECT_TRUE(std::is_sorted(series.x.begin(), series.x.end()));
}

data::Table table() {
  return {.title = "Fit",
          .columns = {{"muscle", "", std::vector<std::string>{"BRA", "TRI"}},
                      {"rmse", "N m", std::vector<double>{1.02345, kNan}},
                      {"frames", "1", std::vector<double>{1200.0, 6000.0}},
                      {"slack_length", "m", std::vector<double>{0.0615, 0.1}},
                      {"verdict", "", std::vector<std::string>{"AT UPPER BOUND", "identified"}}}};
}

TEST(ReportBuild, ATableKeepsItsUnitsAndCountsHaveNoDecimals) {
  const Grid grid = make_grid(
      table(), {.digits = 3, .names = {{"slack_length", "slack length"}}, .units = {{"slack_length", "mm"}}});
  EXPECT_EQ(grid.header,
            (std::vector<std::string>{"muscle", "RMSE [N m]", "frames", "slack length [mm]", "verdict"}));
  EXPECT_EQ(grid.rows[0][1].text, "1.02");
  EXPECT_EQ(grid.rows[1][1].text, "–");
  EXPECT_EQ(grid.rows[1][2].text, "6000");
  EXPECT_EQ(grid.rows[0][3].text, "61.5");
  EXPECT_TRUE(grid.rows[0][1].numeric);
  EXPECT_EQ(grid.rows[0][4].tone, Tone::warning);
  EXPECT_EQ(grid.rows[1][4].tone, Tone::good);
}

TEST(ReportBuild, RulesOfToneSeeStoredUnitsAndColumnsAreChosenByName) {
  GridOptions options;
  options.columns = {"verdict", "slack_length"};
  options.units = {{"slack_length", "mm"}};
  options.number_tone["slack_length"] = [](double m) { return m < 0.08 ? Tone::bad : Tone::good; };
  const Grid grid = make_grid(table(), options);
  ASSERT_EQ(grid.header.size(), 2u);
  EXPECT_EQ(grid.rows[0][1].tone, Tone::bad);
  EXPECT_EQ(grid.rows[1][1].tone, Tone::good);
  options.columns = {"no such column"};
  EXPECT_THROW(make_grid(table(), options), data::InputError);
}

struct Samples {
  std::vector<double> time, measured, modelled;
};

Samples samples() {
  Samples s;
  for (int i = 1; i <= 40; ++i) {
    s.time.push_back(0.01 * i);
    s.measured.push_back(5.0 * std::sin(0.3 * i) + 0.1 * i);
    s.modelled.push_back(4.6 * std::sin(0.3 * i + 0.1) + 0.1 * i + 0.2);
  }
  return s;
}

/// Numbers of report_agreement.py (numpy).
TEST(ReportAgreement, FiguresAreThoseOfNumpy) {
  const Samples s = samples();
  const AgreementFigures f = agreement_figures(s.measured, s.modelled);
  EXPECT_EQ(f.frames, 40u);
  EXPECT_NEAR(f.rmse, 0.471510452288969, 1e-13);
  EXPECT_NEAR(f.mean_absolute, 0.403711468928849, 1e-13);
  EXPECT_NEAR(f.largest, 0.819702529620398, 1e-13);
  EXPECT_NEAR(f.nrmse.value(), 0.0429412276250838, 1e-13);
  EXPECT_NEAR(f.r_squared.value(), 0.979864870999377, 1e-13);
  EXPECT_NEAR(f.bias, 0.176097973990931, 1e-13);
  EXPECT_NEAR(f.deviation, 0.442963921867161, 1e-13);
}

TEST(ReportAgreement, FramesWithoutBothValuesDoNotCount) {
  Samples s = samples();
  const AgreementFigures before = agreement_figures(s.measured, s.modelled);
  s.measured.push_back(kNan);
  s.modelled.push_back(1e6);
  const AgreementFigures after = agreement_figures(s.measured, s.modelled);
  EXPECT_EQ(after.frames, before.frames);
  EXPECT_EQ(after.rmse, before.rmse);
}

TEST(ReportAgreement, AgainstAConstantMeasurementR2IsNotDefinedAndTheErrorStillIs) {
  const std::vector<double> time{0, 1, 2}, measured{3, 3, 3}, modelled{1, 2, 3};
  const AgreementFigures f = agreement_figures(measured, modelled);
  EXPECT_FALSE(f.r_squared);
  EXPECT_FALSE(f.nrmse);
  EXPECT_DOUBLE_EQ(f.bias, -1.0);
  const Plot plot = make_agreement_plot("hold", {time, measured, modelled, "moment", "N m"});
  EXPECT_THAT(plot.note, HasSubstr("NRMSE and R² not defined, since the measured values do not vary, bias"));
  const Grid grid = make_grid({.title = "scores", .columns = {{"r2", "1", std::vector<double>{kNan}}}},
                              {.undefined = "not defined"});
  EXPECT_EQ(grid.rows[0][0].text, "not defined");
}

TEST(ReportAgreement, OneCommonFrameHasNoFigures) {
  const auto message = [](std::vector<double> measured, std::vector<double> modelled) -> std::string {
    try {
      agreement_figures(measured, modelled);
    } catch (const data::InputError& error) {
      return error.diagnostics().front().code + ": " + error.diagnostics().front().message;
    }
    return "";
  };
  EXPECT_EQ(message({3, kNan}, {1, 2}),
            "no-common-frames: measured and modelled values have 1 frames in common, 2 are needed");
}

TEST(ReportAgreement, ThePlotCarriesResidualPanelAndFigures) {
  const Samples s = samples();
  const Pair pair{.time_s = s.time,
                  .measured = s.measured,
                  .modelled = s.modelled,
                  .quantity = "elbow moment",
                  .unit = "N m"};
  const Plot plot = make_agreement_plot("Trial 1", pair);
  ASSERT_EQ(plot.below.size(), 1u);
  EXPECT_DOUBLE_EQ(plot.below[0].series[0].y[4], s.modelled[4] - s.measured[4]);
  EXPECT_EQ(plot.series[1].style, Style::dashed) << "modelled is told from measured without colour";
  EXPECT_THAT(plot.note, HasSubstr("RMSE 0."));
  EXPECT_TRUE(make_scatter_plot("S", pair).equal_axes);
}

TEST(ReportAgreement, LimitsOfAgreementAreBiasAndTwiceNinetyEightHundredthsOfTheDeviation) {
  const Samples s = samples();
  const Plot plot = make_bland_altman_plot(
      "B",
      {.time_s = s.time, .measured = s.measured, .modelled = s.modelled, .quantity = "m", .unit = "N m"});
  const AgreementFigures f = agreement_figures(s.measured, s.modelled);
  ASSERT_EQ(plot.levels.size(), 3u);
  EXPECT_DOUBLE_EQ(plot.levels[0].y, f.bias);
  EXPECT_DOUBLE_EQ(plot.levels[1].y, f.bias + 1.96 * f.deviation);
  EXPECT_DOUBLE_EQ(plot.levels[2].y, f.bias - 1.96 * f.deviation);
  EXPECT_DOUBLE_EQ(plot.series[0].x[3], 0.5 * (s.measured[3] + s.modelled[3]));
}

TEST(ReportAgreement, WithoutCommonFramesThereIsStillAPictureAndTheReasonIsGiven) {
  const std::vector<double> flat = {2, kNan}, other = {1, 3}, time = {0, 1};
  const Pair pair{.time_s = time, .measured = flat, .modelled = other, .quantity = "m", .unit = "N m"};
  EXPECT_EQ(make_agreement_plot("A", pair).note,
            "No figures of agreement: measured and modelled values have 1 frames in common, 2 are needed.");
  EXPECT_EQ(make_bland_altman_plot("B", pair).note,
            "No limits of agreement: measured and modelled values have 1 frames in common, 2 are needed.");
  EXPECT_THROW(
      make_scatter_plot("S", {.time_s = time, .measured = flat, .modelled = {}, .quantity = "m", .unit = ""}),
      std::logic_error);
}

}  // namespace
}  // namespace brachium::pipelines::report
