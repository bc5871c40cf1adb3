/// What a report shows of emg.envelope: filters, normalisation, excitation above 1, each channel's conditioning step by
/// step, the envelopes.

#include "pipelines/stages/emg_envelope_report.hpp"

#include <fmt/format.h>

#include "pipelines/stages/common.hpp"

namespace brachium::pipelines {

void fill_envelope_report(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  section.title += ": linear envelopes";
  report::GridOptions filters;
  filters.names = {{"effective_order", "order"},
                   {"edges_at_minus_3_dB_Hz", "−3 dB edges [Hz]"},
                   {"group_delay_s", "delay"},
                   {"transient_s", "transient"}};
  filters.words = {"filter"};
  filters.decimals = {{"group_delay_s", 3}, {"transient_s", 3}};
  section.blocks.push_back(report::make_grid(output.tables.at("filters"), filters));
  if (const auto trimmed = output.attributes.find("trimmed"); trimmed != output.attributes.end()) {
    section.blocks.push_back(
        report::Paragraph{"Left out because the filters' transients reach there: " + trimmed->second + "."});
  }
  if (output.tables.contains("normalisation")) {
    report::GridOptions grid;
    grid.words = {"method"};
    grid.digits = 3;
    grid.decimals = {{"time_s", 2}, {"window_s", 2}};
    grid.names = {
        {"time_s", "from"}, {"window_s", "window"}, {"reference_V", "reference"}, {"rest_V", "rest"}};
    for (const data::Column& column : output.tables.at("normalisation").columns) {
      if (column.name.ends_with("_V")) grid.units[column.name] = "µV";
    }
    section.blocks.push_back(report::make_grid(output.tables.at("normalisation"), grid));
  }
  if (output.tables.contains("above_one")) {
    report::GridOptions brief;
    brief.columns = {"trial", "channel", "samples", "maximum", "time_of_maximum_s"};
    brief.decimals = {{"maximum", 3}, {"time_of_maximum_s", 2}};
    section.blocks.push_back(report::make_grid(output.tables.at("above_one"), brief));
    report::Section folded;
    report::GridOptions all;
    all.columns = {"trial", "channel", "intervals_s"};
    all.names = {{"intervals_s", "intervals [s]"}};
    folded.blocks.push_back(report::make_grid(output.tables.at("above_one"), all));
    section.blocks.push_back(report::Details{"when the excitation is above 1", {folded}});
  }
  report::PlotRow steps;
  std::string shown;
  steps.min_width_px = 320.0;
  for (const auto& [name, table] : output.tables) {
    if (!name.starts_with("steps_")) continue;
    const auto scaled = [&table](const char* column) {
      std::vector<double> v = table.numbers(column);
      for (double& x : v) x *= 1e6;
      return v;
    };
    const std::vector<double>& time = table.numbers("time_s");
    report::Plot top;
    const std::string channel = name.substr(std::string("steps_").size());
    top.title = channel;
    shown = table.title;  // "conditioning of `channel` in trial `trial`"
    top.x_label = "time [s]";
    top.y_label = "EMG [µV]";
    top.series = {{"raw", time, scaled("raw_V"), report::Style::line, 6},
                  {"filtered", time, scaled("filtered_V"), report::Style::line, 0}};
    top.height_px = 130.0;
    report::Plot bottom;
    bottom.y_label = "EMG [µV]";
    bottom.series = {{"rectified", time, scaled("rectified_V"), report::Style::line, 5},
                     {"envelope", time, scaled("envelope_V"), report::Style::line, 1}};
    bottom.height_px = 130.0;
    top.below.push_back(bottom);
    steps.plots.push_back(std::move(top));
  }
  if (const std::size_t at = shown.find("in trial"); at != std::string::npos) {
    section.blocks.push_back(report::Paragraph{
        "Conditioning step by step, each channel around its largest envelope " + shown.substr(at) + ":"});
  }
  section.blocks.push_back(steps);
  std::vector<std::string> trials;
  for (const data::TrialInfo& trial : output.signals->info().trials) trials.push_back(trial.name);
  section.blocks.push_back(trial_plots(*output.signals, trials, data::Quantity::excitation, "excitation"));
}

std::string envelope_methods(const ReportContext& context) {
  const Options& o = *context.options;
  const bool zero_lag = o.text("phase") == "zero_lag";
  const auto order = [&](const char* key) { return o.integer(key) * (zero_lag ? 2 : 1); };
  const std::string band =
      o.number("band_high_hz") > 0
          ? fmt::format("band-pass filtered {:g} to {:g} Hz (Butterworth, effective order {})",
                        o.number("highpass_hz"), o.number("band_high_hz"), order("band_order"))
          : fmt::format("high-pass filtered at {:g} Hz (Butterworth, effective order {})",
                        o.number("highpass_hz"), order("band_order"));
  const std::string notch =
      o.number("notch_hz") > 0 ? fmt::format(", notched at {:g} Hz and harmonics", o.number("notch_hz")) : "";
  const std::string edges = o.text("cutoff") == "per_pass" ? "cut-offs are those of one pass"
                                                           : "cut-offs are the −3 dB edges after all passes";
  std::string norm = "not normalised (a gain per channel is part of the calibration)";
  if (o.text("normalise") == "mvc")
    norm = fmt::format("normalised by the largest {:g} s mean of the maximum voluntary contractions",
                       o.number("reference_window_s"));
  if (o.text("normalise") == "trials_maximum")
    norm = fmt::format(
        "normalised by the largest {:g} s mean of the trials themselves, for want of a maximum voluntary "
        "contraction",
        o.number("reference_window_s"));
  if (o.boolean("correct_reference_bias")) norm += ", less the expected excess of a maximum over the mean";
  if (o.boolean("subtract_rest"))
    norm += ", after the envelope at rest had been taken off in the mean square";
  return fmt::format(
      "EMG was {}{}, full-wave rectified, low-pass filtered at {:g} Hz (Butterworth, effective order {}), "
      "{}; {} The linear envelope was {}.",
      band, notch, o.number("lowpass_hz"), order("lowpass_order"),
      zero_lag ? "forward and backward without lag" : "causally", edges + ".", norm);
}

}  // namespace brachium::pipelines
