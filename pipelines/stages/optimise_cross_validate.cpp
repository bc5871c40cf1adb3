/// optimise.cross_validate: calibrated on some trials, judged on others, beside regressions without physiology.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/resample.hpp"
#include "optimise/cross_validation.hpp"
#include "pipelines/report/text.hpp"
#include "pipelines/stages/calibration_options.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/optimise_common.hpp"

namespace brachium::pipelines {
namespace {

optimise::BaselineSpec baseline_spec(const std::string& name, const Options& o) {
  optimise::BaselineSpec spec;
  spec.ridge = o.number("baseline_ridge");
  spec.degree = static_cast<int>(o.integer("baseline_degree"));
  spec.kind = name == "linear_envelope"    ? optimise::BaselineSpec::Kind::linear_envelope
              : name == "angle_polynomial" ? optimise::BaselineSpec::Kind::angle_polynomial
                                           : optimise::BaselineSpec::Kind::flexible;
  return spec;
}

/// Sums of residuals over the samples of one class.
struct Class {
  std::string kind, label;
  std::size_t count = 0;
  double sum = 0.0, squares = 0.0;
  void take(double residual) {
    ++count;
    sum += residual;
    squares += residual * residual;
  }
};

struct Classes {
  std::vector<Class> items;
  Class& of(const std::string& kind, const std::string& label) {
    for (Class& c : items) {
      if (c.kind == kind && c.label == label) return c;
    }
    return items.emplace_back(Class{kind, label});
  }
};

/// Where the model falls short: residuals of held-out frames by angle, phase and every numeric condition of the trials.
data::Table residual_table(const StageContext& context, const optimise::ModelScore& model,
                           const data::Coordinate& coordinate) {
  Classes classes;
  const double bin_deg = context.options->number("angle_bin_deg");
  const double still = context.options->number("still_deg_s") * std::numbers::pi / 180.0;
  for (const optimise::TrialScore& score : model.held_out) {
    const StageData& kinematics = context.input("kinematics");
    const data::Signal angle =
        signal_of(kinematics, score.trial, data::Quantity::joint_angle, coordinate.name);
    const std::vector<double> q = data::evaluate_at(angle, score.time_s);
    const data::TrialInfo& info = trial_info(context.input("excitation"), score.trial);
    for (std::size_t i = 0; i < q.size(); ++i) {
      const double residual = score.modelled_N_m[i] - score.reference_N_m[i];
      const double deg = q[i] * 180.0 / std::numbers::pi;
      const double low = bin_deg * std::floor(deg / bin_deg);
      classes.of("angle", fmt::format("{:g} to {:g} deg", low, low + bin_deg)).take(residual);
      const std::size_t a = i > 0 ? i - 1 : 0, b = std::min(i + 1, q.size() - 1);
      const double velocity = (q[b] - q[a]) / (score.time_s[b] - score.time_s[a]);
      classes.of("phase", velocity > still    ? "flexing"
                          : velocity < -still ? "extending"
                                              : "still")
          .take(residual);
      for (const auto& [name, value] : info.conditions)
        classes.of(name, fmt::format("{:.4g}", value)).take(residual);
    }
  }
  std::stable_sort(classes.items.begin(), classes.items.end(), [](const Class& a, const Class& b) {
    if (a.kind != b.kind) return a.kind < b.kind;
    try {
      return std::stod(a.label) < std::stod(b.label);
    } catch (const std::exception&) {
      return a.label < b.label;
    }
  });
  TableBuilder table("residual of the muscle model on held-out frames");
  table.text("by").text("class").number("frames", "1").number("bias_N_m", "N m").number("rms_N_m", "N m");
  for (const Class& c : classes.items) {
    const double n = static_cast<double>(c.count);
    table.row({c.kind, c.label, n, c.sum / n, std::sqrt(c.squares / n)});
  }
  return table.take();
}

data::Table stability_table(const optimise::CrossValidationResult& result) {
  TableBuilder table("parameters over the folds");
  table.text("owner")
      .text("parameter")
      .text("unit")
      .number("lowest", "1")
      .number("highest", "1")
      .number("folds_at_bound", "1")
      .number("folds_not_identified", "1");
  if (result.folds.empty()) return table.take();
  for (std::size_t p = 0; p < result.folds.front().calibration.subject.verdicts.size(); ++p) {
    const data::ParameterVerdict& first = result.folds.front().calibration.subject.verdicts[p];
    double lowest = first.fitted, highest = first.fitted, bound = 0.0, unknown = 0.0;
    for (const optimise::Fold& fold : result.folds) {
      const data::ParameterVerdict& v = fold.calibration.subject.verdicts.at(p);
      lowest = std::min(lowest, v.fitted);
      highest = std::max(highest, v.fitted);
      bound += v.verdict.find("BOUND") != std::string::npos ? 1.0 : 0.0;
      unknown += v.verdict.find("NOT IDENTIFIED") != std::string::npos ? 1.0 : 0.0;
    }
    table.row({first.muscle, first.parameter, first.unit, lowest, highest, bound, unknown});
  }
  return table.take();
}

std::string figures(const optimise::Metrics& m) {
  return fmt::format("R2 {}, RMSE {:.2f} N m", figure_text(m.r2, 3), m.rmse);
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const data::Coordinate& coordinate =
      coordinate_of(scene, context.options->maybe_text("coordinate").value_or(""));
  optimise::CrossValidationOptions options;
  options.calibration = calibration_options(context, coordinate);
  options.calibration.subject_name = context.input("excitation").signals->info().subject;
  options.hold_out = context.options->texts("hold_out");
  options.normalise_by_training_maximum = context.options->boolean("normalise_by_training_maximum");
  options.baselines.clear();
  for (const std::string& name : context.options->texts("baselines"))
    options.baselines.push_back(baseline_spec(name, *context.options));
  options.threads = context.threads;
  options.calibration.problem.threads = 1;
  options.calibration.solver.threads = 1;
  const std::vector<optimise::CalibrationTrial> trials =
      calibration_trials(context, coordinate, context.trials);
  const optimise::CrossValidationResult result = optimise::cross_validate(scene, trials, options);

  out.tables["scores"] = result.table();
  TableBuilder pooled("pooled over all held-out frames");
  pooled.text("model")
      .number("r2", "1")
      .number("rmse_N_m", "N m")
      .number("nrmse_range", "1")
      .number("bias_N_m", "N m")
      .number("training_r2", "1")
      .number("training_rmse_N_m", "N m")
      .number("frames", "1");
  for (const optimise::ModelScore& m : result.models) {
    const optimise::Metrics &h = m.pooled_held_out, &t = m.pooled_training;
    pooled.row({m.model, or_undefined(h.r2), h.rmse, or_undefined(h.nrmse_range), h.bias, or_undefined(t.r2),
                t.rmse, static_cast<double>(h.count)});
  }
  out.tables["pooled"] = pooled.take();
  const optimise::ModelScore& muscle = result.models.front();
  out.tables["residuals"] = residual_table(context, muscle, coordinate);
  out.tables["stability"] = stability_table(result);
  for (std::size_t f = 0; f < result.folds.size(); ++f) {
    data::Table verdicts = optimise::verdict_table(result.folds[f].calibration.subject);
    verdicts.title = fmt::format("held out: {}", fmt::join(result.folds[f].held_out, ", "));
    out.tables[fmt::format("fold_{:02}", f + 1)] = std::move(verdicts);
  }
  begin_output(context, context.input("excitation"), out);
  std::vector<std::string> beaten;
  for (std::size_t m = 0; m < result.models.size(); ++m) {
    for (const optimise::TrialScore& s : result.models[m].held_out) {
      if (m == 0)
        out.signals->write(s.trial, moment_signal("reference", coordinate.name, s.time_s, s.reference_N_m));
      out.signals->write(s.trial, moment_signal(m == 0 ? "muscle_model" : result.models[m].model,
                                                coordinate.name, s.time_s, s.modelled_N_m));
    }
    if (m > 0 && muscle.pooled_held_out.rmse < result.models[m].pooled_held_out.rmse)
      beaten.push_back(result.models[m].model);
  }
  add_calibration_findings(result.diagnostics, result.folds.front().calibration.subject, out);
  std::vector<std::string> others;
  for (std::size_t m = 1; m < result.models.size(); ++m)
    others.push_back(fmt::format("{} {}", report::in_words(result.models[m].model),
                                 figures(result.models[m].pooled_held_out)));
  out.attributes["verdict"] = fmt::format("On trials the calibration never saw: muscle model {}{}{}.",
                                          figures(muscle.pooled_held_out),
                                          others.empty() ? "" : "; regressions: ", fmt::join(others, "; "));
  out.attributes["verdict_tone"] = beaten.size() + 1 == result.models.size()
                                       ? "good"
                                       : "warning";  // a regression that does better is said loudly
  out.attributes["beaten"] = fmt::format("{}", fmt::join(beaten, ","));
}

void fill(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  if (const auto v = output.attributes.find("verdict"); v != output.attributes.end())
    section.blocks.push_back(report::Paragraph{v->second});
  report::GridOptions grid;
  grid.digits = 3;
  grid.undefined = undefined_text;
  grid.words = {"model", "by", "parameter"};
  grid.names = {{"nrmse_range", "NRMSE of the range"},
                {"bias_N_m", "bias"},
                {"training_r2", "R² in training"},
                {"training_rmse_N_m", "RMSE in training"},
                {"folds_at_bound", "folds at a bound"},
                {"folds_not_identified", "folds not identified"},
                {"owner", "of"}};
  const auto any = [](double folds) { return folds > 0.0 ? report::Tone::warning : report::Tone::plain; };
  grid.number_tone = {{"folds_at_bound", any}, {"folds_not_identified", any}};
  section.title += ": trials the calibration never saw";
  section.blocks.push_back(report::make_grid(output.tables.at("pooled"), grid));
  section.blocks.push_back(
      report::Paragraph{"The moment of a slow movement is mostly its angle: a model that ignores EMG can "
                        "look deceptively good. What the physiology buys is the difference "
                        "to the regressions on the same split."});
  report::PlotRow agreement;
  agreement.min_width_px = 420.0;
  std::vector<double> all_reference, all_model, all_time;
  for (std::size_t t = 0; t < output.signals->info().trials.size(); ++t) {
    const data::TrialInfo& trial = output.signals->info().trials[t];
    if (!trial.has_signal("reference") || !trial.has_signal("muscle_model")) continue;
    const data::Signal reference = output.signals->signal(t, trial.signal_index("reference")),
                       modelled = output.signals->signal(t, trial.signal_index("muscle_model"));
    std::vector<double> time(reference.samples.size());
    for (std::size_t i = 0; i < time.size(); ++i) time[i] = reference.info.time_s(i);
    agreement.plots.push_back(report::make_agreement_plot(
        trial.name + " (held out)", {time, reference.samples, modelled.samples, "moment", "N m"}));
    all_time.insert(all_time.end(), time.begin(), time.end());
    all_reference.insert(all_reference.end(), reference.samples.begin(), reference.samples.end());
    all_model.insert(all_model.end(), modelled.samples.begin(), modelled.samples.end());
  }
  section.blocks.push_back(agreement);
  if (!all_reference.empty()) {
    report::PlotRow pair;
    pair.min_width_px = 420.0;
    pair.plots = {report::make_scatter_plot("all held-out frames",
                                            {all_time, all_reference, all_model, "moment", "N m"}),
                  report::make_bland_altman_plot("difference against mean",
                                                 {all_time, all_reference, all_model, "moment", "N m"})};
    section.blocks.push_back(pair);
  }
  section.blocks.push_back(report::make_grid(output.tables.at("residuals"), grid));
  section.blocks.push_back(report::make_grid(output.tables.at("stability"), grid));
  report::Section scores;
  scores.blocks.push_back(report::make_grid(output.tables.at("scores"), grid));
  section.blocks.push_back(report::Details{"every model on every trial", {scores}});
  report::Section folds;
  for (const auto& [name, table] : output.tables) {
    if (name.starts_with("fold_")) folds.blocks.push_back(verdict_grid(table));
  }
  section.blocks.push_back(report::Details{"parameters of every fold", {folds}});
}

std::string methods(const ReportContext& context) {
  const std::vector<std::string>& hold_out = context.options->texts("hold_out");
  return fmt::format(
      "Prediction was judged by cross-validation over trials ({}). In each fold everything that depends on "
      "data, {}was computed from the training trials alone; R2 is one minus the "
      "squared error over the squared deviation from the mean of all held-out frames.",
      hold_out.empty() ? "leave one trial out" : fmt::format("held out: {}", fmt::join(hold_out, ", ")),
      context.options->boolean("normalise_by_training_maximum")
          ? "the normalisation of the envelopes included, "
          : "");
}

}  // namespace

void add_optimise_cross_validate(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "optimise.cross_validate";
  spec.summary = "calibrates on some trials and judges on others, beside regressions without physiology";
  spec.doc =
      "Leaves each trial out in turn (or holds out the named ones), calibrates on the rest, and predicts "
      "what was left out. On the same split it fits regressions: "
      "`linear_envelope` (envelopes and the sine of the angle), `angle_polynomial` (no EMG at all), and "
      "`flexible` (52 columns). Nothing is chosen, normalised or "
      "fitted on held-out trials.";
  spec.needs_scene = true;
  spec.inputs = {
      {"excitation", PortType::signals, "envelopes (emg.envelope)"},
      {"kinematics", PortType::signals, "joint angle, and velocity if known (limb.kinematics)", false, false,
       true},
      {"moment", PortType::signals, "reference moment (limb.dynamometer or limb.inverse_dynamics)"}};
  OptionSpec baselines = texts_option("baselines", {"linear_envelope", "angle_polynomial", "flexible"},
                                      "regressions to show beside the muscle model");
  baselines.allowed = {"linear_envelope", "angle_polynomial", "flexible"};
  spec.options = {
      texts_option("hold_out", {},
                   "patterns of trials held out together; empty: leave one trial out, each in turn"),
      flag_option("normalise_by_training_maximum", false,
                  "divide each channel by its largest envelope over the fold's training trials (recordings "
                  "without an MVC)"),
      baselines,
      integer_option("baseline_degree", 3, between(1, 9), "of the polynomial in the angle"),
      number_option("baseline_ridge", "", 0.0, at_least(0), "penalty on standardised weights, per sample"),
      number_option("angle_bin_deg", "deg", 30.0, above(0),
                    "width of the angle classes of the residual table"),
      number_option("still_deg_s", "deg/s", 10.0, above(0),
                    "below this speed a frame is neither flexing nor extending")};
  for (OptionSpec& o : calibration_option_specs()) spec.options.push_back(std::move(o));
  spec.run = run;
  spec.report = fill;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
