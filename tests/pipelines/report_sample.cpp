#include "tests/pipelines/report_sample.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "pipelines/report/build.hpp"

namespace brachium::tests {
namespace {

using namespace pipelines::report;

const std::vector<std::string> kMuscles = {"BIClong", "BICshort", "BRA",   "BRD",
                                           "TRIlong", "TRIlat",   "TRImed"};
constexpr double kRateRaw = 2000.0;
constexpr double kRate = 200.0;
constexpr double kDuration = 30.0;

double excitation(double t, int muscle, int trial) {
  const double phase = 2.0 * std::numbers::pi * t / (5.0 + 0.3 * trial) + (muscle >= 4 ? 2.6 : 0.3 * muscle);
  return 0.04 + 0.5 * std::pow(std::max(0.0, std::sin(phase)), 1.5) * (0.6 + 0.06 * muscle);
}

data::Signal raw_signal(int muscle, int trial) {
  data::Signal signal;
  signal.info = {.name = kMuscles[static_cast<std::size_t>(muscle)] + ".raw",
                 .quantity = data::Quantity::emg,
                 .unit = "V",
                 .rate_hz = kRateRaw,
                 .start_time_s = 0.0,
                 .count = static_cast<std::size_t>(kDuration * kRateRaw),
                 .muscle = kMuscles[static_cast<std::size_t>(muscle)],
                 .coordinate = "",
                 .attributes = {}};
  std::mt19937 generator(static_cast<unsigned>(100 * trial + muscle));
  for (std::size_t i = 0; i < signal.info.count; ++i) {
    const double noise = static_cast<double>(generator()) / 2147483648.0 - 1.0;
    signal.samples.push_back(8e-4 * excitation(signal.info.time_s(i), muscle, trial) * noise);
  }
  return signal;
}

Series series_of(const std::string& label, Style style, int muscle, int trial, double delay, double gain) {
  Series series{.label = label, .style = style};
  for (int i = 0; i < static_cast<int>(kDuration * kRate); ++i) {
    const double t = i / kRate;
    series.x.push_back(t);
    series.y.push_back(gain * excitation(t - delay, muscle, trial));
  }
  return series;
}

Section quality() {
  Section section{.title = "EMG quality"};
  section.blocks.push_back(Paragraph{
      .text = "Every channel is judged on the raw recording, before any filter. Thresholds are the options "
              "of stage "
              "`quality`; a channel that fails is excluded by name."});
  data::Table table{
      .title = "Channels, worst trial",
      .columns = {
          {"channel", "", std::vector<std::string>(kMuscles)},
          {"clipped samples", "1", std::vector<double>{0, 0, 12, 0, 0, 0, 3}},
          {"signal to noise", "1", std::vector<double>{31.2, 28.75, 22.1, 19.4, 9.8, 25.3, 4.1}},
          {"baseline", "V", std::vector<double>{1.2e-6, 1.5e-6, 2.2e-6, 1.1e-6, 9e-6, 1.9e-6, 2.1e-5}},
          {"median frequency", "Hz", std::vector<double>{81.2, 77.5, 69.9, 92.0, 66.1, 71.4, 118.3}},
          {"verdict", "",
           std::vector<std::string>{"ok", "ok", "ok", "ok", "warning: line hum", "ok",
                                    "failed: signal to noise"}}}};
  section.blocks.push_back(make_grid(
      table, {.digits = 3,
              .units = {{"baseline", "uV"}},
              .number_tone = {{"signal to noise", [](double v) { return threshold_tone(v, 15.0, 6.0); }}}}));
  return section;
}

Section conditioning() {
  Section section{.title = "Conditioning, step by step"};
  section.blocks.push_back(
      Paragraph{.text = "Each step of one channel and trial. The others are folded below."});
  Plot steps{.title = "BIClong, trial curl-1", .x_label = "time [s]", .y_label = "raw [uV]"};
  steps.height_px = 90.0;
  steps.series.push_back(make_series(raw_signal(0, 1), "raw", "uV"));
  Plot rectified{.y_label = "rectified [uV]"};
  rectified.height_px = 70.0;
  rectified.series.push_back(make_series(raw_signal(0, 1), "rectified", "uV"));
  for (double& y : rectified.series[0].y) y = std::abs(y);
  Plot envelope{.y_label = "envelope [% MVC]"};
  envelope.height_px = 90.0;
  envelope.series.push_back(series_of("envelope", Style::line, 0, 1, 0.0, 100.0));
  envelope.series.push_back(series_of("activation", Style::dashed, 0, 1, 0.06, 92.0));
  steps.below = {rectified, envelope};
  steps.markers = {{.from = 0.0, .to = 0.6, .label = "trimmed"},
                   {.from = 5.95, .label = "onset", .tone = Tone::good},
                   {.from = 8.6, .label = "offset", .tone = Tone::good},
                   {.from = 20.0, .to = 25.0, .label = "held out", .tone = Tone::warning},
                   {.from = 25.4, .label = "artefact", .tone = Tone::bad}};
  steps.note =
      "High-pass 30 Hz, rectified, low-pass 6 Hz, zero lag; the first 0.6 s are lost to the filter's edge.";
  section.blocks.push_back(PlotRow{.plots = {steps}});
  for (int trial = 1; trial <= 6; ++trial) {
    PlotRow row;
    for (int m = 0; m < static_cast<int>(kMuscles.size()); ++m) {
      Plot plot{.title = kMuscles[static_cast<std::size_t>(m)], .x_label = "time [s]", .y_label = "EMG [uV]"};
      plot.height_px = 90.0;
      plot.series.push_back(make_series(raw_signal(m, trial), "high-passed", "uV"));
      plot.series.push_back(series_of("envelope", Style::line, m, trial, 0.0, 400.0));
      row.plots.push_back(plot);
    }
    section.blocks.push_back(Details{.summary = "Trial curl-" + std::to_string(trial),
                                     .content = {{.title = "", .anchor = "", .blocks = {row}}}});
  }
  return section;
}

Section activations() {
  Section section{.title = "Activations"};
  PlotRow row;
  for (int m = 0; m < static_cast<int>(kMuscles.size()); ++m) {
    Plot plot{.title = kMuscles[static_cast<std::size_t>(m)], .x_label = "time [s]", .y_label = "[1]"};
    plot.height_px = 100.0;
    plot.y_min = 0.0;
    plot.y_max = 1.0;
    plot.series.push_back(series_of("excitation", Style::line, m, 1, 0.0, 1.0));
    plot.series.push_back(series_of("activation", Style::dashed, m, 1, 0.08, 0.9));
    plot.markers = {{.from = 2.0, .label = "onset"}, {.from = 7.0, .label = "onset"}};
    row.plots.push_back(plot);
  }
  section.blocks.push_back(row);
  Plot all{.title = "All muscles, trial curl-2", .x_label = "time [s]", .y_label = "activation [1]"};
  for (int m = 0; m < static_cast<int>(kMuscles.size()); ++m) {
    all.series.push_back(series_of(kMuscles[static_cast<std::size_t>(m)], Style::line, m, 2, 0.08, 0.9));
  }
  section.blocks.push_back(PlotRow{.plots = {all}});
  return section;
}

Section calibration() {
  Section section{.title = "Calibration"};
  Grid grid{.caption = "Parameters",
            .header = {"muscle", "parameter", "start", "fitted", "±", "lower", "upper", "verdict"}};
  const auto row = [&](const char* muscle, const char* parameter, double start, double fitted, double width,
                       double lower, double upper, const std::string& verdict) {
    grid.rows.push_back({make_text_cell(muscle), make_text_cell(std::string("`") + parameter + "`"),
                         make_number_cell(start), make_number_cell(fitted), make_number_cell(width, 2),
                         make_number_cell(lower), make_number_cell(upper),
                         make_text_cell(verdict, verdict_tone(verdict))});
  };
  row("BIClong", "optimal_fibre_length_m", 0.1157, 0.1219, 0.0026, 0.0984, 0.133, "identified (± 2.1 %)");
  row("BRA", "tendon_slack_length_m", 0.0535, 0.0615, 0.0, 0.0455, 0.0615, "AT UPPER BOUND");
  row("TRIlat", "delay_s", 0.040, 0.061, std::numeric_limits<double>::quiet_NaN(), 0.010, 0.120,
      "NOT IDENTIFIED (cost changes 0.02 % over the range)");
  row("all", "activation_c1", -0.02, -1.2e-6, 3e-7, -0.99, 0.99, "correlated 0.98 with `activation_c2`");
  grid.notes = {"± is the half width of the 95 % interval from the covariance at the optimum."};
  section.blocks.push_back(grid);
  Plot bars{.title = "Strength factors", .y_label = "strength [1]"};
  bars.categories = kMuscles;
  bars.categories[5] = "TRIlat (excluded)";
  bars.series = {
      {.label = "start", .x = {0, 1, 2, 3, 4, 5, 6}, .y = {1, 1, 1, 1, 1, 1, 1}, .style = Style::bars},
      {.label = "fitted",
       .x = {0, 1, 2, 3, 4, 5, 6},
       .y = {1.2, .9, 1.5, 1.1, .7, .85, 1},
       .style = Style::bars}};
  bars.levels = {{.y = 1.5, .label = "upper bound", .tone = Tone::warning}};
  Plot cost{.title = "Cost", .x_label = "evaluation", .y_label = "cost [N^2 m^2]"};
  cost.log_y = true;
  cost.log_x = true;
  for (int start = 0; start < 3; ++start) {
    Series s{.label = "start " + std::to_string(start + 1), .style = Style::step};
    for (int i = 1; i <= 400; ++i) {
      s.x.push_back(i);
      s.y.push_back(0.01 * (start + 1) + 300.0 * std::exp(-0.05 * i * (1 + 0.3 * start)));
    }
    cost.series.push_back(s);
  }
  section.blocks.push_back(PlotRow{.plots = {bars, cost}});
  return section;
}

Section moments() {
  Section section{.title = "Measured and modelled elbow moment"};
  section.blocks.push_back(
      Paragraph{.text = "Trial curl-6 was not seen by the calibration.", .tone = Tone::good});
  std::vector<double> time, measured, modelled;
  std::mt19937 generator(7);
  for (int i = 0; i < static_cast<int>(kDuration * kRate); ++i) {
    const double t = i / kRate;
    time.push_back(t);
    measured.push_back(9.0 * std::sin(2.0 * std::numbers::pi * t / 5.0) + 4.0 + 0.8 * std::sin(1.7 * t));
    modelled.push_back(measured.back() * 0.93 + 0.9 * std::sin(3.1 * t) +
                       0.4 * (static_cast<double>(generator()) / 2147483648.0 - 1.0));
  }
  for (int i = 3000; i < 3200; ++i)
    measured[static_cast<std::size_t>(i)] = std::numeric_limits<double>::quiet_NaN();
  const Pair pair{
      .time_s = time, .measured = measured, .modelled = modelled, .quantity = "elbow moment", .unit = "N m"};
  Plot agreement = make_agreement_plot("Trial curl-6 (held out)", pair);
  Series band{.label = "moment from assumed masses, ± 10 %", .x = time, .style = Style::area, .colour = 6};
  for (const double m : measured) {
    band.y.push_back(m + 0.1 * std::abs(m) + 0.5);
    band.y_lower.push_back(m - 0.1 * std::abs(m) - 0.5);
  }
  agreement.series.insert(agreement.series.begin(), band);
  section.blocks.push_back(PlotRow{.plots = {agreement}});
  section.blocks.push_back(PlotRow{.plots = {make_scatter_plot("Modelled against measured", pair),
                                             make_bland_altman_plot("Agreement over the range", pair)}});
  return section;
}

Section odd() {
  Section section{.title = "Edge cases <b>&amp; \"escaping\""};
  Plot empty{.title = "Nothing recorded", .x_label = "time [s]", .y_label = "force [N]"};
  Plot constant{.title = "A constant", .x_label = "time [s]", .y_label = "force [N]"};
  constant.series = {{.label = "", .x = {0, 1, 2}, .y = {42.0, 42.0, 42.0}}};
  Plot gap{.title = "Gaps, a lone sample and an infinite one", .x_label = "time [s]", .y_label = "force [N]"};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  gap.series = {{.label = "", .x = {0, 1, 2, 3, 4, 5, 6, 7}, .y = {1, 2, nan, 3, nan, 2, 4, 1.0 / 0.0}}};
  section.blocks.push_back(PlotRow{.plots = {empty, constant, gap}});
  return section;
}

}  // namespace

Document sample_report() {
  Document document;
  document.title = "Elbow curls, subject 1";
  document.subtitle = "6 trials, 7 muscles, session `s01.h5`, scene `elbow.toml`";
  document.verdict =
      "Held-out elbow moment: R² 0.86, RMSE 1.02 N m (linear baseline 1.61 N m); 1 parameter not identified.";
  document.verdict_tone = Tone::warning;
  document.findings = {
      {.text =
           "channel `TRImed`: signal to noise 4.1 is below 6 in every trial; excluded by name (`low-snr`)",
       .tone = Tone::bad},
      {.text = "`tendon_slack_length_m` of `BRA` lies at its upper bound 0.0615 m", .tone = Tone::warning},
      {.text = "moment signal resampled from 100 Hz to 200 Hz, band-limited", .tone = Tone::plain}};
  document.chain = {
      {.name = "quality", .run = "emg.quality", .seconds = 0.41, .status = "done", .from = {"session"}},
      {.name = "excitation",
       .run = "emg.envelope",
       .seconds = 1.32,
       .status = "done",
       .tone = Tone::warning,
       .from = {"session", "quality"}},
      {.name = "moment",
       .run = "limb.inverse_dynamics",
       .seconds = 0.22,
       .status = "reused",
       .from = {"session"}},
      {.name = "subject",
       .run = "optimise.calibrate",
       .seconds = 14.8,
       .status = "done",
       .from = {"excitation", "moment"}},
      {.name = "activation",
       .run = "emg.activation",
       .seconds = 0.09,
       .status = "done",
       .from = {"excitation", "subject"}},
      {.name = "forces",
       .run = "hill.moment",
       .seconds = 0.31,
       .status = "done",
       .from = {"activation", "subject"}},
      {.name = "cross",
       .run = "optimise.cross_validate",
       .seconds = 75.2,
       .status = "failed",
       .from = {"excitation", "moment"}},
      {.name = "verdict",
       .run = "pipelines.compare",
       .seconds = 0.05,
       .status = "skipped",
       .from = {"moment", "forces", "cross"}}};
  document.sections = {quality(), conditioning(), activations(), calibration(), moments(), odd()};
  document.methods = {
      "Surface EMG was high-pass filtered at 30 Hz (Butterworth, effective order 4, zero lag), rectified and "
      "low-pass "
      "filtered at 6 Hz. Activation followed second-order dynamics (Lloyd & Besier 2003, "
      "doi:10.1016/S0021-9290(03)00010-1), force the model of Thelen (2003), doi:10.1115/1.1531112.",
      "Forearm and hand inertia were taken from de Leva (1996), doi:10.1016/0021-9290(95)00178-6, for a body "
      "mass of 75 kg."};
  document.provenance = {
      {"program", "brachium 0.1.0"},
      {"definition",
       "`elbow_curls.toml`, sha256 9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08"},
      {"recordings", "6 files, 84.1 MB"},
      {"run", "2026-01-01 12:00:00 UTC, 1 min 33 s on 2 threads"}};
  return document;
}

}  // namespace brachium::tests
