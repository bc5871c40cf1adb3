#include "optimise/cross_validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "data/model/parallel.hpp"

namespace brachium::optimise {
namespace {

/// Everything one fold gives, before it is pooled.
struct FoldOutput {
  Fold fold;
  std::vector<std::vector<TrialScore>> held_out, training;  ///< by model
};

std::vector<CalibrationTrial> pick(const std::vector<CalibrationTrial>& trials,
                                   const std::vector<std::string>& names) {
  std::vector<CalibrationTrial> out;
  for (const CalibrationTrial& trial : trials)
    if (std::find(names.begin(), names.end(), trial.name) != names.end()) out.push_back(trial);
  return out;
}

TrialScore score(const std::string& trial, bool held_out, std::vector<double> time,
                 std::vector<double> reference, std::vector<double> model) {
  TrialScore out{trial,           held_out, metrics(reference, model), std::move(time), std::move(reference),
                 std::move(model)};
  return out;
}

FoldOutput run_fold(const data::Scene& scene, const std::vector<CalibrationTrial>& trials, Fold fold,
                    const CrossValidationOptions& options) {
  FoldOutput out;
  std::vector<CalibrationTrial> training = pick(trials, fold.training),
                                held_out = pick(trials, fold.held_out);
  if (options.normalise_by_training_maximum) {
    fold.channel_maximum = channel_maxima(training);
    training = scaled_by(std::move(training), fold.channel_maximum);
    held_out = scaled_by(std::move(held_out), fold.channel_maximum);
  }
  fold.calibration = calibrate(scene, training, options.calibration);
  const double edge = options.calibration.problem.edge_s;
  const auto predicted = [&](const CalibrationTrial& trial, bool held) {
    CalibrationProblemOptions problem = options.calibration.problem;
    problem.decimate = 1;
    Prediction p = predict(scene, fold.calibration.subject, trial, problem);
    return score(trial.name, held, std::move(p.time_s), std::move(p.reference_N_m),
                 std::move(p.modelled_N_m));
  };
  out.held_out.resize(1 + options.baselines.size());
  out.training.resize(out.held_out.size());
  for (const CalibrationTrial& trial : held_out) out.held_out[0].push_back(predicted(trial, true));
  for (const CalibrationTrial& trial : training) out.training[0].push_back(predicted(trial, false));
  for (std::size_t b = 0; b < options.baselines.size(); ++b) {
    const Baseline baseline = fit_baseline(options.baselines[b], training, edge);
    const auto regressed = [&](const CalibrationTrial& trial, bool held) {
      BaselinePrediction p = predict(baseline, trial, edge);
      return score(trial.name, held, std::move(p.time_s), std::move(p.reference_N_m),
                   std::move(p.modelled_N_m));
    };
    for (const CalibrationTrial& trial : held_out) out.held_out[b + 1].push_back(regressed(trial, true));
    for (const CalibrationTrial& trial : training) out.training[b + 1].push_back(regressed(trial, false));
  }
  out.fold = std::move(fold);
  return out;
}

Metrics pooled(const std::vector<TrialScore>& scores) {
  std::vector<std::vector<double>> reference, model;
  for (const TrialScore& s : scores) {
    reference.push_back(s.reference_N_m);
    model.push_back(s.modelled_N_m);
  }
  return pooled_metrics(reference, model);
}

}  // namespace

std::map<std::string, double> channel_maxima(const std::vector<CalibrationTrial>& trials) {
  std::map<std::string, double> out;
  for (const CalibrationTrial& trial : trials)
    for (const data::Signal& channel : trial.excitations)
      for (double value : channel.samples) out[channel.info.name] = std::max(out[channel.info.name], value);
  for (const auto& [name, value] : out)
    if (!(value > 0.0) || !std::isfinite(value))
      throw data::InputError(
          "constant-channel",
          fmt::format("channel `{}` has no positive sample: it cannot be normalised", name),
          "exclude the channel by name");
  return out;
}

std::vector<CalibrationTrial> scaled_by(std::vector<CalibrationTrial> trials,
                                        const std::map<std::string, double>& maximum) {
  for (CalibrationTrial& trial : trials) {
    for (data::Signal& channel : trial.excitations) {
      const auto found = maximum.find(channel.info.name);
      if (found == maximum.end())
        throw data::InputError(
            "unmapped-channel",
            fmt::format("trial `{}`: channel `{}` is in no training trial", trial.name, channel.info.name));
      for (double& value : channel.samples) value /= found->second;
    }
  }
  return trials;
}

std::vector<data::Diagnostic> check_split(const std::vector<std::string>& training,
                                          const std::vector<std::string>& judged) {
  std::vector<data::Diagnostic> out;
  for (const std::string& trial : judged)
    if (std::find(training.begin(), training.end(), trial) != training.end())
      out.push_back(
          {data::Severity::warning,
           "trained-and-judged",
           fmt::format(
               "trial `{}` is used for both training and verdict: its error says nothing of unseen trials",
               trial),
           {},
           "hold it out of the training"});
  return out;
}

CrossValidationResult cross_validate(const data::Scene& scene, const std::vector<CalibrationTrial>& trials,
                                     const CrossValidationOptions& options) {
  std::vector<std::string> names;
  for (const CalibrationTrial& trial : trials) names.push_back(trial.name);
  if (names.size() < 2)
    throw data::InputError("too-few-trials",
                           fmt::format("cross-validation by trial needs at least two trials, there {} {}",
                                       names.size() == 1 ? "is" : "are", names.size()));
  std::vector<Fold> folds;
  const auto fold_without = [&](const std::vector<std::string>& held_out) {
    Fold fold;
    fold.held_out = held_out;
    for (const std::string& name : names)
      if (std::find(held_out.begin(), held_out.end(), name) == held_out.end()) fold.training.push_back(name);
    return fold;
  };
  if (options.hold_out.empty()) {
    for (const std::string& name : names) folds.push_back(fold_without({name}));
  } else {
    folds.push_back(fold_without(data::match_names(options.hold_out, names, "trial")));
    if (folds.back().training.empty())
      throw data::InputError("too-few-trials", "every trial is held out: none is left to train on",
                             "hold out fewer trials");
  }

  std::vector<FoldOutput> outputs(folds.size());
  data::parallel_for(folds.size(), options.threads,
                     [&](std::size_t f) { outputs[f] = run_fold(scene, trials, folds[f], options); });

  CrossValidationResult result;
  for (std::size_t m = 0; m < 1 + options.baselines.size(); ++m) {
    ModelScore model;
    model.model = m == 0 ? "muscle model" : options.baselines[m - 1].name();
    std::vector<TrialScore> training;
    for (const FoldOutput& output : outputs) {
      model.held_out.insert(model.held_out.end(), output.held_out[m].begin(), output.held_out[m].end());
      training.insert(training.end(), output.training[m].begin(), output.training[m].end());
    }
    model.pooled_held_out = pooled(model.held_out);
    model.pooled_training = pooled(training);
    result.models.push_back(std::move(model));
  }
  for (FoldOutput& output : outputs) {
    for (data::Diagnostic diagnostic : output.fold.calibration.diagnostics) {
      diagnostic.message =
          fmt::format("without `{}`: {}", fmt::join(output.fold.held_out, "`, `"), diagnostic.message);
      result.diagnostics.push_back(std::move(diagnostic));
    }
    result.folds.push_back(std::move(output.fold));
  }
  return result;
}

data::Table CrossValidationResult::table() const {
  std::vector<std::string> model, trial, set;
  std::vector<double> count, rmse, nrmse, r2, bias;
  const double none = std::nan("");
  const auto add = [&](const std::string& m, const std::string& t, const std::string& s, const Metrics& x) {
    model.push_back(m);
    trial.push_back(t);
    set.push_back(s);
    count.push_back(static_cast<double>(x.count));
    rmse.push_back(x.rmse);
    nrmse.push_back(x.nrmse_range.value_or(none));
    r2.push_back(x.r2.value_or(none));
    bias.push_back(x.bias);
  };
  for (const ModelScore& m : models)
    for (const TrialScore& s : m.held_out) add(m.model, s.trial, "held out", s.metrics);
  for (const ModelScore& m : models) add(m.model, "all trials, pooled", "held out", m.pooled_held_out);
  for (const ModelScore& m : models) add(m.model, "all trials, pooled", "training", m.pooled_training);
  data::Table table;
  table.title = "Errors of the moment, by model and trial";
  table.columns = {{"model", "", model},    {"trial", "", trial},  {"set", "", set},
                   {"samples", "1", count}, {"rmse", "N m", rmse}, {"nrmse_range", "1", nrmse},
                   {"r2", "1", r2},         {"bias", "N m", bias}};
  return table;
}

}  // namespace brachium::optimise
