#pragma once
/// Cross-validation by trial: calibrated on some trials, judged on others that the calibration never saw.
///
/// Everything that depends on data is computed anew in each fold from its training trials alone: the fit, its
/// scale, the normalisation of channels without an MVC (a factor of one on their training maximum), the
/// baselines.

#include <map>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "optimise/baseline.hpp"
#include "optimise/calibration.hpp"

namespace brachium::optimise {

struct CrossValidationOptions {
  CalibrationOptions calibration;
  /// Named trials held out together (patterns); empty: leave one trial out, each in turn.
  std::vector<std::string> hold_out;
  /// Divide each channel by its largest excitation over the fold's training trials (recordings without an
  /// MVC).
  bool normalise_by_training_maximum = false;
  std::vector<BaselineSpec> baselines = {{BaselineSpec::Kind::linear_envelope},
                                         {BaselineSpec::Kind::angle_polynomial},
                                         {BaselineSpec::Kind::flexible}};
  std::size_t threads = 1;  ///< folds in parallel; results do not depend on it
};

/// One model's figures on one trial of one fold.
struct TrialScore {
  std::string trial;
  bool held_out = true;
  Metrics metrics;
  std::vector<double> time_s, reference_N_m, modelled_N_m;
};

/// One model, named "muscle model" or by its baseline.
struct ModelScore {
  std::string model;
  std::vector<TrialScore> held_out;  ///< over all folds
  Metrics pooled_held_out;           ///< all held-out samples as one
  Metrics pooled_training;           ///< all folds' training samples as one
};

struct Fold {
  std::vector<std::string> training, held_out;
  CalibrationResult calibration;
  std::map<std::string, double> channel_maximum;  ///< divisor of each channel, where normalised
};

struct CrossValidationResult {
  std::vector<Fold> folds;
  std::vector<ModelScore> models;  ///< muscle model first, then the baselines in their order
  std::vector<data::Diagnostic> diagnostics;
  data::Table table() const;  ///< model, trial, held-out RMSE, NRMSE (range), R2, bias; pooled rows last
};

/// Throws InputError: "no-match" for a pattern, "too-few-trials", and as calibrate().
CrossValidationResult cross_validate(const data::Scene& scene, const std::vector<CalibrationTrial>& trials,
                                     const CrossValidationOptions& options);

/// Trials that stand in both lists: a verdict on them is no verdict. One warning each ("trained-and-judged").
std::vector<data::Diagnostic> check_split(const std::vector<std::string>& training,
                                          const std::vector<std::string>& judged);

/// Each channel's largest excitation over the trials, and the trials divided by it. A channel without a
/// positive sample throws InputError("constant-channel").
std::map<std::string, double> channel_maxima(const std::vector<CalibrationTrial>& trials);
std::vector<CalibrationTrial> scaled_by(std::vector<CalibrationTrial> trials,
                                        const std::map<std::string, double>& channel_maximum);

}  // namespace brachium::optimise
