/// optimise.calibrate: a subject's parameters from trials with a reference moment, each with a verdict.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "optimise/cross_validation.hpp"
#include "pipelines/stages/calibration_options.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/model_options.hpp"
#include "pipelines/stages/optimise_common.hpp"

namespace brachium::pipelines {
namespace {

/// Trials to learn from: those named, else kind `calibration`, else all of the stage's.
std::vector<std::string> training_trials(const StageContext& context) {
  const std::vector<std::string>& patterns = context.options->texts("train");
  if (!patterns.empty()) return data::match_names(patterns, context.trials, "trial");
  std::vector<std::string> calibration;
  for (const std::string& name : context.trials) {
    if (trial_info(context.input("excitation"), name).kind == data::TrialKind::calibration)
      calibration.push_back(name);
  }
  return calibration.empty() ? context.trials : calibration;
}

void run(const StageContext& context, StageOutput& out) {
  const data::Scene& scene = context.need_scene();
  const data::Coordinate& coordinate =
      coordinate_of(scene, context.options->maybe_text("coordinate").value_or(""));
  const std::vector<std::string> names = training_trials(context);
  std::vector<optimise::CalibrationTrial> trials = calibration_trials(context, coordinate, names);
  optimise::CalibrationOptions options = calibration_options(context, coordinate);
  options.subject_name = context.input("excitation").signals->info().subject;
  std::map<std::string, double> maxima;
  if (context.options->boolean("normalise_by_training_maximum")) {
    maxima = optimise::channel_maxima(trials);
    trials = optimise::scaled_by(std::move(trials), maxima);
  }
  optimise::CalibrationResult result = optimise::calibrate(scene, trials, options);

  begin_output(context, context.input("excitation"), out);
  for (const optimise::CalibrationTrial& trial : trials) {
    const optimise::Prediction p = optimise::predict(scene, result.subject, trial, options.problem);
    out.signals->write(trial.name, moment_signal("reference", coordinate.name, p.time_s, p.reference_N_m));
    out.signals->write(trial.name, moment_signal("modelled", coordinate.name, p.time_s, p.modelled_N_m));
  }
  // A subject stands for recordings as they are: what scaled the channels belongs to its gains.
  for (const auto& [channel, maximum] : maxima) {
    const double gain =
        result.subject.channel_gains.contains(channel) ? result.subject.channel_gains.at(channel) : 1.0;
    result.subject.channel_gains[channel] = gain / maximum;
  }
  result.subject.provenance["trials"] = fmt::format("{}", fmt::join(names, ","));
  result.subject.provenance["scene"] = scene.title;
  add_calibration_tables(result, out);
  add_calibration_findings(result.diagnostics, result.subject, out);
  out.subject = std::move(result.subject);
}

}  // namespace

void add_optimise_calibrate(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "optimise.calibrate";
  spec.summary = "fits muscle, activation and gain parameters to a reference moment; a verdict on each";
  spec.doc =
      "Fits the free parameters so that the modelled joint moment follows the reference, by bounded least "
      "squares with exact derivatives. Residuals are scaled by "
      "one figure for the whole set of trials, so that isometric holds are safe. Every parameter gets a "
      "verdict: identified with its 95 % interval, at a bound, or "
      "not identified; correlations above 0.95 and combinations that the data cannot tell apart are named. "
      "The result is a subject, also written as a file of its "
      "own that other pipelines read.\n"
      "Sources: Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1; Newey & West 1987, "
      "doi:10.2307/1913610; Nakamura 1990, doi:10.1093/biomet/77.1.127; Cook & Stefanski 1994, "
      "doi:10.1080/01621459.1994.10476871.";
  spec.needs_scene = true;
  spec.output = PortType::subject;
  spec.inputs = {
      {"excitation", PortType::signals, "envelopes (emg.envelope)"},
      {"kinematics", PortType::signals, "joint angle, and velocity if known (limb.kinematics)", false, false,
       true},
      {"moment", PortType::signals, "reference moment (limb.dynamometer or limb.inverse_dynamics)"}};
  spec.options = {
      texts_option(
          "train", {},
          "patterns of the trials to learn from; empty: kind `calibration`, or all if there is none"),
      flag_option("normalise_by_training_maximum", false,
                  "divide each channel by its largest training envelope first (recordings without an MVC); "
                  "the subject's gains include it")};
  for (OptionSpec& o : calibration_option_specs()) spec.options.push_back(std::move(o));
  spec.run = run;
  spec.report = [](const ReportContext& context, report::Section& section) {
    add_calibration_report(*context.output, section);
  };
  spec.methods = calibration_methods;
  catalogue.add(std::move(spec));
}

void add_optimise_stages(Catalogue& catalogue) {
  add_optimise_calibrate(catalogue);
  add_optimise_cross_validate(catalogue);
  add_optimise_scenario(catalogue);
  add_optimise_muscle_forces(catalogue);
}

}  // namespace brachium::pipelines
