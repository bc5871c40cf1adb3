#pragma once
/// Regressions with no physiology, on the same split: what a muscle model must beat.
///
/// Feature sets, for channels c_k, angle q, velocity q', acceleration q''; a constant column is always fitted:
///
/// | name               | columns                                                                              |
/// |--------------------|--------------------------------------------------------------------------------------|
/// | linear_envelope    | c_k for every channel, sin q                                                         |
/// | angle_polynomial   | q, q^2, ..., q^degree (no EMG)                                                       |
/// | flexible           | for delays 0, 0.1, 0.2 s and every channel: c, c sin q, c cos q, c q', c q' sin q; then |
/// |                    | q, q^2, q^3, sin q, cos q, q', q'': 52 columns with three channels                   |
///
/// Columns are standardised on the training trials; `ridge` is the penalty per sample on standardised weights.

#include <string>
#include <vector>

#include "optimise/calibration_problem.hpp"

namespace brachium::optimise {

struct BaselineSpec {
  enum class Kind { linear_envelope, angle_polynomial, flexible };
  Kind kind = Kind::linear_envelope;
  int degree = 3;      ///< angle_polynomial
  double ridge = 0.0;  ///< >= 0
  std::string name()
      const;  ///< "linear_envelope", "angle_polynomial_3", "flexible_52" (number of columns once fitted)
};

/// A fitted regression.
struct Baseline {
  BaselineSpec spec;
  std::string title;                 ///< one phrase for a report
  std::vector<std::string> columns;  ///< names of the features
  Eigen::VectorXd weights;           ///< on standardised columns
  Eigen::VectorXd mean, deviation;   ///< of the columns on the training trials
  double intercept = 0.0;
};

/// Fitted to the reference moment inside each trial's window (edge_s as in the calibration).
Baseline fit_baseline(const BaselineSpec& spec, const std::vector<CalibrationTrial>& training, double edge_s);
/// Predicted moment at the reference's time stamps inside the window, and those stamps' reference.
struct BaselinePrediction {
  std::vector<double> time_s, reference_N_m, modelled_N_m;
};
BaselinePrediction predict(const Baseline& baseline, const CalibrationTrial& trial, double edge_s);

}  // namespace brachium::optimise
