/// pipelines.compare: modelled moments against a reference, side by side.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "optimise/cross_validation.hpp"
#include "optimise/metrics.hpp"
#include "pipelines/stages/calibration_options.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/compare_frames.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/pipelines_compare.hpp"

namespace brachium::pipelines {
namespace {

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

std::string verdict(const std::vector<CompareModel>& models, const std::string& reference,
                    const std::map<std::string, data::Table>& tables) {
  std::vector<std::string> lines;
  for (const CompareModel& model : models) {
    std::vector<std::vector<double>> measured, modelled;
    const auto judged = model.judged();
    for (const CompareFrames* f : judged) {
      measured.push_back(f->reference_n_m);
      modelled.push_back(f->modelled_n_m);
    }
    const optimise::Metrics m = optimise::pooled_metrics(measured, modelled);
    const std::string share =
        m.nrmse_range ? fmt::format(" ({:.1f} % of the range)", 100.0 * *m.nrmse_range) : "";
    lines.push_back(fmt::format("`{}` R2 {}, RMSE {:.2f} N m{}{}", model.name, figure_text(m.r2, 3), m.rmse,
                                share, judged.front()->seen ? ", on trials the calibration has seen" : ""));
  }
  const auto judged = models.front().judged();
  const std::size_t unseen = judged.front()->seen ? 0 : judged.size();
  std::string text = fmt::format(
      "{}gainst `{}`: {}.",
      unseen == 0 ? "A"
                  : fmt::format("On {} trial{} the calibration never saw, a", unseen, unseen == 1 ? "" : "s"),
      reference, fmt::join(lines, "; "));
  if (const auto same = tables.find("same_muscles"); same != tables.end()) {
    const data::Table& t = same->second;
    for (std::size_t k = 0; k < t.rows(); ++k)
      text += fmt::format(" Against `{}` without {}, whose moment is {:.2f} N m (rms): `{}` RMSE {:.2f} N m.",
                          t.texts("against")[k], t.texts("without")[k], t.numbers("missing_rms_N_m")[k],
                          t.texts("model")[k], t.numbers("rmse_N_m")[k]);
  }
  return text;
}

void run(const StageContext& context, StageOutput& out) {
  const StageData& reference = context.input("reference");
  const std::vector<const StageData*>& inputs = context.inputs.at("models");
  const std::string coordinate = context.options->maybe_text("coordinate")
                                     .value_or(context.scene && context.scene->coordinates.size() == 1
                                                   ? context.scene->coordinates.front().name
                                                   : "");
  begin_output(context, reference, out);
  const std::vector<std::string> learnt = learnt_from(context);
  out.diagnostics = optimise::check_split(learnt, context.trials);

  const std::vector<CompareModel> models = compare_models(context, coordinate, learnt);
  for (std::size_t m = 0; m < models.size(); ++m) {
    for (const CompareFrames& f : models[m].trials) {
      if (m == 0)
        out.signals->write(f.trial, moment_signal(reference_name, coordinate, f.time_s, f.reference_n_m));
      out.signals->write(
          f.trial, moment_signal(signal_name(context, *inputs[m]), coordinate, f.time_s, f.modelled_n_m));
    }
  }
  const auto keep = [&](const char* name, data::Table table) {
    if (table.rows() > 0) out.tables[name] = std::move(table);
  };
  const int intervals = static_cast<int>(context.options->integer("intervals"));
  keep("scores", score_rows(models));
  if (context.maybe_input("kinematics")) keep("bias_by_angle", bias_rows(models, true, intervals));
  if (context.maybe_input("activation")) keep("bias_by_activation", bias_rows(models, false, intervals));
  keep("parts", part_rows(models));
  keep("muscles", muscle_rows(models));
  keep("same_muscles", same_muscle_rows(models));
  out.attributes["verdict"] = verdict(models, reference.stage, out.tables);
  out.attributes["verdict_tone"] = "plain";
}

}  // namespace

void add_compare_stages(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "pipelines.compare";
  spec.summary = "modelled moments against the reference: RMSE, NRMSE, R2, bias, by trial and pooled";
  spec.doc =
      "Sets joint moments side by side on the reference's own time stamps. Pooled figures take all frames as "
      "one sample (they are no mean of figures), and only trials that the subject's "
      "calibration has not seen, where the subject is wired. A trial used for both is flagged.\n"
      "Beside the figures of agreement: limits of agreement (Bland & Altman 1986, "
      "doi:10.1016/S0140-6736(86)90837-8), bias over "
      "angle and activation where those are wired, active and passive parts apart where models tell them "
      "(hill.moment, "
      "fem.upper_limb), the moment of every muscle, and what a model that lacks muscles lacks: it is also "
      "held against the "
      "others' moment of the muscles it has.";
  spec.inputs = {{"reference", PortType::signals, "measured moment"},
                 {"models", PortType::signals, "modelled moments (hill.moment)", false, true},
                 {"subject", PortType::subject, "to tell trials that its calibration has seen", true}};
  spec.inputs.push_back({"kinematics", PortType::signals, "joint angle: bias over it", true});
  spec.inputs.push_back({"activation", PortType::signals, "activations: bias over their mean", true});
  spec.options = {
      optional_text("coordinate", "joint coordinate; may be left out where the scene has one"),
      number_option("edge_s", "s", 0.0, at_least(0), "left out at both ends of the common span"),
      flag_option("common_frames", true,
                  "judge all models on the frames that all of them know; else each on its own"),
      integer_option("intervals", 6, between(1, 100), "of angle and of activation, for the bias over them")};
  spec.run = run;
  spec.report = fill_compare_report;
  spec.methods = compare_methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
