/// pipelines.compare: modelled moments against a reference, side by side.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "data/model/resample.hpp"
#include "optimise/cross_validation.hpp"
#include "optimise/metrics.hpp"
#include "pipelines/stages/calibration_options.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"

namespace brachium::pipelines {
namespace {

constexpr const char* reference_name = "reference";

struct Pair {
  std::vector<double> time, reference, modelled;
};

/// The reference's samples inside the span of both, and the model interpolated there.
Pair align(const data::Signal& reference, const std::vector<bool>& use, const data::Signal& model, double edge_s) {
  Pair pair;
  const double from = std::max(reference.info.start_time_s, model.info.start_time_s) + edge_s;
  const double to = std::min(reference.info.end_time_s(), model.info.end_time_s()) - edge_s;
  for (std::size_t i = 0; i < reference.samples.size(); ++i) {
    const double t = reference.info.time_s(i);
    if (t < from || t > to || (!use.empty() && !use[i])) continue;
    pair.time.push_back(t);
    pair.reference.push_back(reference.samples[i]);
  }
  if (!pair.time.empty()) pair.modelled = data::evaluate_at(model, pair.time);
  return pair;
}

/// Name of a model's signal in the output: its stage's, unless that is what the reference is called there.
std::string signal_name(const StageContext& context, const StageData& model) {
  std::vector<std::string> taken{reference_name};
  for (const StageData* other : context.inputs.at("models")) {
    if (other != &model) taken.push_back(other->stage);
  }
  std::string name = model.stage;
  while (std::find(taken.begin(), taken.end(), name) != taken.end()) name += "_model";
  return name;
}

std::vector<std::string> learnt_from(const StageContext& context) {
  std::vector<std::string> names;
  const StageData* subject = context.maybe_input("subject");
  if (!subject || !subject->subject || !subject->subject->provenance.contains("trials")) return names;
  std::istringstream list(subject->subject->provenance.at("trials"));
  for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  return names;
}

void run(const StageContext& context, StageOutput& out) {
  const StageData& reference = context.input("reference");
  const std::vector<const StageData*>& models = context.inputs.at("models");
  const std::string coordinate = context.options->maybe_text("coordinate").value_or(
      context.scene && context.scene->coordinates.size() == 1 ? context.scene->coordinates.front().name : "");
  begin_output(context, reference, out);
  const std::vector<std::string> learnt = learnt_from(context);
  out.diagnostics = optimise::check_split(learnt, context.trials);

  TableBuilder scores("agreement with the reference");
  scores.text("model").text("trial").text("seen_in_calibration").number("frames", "1").number("rmse_N_m", "N m").number("nrmse_range", "1").number("r2", "1").number("bias_N_m", "N m")
      .number("largest_N_m", "N m");
  std::vector<std::string> lines;
  std::size_t judged_trials = 0;
  for (const StageData* model : models) {
    std::vector<std::vector<double>> unseen_reference, unseen_model, all_reference, all_model;
    for (const std::string& name : context.trials) {
      const data::Signal measured = signal_of(reference, name, data::Quantity::joint_moment, coordinate);
      const Pair pair = align(measured, use_of(reference, name), signal_of(*model, name, data::Quantity::joint_moment, coordinate), context.options->number("edge_s"));
      if (pair.time.size() < 2) {
        throw data::InputError("no-common-window", fmt::format("reference and `{}` have no common frames in trial `{}`", model->stage, name), "check start times and `edge_s`");
      }
      const optimise::Metrics m = optimise::metrics(pair.reference, pair.modelled);
      const bool seen = std::find(learnt.begin(), learnt.end(), name) != learnt.end();
      scores.row({model->stage, name, std::string(seen ? "yes" : "no"), static_cast<double>(m.count), m.rmse, or_undefined(m.nrmse_range), or_undefined(m.r2), m.bias, m.max_absolute_error});
      all_reference.push_back(pair.reference);
      all_model.push_back(pair.modelled);
      if (!seen) {
        unseen_reference.push_back(pair.reference);
        unseen_model.push_back(pair.modelled);
      }
      if (model == models.front()) out.signals->write(name, moment_signal(reference_name, coordinate, pair.time, pair.reference));
      out.signals->write(name, moment_signal(signal_name(context, *model), coordinate, pair.time, pair.modelled));
    }
    const bool judged = !unseen_reference.empty();
    const optimise::Metrics pooled = judged ? optimise::pooled_metrics(unseen_reference, unseen_model) : optimise::pooled_metrics(all_reference, all_model);
    scores.row({model->stage, std::string(judged ? "all unseen trials" : "all trials"), std::string(judged ? "no" : "yes"), static_cast<double>(pooled.count), pooled.rmse,
                or_undefined(pooled.nrmse_range), or_undefined(pooled.r2), pooled.bias, pooled.max_absolute_error});
    if (judged) judged_trials = unseen_reference.size();
    const std::string share = pooled.nrmse_range ? fmt::format(" ({:.1f} % of the range)", 100.0 * *pooled.nrmse_range) : "";
    lines.push_back(fmt::format("`{}` R2 {}, RMSE {:.2f} N m{}{}", model->stage, figure_text(pooled.r2, 3), pooled.rmse, share, judged ? "" : ", on trials the calibration has seen"));
  }
  out.tables["scores"] = scores.take();
  out.attributes["verdict"] = fmt::format("{}gainst `{}`: {}.", judged_trials == 0 ? "A" : fmt::format("On {} trial{} the calibration never saw, a", judged_trials, judged_trials == 1 ? "" : "s"),
                                          reference.stage, fmt::join(lines, "; "));
  out.attributes["verdict_tone"] = "plain";
}

void fill(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  section.title += ": modelled against measured";
  section.blocks.push_back(report::Paragraph{output.attributes.at("verdict")});
  report::GridOptions grid;
  grid.digits = 3;
  grid.undefined = undefined_text;
  grid.names = {{"seen_in_calibration", "seen in calibration"}, {"nrmse_range", "NRMSE of the range"}, {"bias_N_m", "bias"}, {"largest_N_m", "largest error"}};
  section.blocks.push_back(report::make_grid(output.tables.at("scores"), grid));
  report::PlotRow plots;
  plots.min_width_px = 420.0;
  for (std::size_t t = 0; t < output.signals->info().trials.size(); ++t) {
    const data::TrialInfo& trial = output.signals->info().trials[t];
    if (!trial.has_signal(reference_name)) continue;
    const data::Signal reference = output.signals->signal(t, trial.signal_index(reference_name));
    std::vector<double> time(reference.samples.size());
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = reference.info.time_s(i);
    for (std::size_t s = 0; s < trial.signals.size(); ++s) {
      if (trial.signals[s].name == reference_name || trial.signals[s].count != time.size()) continue;
      const data::Signal modelled = output.signals->signal(t, s);
      plots.plots.push_back(report::make_agreement_plot(fmt::format("{}: {}", trial.name, modelled.info.name), {time, reference.samples, modelled.samples, "moment", "N m"}));
    }
  }
  section.blocks.push_back(plots);
}

std::string methods(const ReportContext&) {
  return "Modelled and reference moments were compared frame by frame on the reference's time stamps: root mean square error, the same over the range of the reference, and the coefficient of "
         "determination R2 = 1 - (sum of squared errors) / (sum of squared deviations of the reference from its mean); pooled figures take all frames as one sample.";
}

}  // namespace

void add_compare_stages(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "pipelines.compare";
  spec.summary = "modelled moments against the reference: RMSE, NRMSE, R2, bias, by trial and pooled";
  spec.doc =
      "Sets joint moments side by side on the reference's own time stamps. Pooled figures take all frames as one sample (they are no mean of figures), and only trials that the subject's "
      "calibration has not seen, where the subject is wired. A trial used for both is flagged.";
  spec.inputs = {{"reference", PortType::signals, "measured moment"},
                 {"models", PortType::signals, "modelled moments (hill.moment)", false, true},
                 {"subject", PortType::subject, "to tell trials that its calibration has seen", true}};
  spec.options = {optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
                  number_option("edge_s", "s", 0.0, at_least(0), "left out at both ends of the common span")};
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
