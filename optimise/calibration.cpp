#include "optimise/calibration.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "optimise/nnls.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The strengths that fit best at the other parameters' start: a bounded linear problem, priors included.
VectorXd strength_fit(const CalibrationProblem& problem) {
  const auto& parameters = problem.parameters();
  VectorXd x = start_of(parameters);
  const std::vector<std::size_t> columns = problem.strength_parameters();
  if (columns.empty()) return x;
  VectorXd r;
  MatrixXd J;
  problem.evaluator()->evaluate(x, r, &J);
  const Index k = static_cast<Index>(columns.size()), m = r.size();
  MatrixXd A = MatrixXd::Zero(m + k, k);
  VectorXd b = VectorXd::Zero(m + k), lower(k), upper(k);
  b.head(m) = -r;
  for (Index c = 0; c < k; ++c) {
    const auto j = static_cast<Index>(columns[static_cast<std::size_t>(c)]);
    const Parameter& p = parameters[static_cast<std::size_t>(j)];
    A.col(c).head(m) = J.col(j);
    b.head(m) += J.col(j) * x[j];  // the moment is linear in strengths: r(s) = r(s0) + J (s - s0)
    lower[c] = p.lower;
    upper[c] = p.upper;
    if (!p.prior) continue;
    A(m + c, c) = 1.0 / p.prior->standard_deviation;
    b[m + c] = p.prior->mean / p.prior->standard_deviation;
  }
  const LinearFit fit = bounded_least_squares(A, b, lower, upper);
  for (Index c = 0; c < k; ++c) x[static_cast<Index>(columns[static_cast<std::size_t>(c)])] = fit.x[c];
  return x;
}

/// Swaps exchangeable pairs so that the smaller comes first: one of two equal solutions, always the same one.
void order_pairs(const std::vector<Parameter>& parameters, VectorXd& x) {
  for (const auto& [a, b] : exchangeable_pairs(parameters)) {
    const Parameter &p = parameters[a], &q = parameters[b];
    const bool same = p.lower == q.lower && p.upper == q.upper && !p.prior && !q.prior;
    const auto i = static_cast<Index>(a), j = static_cast<Index>(b);
    if (same && std::abs(x[i]) > std::abs(x[j])) std::swap(x[i], x[j]);
  }
}

/// The covariance under noise in the excitation takes the sandwich's place; no standard error becomes smaller
/// by it. Where the bias is not taken off, it counts as an error.
void widen(const CalibrationProblem& problem, const ExcitationErrorResult& error, bool corrected,
           const MatrixXd& jacobian, const StatisticsOptions& options, FitStatistics& statistics) {
  const VectorXd before = statistics.covariance.diagonal();
  MatrixXd C = error.covariance;
  if (!corrected) C += error.bias * error.bias.transpose();
  VectorXd raise = VectorXd::Ones(C.rows());
  for (Index j = 0; j < C.rows(); ++j)
    if (C(j, j) > 0.0 && C(j, j) < before[j]) raise[j] = std::sqrt(before[j] / C(j, j));
  statistics.covariance = raise.asDiagonal() * C * raise.asDiagonal();
  describe_covariance(problem.parameters(), jacobian, options, statistics);
}

void add_warnings(const CalibrationProblem& problem, CalibrationResult& result) {
  const auto add = [&](data::Severity severity, const std::string& code, const std::string& message,
                       const std::string& help = {}) {
    result.diagnostics.push_back({severity, code, message, {}, help});
  };
  if (!result.summary.converged)
    add(data::Severity::warning, "not-converged",
        "the calibration did not converge: " + result.summary.message(),
        "allow more iterations, or set fewer parameters free");
  if (result.excitation_error.limited)
    add(data::Severity::warning, "unreliable-excitation",
        fmt::format("noise in the excitations hides a combination of parameters (reliability {:.2f}): its "
                    "bias is only partly "
                    "removed",
                    result.excitation_error.least_reliability),
        "let channels act one at a time, lower the envelope's cut-off, or set fewer parameters free");
  if (!result.excitation_error.converged)
    add(data::Severity::warning, "not-converged",
        "the correction for noise in the excitations did not converge");
  for (const TrialWindow& w : result.windows) {
    if (w.above_one > 0)
      add(data::Severity::warning, "excitation-above-one",
          fmt::format("trial `{}`: {} excitation samples exceed 1; activation is limited to 1 there", w.name,
                      w.above_one),
          "a poor MVC, or normalisation by another trial");
    if (w.below_zero > 0)
      add(data::Severity::note, "excitation-below-zero",
          fmt::format("trial `{}`: {} excitation samples are negative; activation is limited to 0 there",
                      w.name, w.below_zero));
  }
  for (const std::string& muscle : problem.undriven())
    add(data::Severity::note, "undriven-muscle",
        fmt::format("muscle `{}` has no excitation: it is passive", muscle));
  for (const auto& v : result.subject.verdicts) {
    if (v.verdict == "identified") continue;
    add(data::Severity::warning, v.verdict == "NOT IDENTIFIED" ? "not-identified" : "at-bound",
        fmt::format("`{} {}` is {}{}", v.muscle, v.parameter, v.verdict,
                    v.remark.empty() ? "" : ": " + v.remark));
  }
  for (const WeakDirection& weak : result.statistics.weak)
    if (weak.parameters.size() > 1)
      add(data::Severity::warning, "weak-combination",
          fmt::format("the data hardly see this combination (relative singular value {:.1e}): {}",
                      weak.relative_singular_value, weak.text));
}

void add_metrics(const CalibrationProblem& problem, CalibrationResult& result) {
  VectorXd residuals;
  problem.evaluator()->evaluate(result.x, residuals, nullptr);
  std::vector<std::vector<double>> reference, model;
  for (std::size_t t = 0; t < problem.windows().size(); ++t) {
    reference.push_back(problem.reference_N_m(t));
    model.push_back(problem.modelled_N_m(t, residuals));
    result.trial_metrics.push_back(metrics(reference.back(), model.back()));
  }
  result.pooled = pooled_metrics(reference, model);
  auto& s = result.subject.statistics;
  s["training_rmse_N_m"] = result.pooled.rmse;
  s["training_bias_N_m"] = result.pooled.bias;
  if (result.pooled.nrmse_range) s["training_nrmse_range"] = *result.pooled.nrmse_range;
  if (result.pooled.r2) s["training_r2"] = *result.pooled.r2;
  s["cost"] = result.summary.cost;
  s["evaluations"] = result.summary.evaluations;
  s["scale_N_m"] = problem.scale_N_m();
  s["effective_samples"] = result.statistics.effective_samples;
  s["samples_per_independent_sample"] = result.statistics.inflation;
}

}  // namespace

CalibrationResult calibrate(const data::Scene& scene, const std::vector<CalibrationTrial>& trials,
                            const CalibrationOptions& options) {
  const CalibrationProblem problem(scene, trials, options.problem);
  if (problem.parameters().empty())
    throw data::InputError("nothing-free", "the calibration has no free parameter",
                           "name at least one under `free`");
  CalibrationResult result;
  result.parameters = problem.parameters();
  result.windows = problem.windows();
  SolveOptions solver = options.solver;
  if (options.linear_strength_first && !solver.start) solver.start = strength_fit(problem);
  result.summary = solve(problem, solver);
  order_pairs(result.parameters, result.summary.x);
  result.x_uncorrected = result.summary.x;
  result.x = result.x_uncorrected;

  VectorXd residuals;
  MatrixXd jacobian;
  problem.evaluator()->evaluate(result.x_uncorrected, residuals, &jacobian);
  result.statistics = fit_statistics(result.parameters, result.x_uncorrected, residuals, jacobian,
                                     problem.blocks(), options.statistics);
  const Index n = result.x.size();
  result.excitation_error.bias = VectorXd::Zero(n);
  if (options.excitation_noise.coefficient_of_variation != 0.0) {
    result.excitation_error = simulate_excitation_error(problem, result.x_uncorrected,
                                                        std::vector<bool>(static_cast<std::size_t>(n), false),
                                                        options.excitation_noise, options.problem.threads);
    widen(problem, result.excitation_error, options.correct_bias, jacobian, options.statistics,
          result.statistics);
    if (options.correct_bias) result.x = result.excitation_error.x;
  }

  result.subject = problem.subject(result.x);
  result.subject.name = options.subject_name;
  result.subject.verdicts = verdicts(
      {&result.parameters, result.x, result.x_uncorrected, result.excitation_error.bias, &result.statistics,
       profile_intervals(problem, result.x, result.statistics.covariance,
                         student_quantile(result.statistics.degrees_of_freedom), options.problem.threads),
       problem.gain_strength_pairs()});
  add_metrics(problem, result);
  std::string names;
  for (const CalibrationTrial& trial : trials) names += (names.empty() ? "" : ", ") + trial.name;
  auto& provenance = result.subject.provenance;
  provenance["training_trials"] = names;
  provenance["scene"] = scene.title;
  provenance["solver"] = to_string(options.solver.solver);
  provenance["solver_message"] =
      result.summary.message().substr(0, result.summary.message().rfind(','));  // no times
  provenance["intervals"] = fmt::format(
      "95 %, Student t with {:.0f} degrees of freedom; Newey-West sandwich{}, along each parameter's profile",
      result.statistics.degrees_of_freedom,
      options.excitation_noise.coefficient_of_variation != 0.0
          ? fmt::format(", corrected score with {} simulated data sets (CV of the excitations {:.3f})",
                        result.excitation_error.replicates, options.excitation_noise.coefficient_of_variation)
          : std::string());
  add_warnings(problem, result);
  return result;
}

data::Scene with_subject(data::Scene scene, const data::Subject& subject) {
  for (data::SceneMuscle& muscle : scene.muscles) {
    const data::SubjectMuscle& known = subject.muscle(muscle.name);
    muscle.parameters = known.parameters;
    muscle.activation = known.activation;
  }
  return scene;
}

Prediction predict(const data::Scene& scene, const data::Subject& subject, const CalibrationTrial& trial,
                   const CalibrationProblemOptions& options) {
  CalibrationProblemOptions own = options;
  own.free.clear();
  own.scale_N_m = 1.0;
  own.independent_rate_hz.reset();
  own.channel_gains = subject.channel_gains;
  own.model = ModelChoice::from_map(subject.model);
  const CalibrationProblem problem(with_subject(scene, subject), {trial}, own);
  VectorXd residuals;
  problem.evaluator()->evaluate(VectorXd(), residuals, nullptr);
  return {trial.name, problem.times_s(0), problem.reference_N_m(0), problem.modelled_N_m(0, residuals),
          problem.windows()[0]};
}

}  // namespace brachium::optimise
