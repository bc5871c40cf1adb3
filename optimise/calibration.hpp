#pragma once
/// Calibration: from trials to a subject with a verdict on every parameter.

#include <functional>
#include <string>
#include <vector>

#include "optimise/calibration_problem.hpp"
#include "optimise/excitation_error.hpp"
#include "optimise/metrics.hpp"
#include "optimise/solve.hpp"
#include "optimise/statistics.hpp"
#include "optimise/verdicts.hpp"

namespace brachium::optimise {

struct CalibrationOptions {
  CalibrationProblemOptions problem;
  bool linear_strength_first =
      true;  ///< start from the bounded linear fit of strengths (where strengths are free)
  SolveOptions solver;
  StatisticsOptions statistics;
  ExcitationNoise excitation_noise;
  bool correct_bias = true;  ///< take the estimated bias off the fitted values (inside the bounds)
  std::string subject_name;
};

struct CalibrationResult {
  data::Subject subject;  ///< fitted values, verdicts, statistics; provenance holds trials and options
  Eigen::VectorXd x;      ///< fitted parameters (bias removed if so asked)
  Eigen::VectorXd x_uncorrected;  ///< the least-squares solution
  std::vector<Parameter> parameters;
  Summary summary;
  FitStatistics statistics;  ///< covariance with the share of the excitation's noise
  ExcitationErrorResult excitation_error;
  std::vector<TrialWindow> windows;
  std::vector<Metrics> trial_metrics;  ///< on the training trials
  Metrics pooled;
  std::vector<data::Diagnostic>
      diagnostics;  ///< warnings and notes: weak directions, bounds, excitations above 1
};

/// Fits. Throws InputError as CalibrationProblem does, and data::ConvergenceFailure if no start succeeds.
CalibrationResult calibrate(const data::Scene& scene, const std::vector<CalibrationTrial>& trials,
                            const CalibrationOptions& options);

/// A subject's moment on a trial, at the reference's time stamps inside the usable window.
struct Prediction {
  std::string trial;
  std::vector<double> time_s, reference_N_m, modelled_N_m;
  TrialWindow window;
};
Prediction predict(const data::Scene& scene, const data::Subject& subject, const CalibrationTrial& trial,
                   const CalibrationProblemOptions& options);

/// The scene with a subject's parameters in place of its own; throws InputError("missing-muscle") for a
/// muscle that the subject does not know.
data::Scene with_subject(data::Scene scene, const data::Subject& subject);

}  // namespace brachium::optimise
