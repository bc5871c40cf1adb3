/// The report's chapter of pipelines.compare.

#include "pipelines/stages/pipelines_compare.hpp"

#include <fmt/format.h>

#include <map>

#include "pipelines/stages/common.hpp"
#include "pipelines/stages/compare_frames.hpp"

namespace brachium::pipelines {
namespace {

report::GridOptions grid_options() {
  report::GridOptions grid;
  grid.digits = 3;
  grid.undefined = undefined_text;
  grid.names = {{"seen_in_calibration", "seen in calibration"},
                {"nrmse_range", "NRMSE of the range"},
                {"bias_N_m", "bias"},
                {"largest_N_m", "largest error"},
                {"lower_limit_N_m", "lower limit of agreement"},
                {"upper_limit_N_m", "upper limit of agreement"},
                {"mean_N_m", "mean"},
                {"rms_N_m", "root mean square"},
                {"share_of_rms", "share"},
                {"in_continuum_model", "in the continuum model"},
                {"missing_mean_N_m", "mean moment of those left out"},
                {"missing_rms_N_m", "root mean square of those left out"},
                {"reference_N_m", "mean reference"}};
  return grid;
}

struct TrialCurves {
  std::string trial;
  std::vector<double> time_s, reference;
  std::vector<std::pair<std::string, std::vector<double>>> models;
};

std::vector<TrialCurves> curves_of(const data::SessionSource& signals) {
  std::vector<TrialCurves> out;
  for (std::size_t t = 0; t < signals.info().trials.size(); ++t) {
    const data::TrialInfo& trial = signals.info().trials[t];
    if (!trial.has_signal(reference_name)) continue;
    const data::Signal reference = signals.signal(t, trial.signal_index(reference_name));
    TrialCurves curves{trial.name, std::vector<double>(reference.samples.size()), reference.samples, {}};
    for (std::size_t i = 0; i < curves.time_s.size(); ++i) curves.time_s[i] = reference.info.time_s(i);
    for (std::size_t s = 0; s < trial.signals.size(); ++s) {
      if (trial.signals[s].name == reference_name) continue;
      const data::Signal model = signals.signal(t, s);
      std::vector<double> values = model.samples;
      // A model that leaves frames out may begin later or end earlier.
      if (model.info.count != reference.info.count) {
        values.clear();
        for (const double time : curves.time_s) {
          const double at = (time - model.info.start_time_s) * model.info.rate_hz;
          const bool inside = at > -1e-6 && at < static_cast<double>(model.samples.size()) - 1.0 + 1e-6;
          values.push_back(inside ? model.samples[static_cast<std::size_t>(at + 0.5)]
                                  : std::numeric_limits<double>::quiet_NaN());
        }
      }
      curves.models.emplace_back(model.info.name, std::move(values));
    }
    out.push_back(std::move(curves));
  }
  return out;
}

report::PlotRow side_by_side(const std::vector<TrialCurves>& trials) {
  report::PlotRow row;
  row.min_width_px = 420.0;
  for (const TrialCurves& t : trials) {
    report::Plot plot{.title = t.trial, .x_label = "time [s]", .y_label = "moment [N m]"};
    plot.series.push_back({.label = reference_name, .x = t.time_s, .y = t.reference, .colour = 0});
    int colour = 1;
    for (const auto& [name, values] : t.models)
      plot.series.push_back({.label = name,
                             .x = t.time_s,
                             .y = values,
                             .style = report::Style::dashed,
                             .colour = colour++ % 8});
    row.plots.push_back(std::move(plot));
  }
  return row;
}

/// All trials of a model as one sample.
report::PlotRow bland_altman(const std::vector<TrialCurves>& trials) {
  std::map<std::string, std::array<std::vector<double>, 3>> pooled;
  std::vector<std::string> order;
  for (const TrialCurves& t : trials) {
    for (const auto& [name, values] : t.models) {
      if (!pooled.contains(name)) order.push_back(name);
      auto& [time, reference, model] = pooled[name];
      time.insert(time.end(), t.time_s.begin(), t.time_s.end());
      reference.insert(reference.end(), t.reference.begin(), t.reference.end());
      model.insert(model.end(), values.begin(), values.end());
    }
  }
  report::PlotRow row;
  row.min_width_px = 320.0;
  for (const std::string& name : order) {
    const auto& [time, reference, model] = pooled.at(name);
    row.plots.push_back(report::make_bland_altman_plot(name, {time, reference, model, "moment", "N m"}));
  }
  return row;
}

report::Plot bias_plot(const data::Table& table, bool of_angle) {
  report::Plot plot{.title = of_angle ? "bias over the joint angle" : "bias over the mean activation",
                    .x_label = of_angle ? "joint angle [deg]" : "mean activation [1]",
                    .y_label = "modelled - reference [N m]"};
  std::map<std::string, std::size_t> places;
  for (std::size_t k = 0; k < table.rows(); ++k) {
    const std::string& model = table.texts("model")[k];
    if (!places.contains(model)) {
      places[model] = plot.series.size();
      plot.series.push_back({.label = model, .colour = static_cast<int>(places.size()) % 8});
    }
    report::Series& s = plot.series[places.at(model)];
    s.x.push_back(0.5 * (table.numbers(of_angle ? "from_deg" : "from_activation")[k] +
                         table.numbers(of_angle ? "to_deg" : "to_activation")[k]));
    s.y.push_back(table.numbers("bias_N_m")[k]);
  }
  return plot;
}

}  // namespace

void fill_compare_report(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  section.title += ": modelled against measured";
  section.blocks.push_back(report::Paragraph{output.attributes.at("verdict")});
  const report::GridOptions grid = grid_options();
  section.blocks.push_back(report::make_grid(output.tables.at("scores"), grid));
  const std::vector<TrialCurves> trials = curves_of(*output.signals);
  const bool several = !trials.empty() && trials.front().models.size() > 1;
  if (several) section.blocks.push_back(side_by_side(trials));
  report::PlotRow agreement;
  agreement.min_width_px = 420.0;
  for (const TrialCurves& t : trials) {
    for (const auto& [name, values] : t.models)
      agreement.plots.push_back(report::make_agreement_plot(
          fmt::format("{}: {}", t.trial, name), {t.time_s, t.reference, values, "moment", "N m"}));
  }
  report::PlotRow bias;
  bias.min_width_px = 320.0;
  for (const bool of_angle : {true, false}) {
    const auto table = output.tables.find(of_angle ? "bias_by_angle" : "bias_by_activation");
    if (table != output.tables.end()) bias.plots.push_back(bias_plot(table->second, of_angle));
  }
  if (!bias.plots.empty()) section.blocks.push_back(bias);
  for (const char* name : {"same_muscles", "parts"}) {
    if (!output.tables.contains(name) || !several) continue;
    report::GridOptions dashes = grid;
    dashes.undefined = "–";
    section.blocks.push_back(report::make_grid(output.tables.at(name), dashes));
  }
  if (!several) {
    section.blocks.push_back(agreement);
  } else {
    section.blocks.push_back(
        report::Details{"each model against the reference, with residuals", {{.blocks = {agreement}}}});
  }
  report::Section folded;
  folded.blocks.push_back(bland_altman(trials));
  for (const char* name : {"bias_by_angle", "bias_by_activation", "muscles"}) {
    if (output.tables.contains(name))
      folded.blocks.push_back(report::make_grid(output.tables.at(name), grid));
  }
  section.blocks.push_back(report::Details{"limits of agreement, and the moment of every muscle", {folded}});
}

std::string compare_methods(const ReportContext&) {
  return "Modelled and reference moments were compared frame by frame on the reference's time stamps: root "
         "mean square error, the same over the range of the reference, and the coefficient of "
         "determination R2 = 1 - (sum of squared errors) / (sum of squared deviations of the reference from "
         "its mean); pooled figures take all frames as one sample. Limits of agreement are bias +- 1.96 "
         "standard "
         "deviations of the difference (Bland & Altman 1986, doi:10.1016/S0140-6736(86)90837-8).";
}

}  // namespace brachium::pipelines
