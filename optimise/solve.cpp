#include "optimise/solve.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>

#include "data/model/error.hpp"
#include "data/model/parallel.hpp"
#include "emg/random.hpp"
#include "optimise/objective.hpp"

namespace brachium::optimise {
namespace {

constexpr std::array<const char*, 10> solver_name = {"levenberg_marquardt",
                                                     "gsl_levenberg_marquardt",
                                                     "slsqp",
                                                     "lbfgs",
                                                     "mma",
                                                     "bobyqa",
                                                     "subplex",
                                                     "crs2",
                                                     "isres",
                                                     "mlsl"};

void check_options(const SolveOptions& options) {
  std::vector<data::Diagnostic> found;
  const auto need = [&](bool good, const std::string& message) {
    if (!good) found.push_back({data::Severity::error, "out-of-range", message, {}, {}});
  };
  need(options.starts >= 1, "`starts` must be at least 1");
  need(options.max_iterations >= 1,
       fmt::format("`max_iterations` {} must be at least 1", options.max_iterations));
  need(options.max_evaluations >= 1,
       fmt::format("`max_evaluations` {} must be at least 1", options.max_evaluations));
  need(options.cost_tolerance >= 0.0,
       fmt::format("`cost_tolerance` {} must not be negative", options.cost_tolerance));
  need(options.step_tolerance >= 0.0,
       fmt::format("`step_tolerance` {} must not be negative", options.step_tolerance));
  need(options.gradient_tolerance >= 0.0,
       fmt::format("`gradient_tolerance` {} must not be negative", options.gradient_tolerance));
  if (!found.empty()) throw data::InputError(std::move(found));
}

Eigen::VectorXd drawn_start(const std::vector<Parameter>& parameters, const SolveOptions& options,
                            std::size_t index) {
  if (index == 0) return options.start.value_or(start_of(parameters));
  emg::Random random(options.seed, index);
  Eigen::VectorXd x = lower_of(parameters);
  const Eigen::VectorXd width = upper_of(parameters) - x;
  for (Eigen::Index j = 0; j < x.size(); ++j) x[j] += width[j] * random.uniform();
  return x;
}

}  // namespace

std::string to_string(Solver solver) {
  return solver_name[static_cast<std::size_t>(solver)];
}

std::vector<std::string> solver_names() {
  return {solver_name.begin(), solver_name.end()};
}

Solver parse_solver(const std::string& name) {
  for (std::size_t i = 0; i < solver_name.size(); ++i)
    if (name == solver_name[i]) return static_cast<Solver>(i);
  throw data::InputError("unknown-solver", fmt::format("`{}` is not a solver", name),
                         data::suggest(name, solver_names()));
}

std::string log_heading() {
  return fmt::format("{:>5} {:>5} {:>7} {:>16} {:>10} {:>10} {:>10}", "start", "iter", "evals", "cost",
                     "gradient", "step", "damping");
}

std::string log_row(const Iteration& row) {
  return fmt::format("{:>5} {:>5} {:>7} {:>16.9e} {:>10.2e} {:>10.2e} {:>10.2e}", row.start, row.iteration,
                     row.evaluations, row.cost, row.gradient_norm, row.step_norm, row.damping);
}

std::string Summary::message() const {
  return fmt::format("{}: {}; cost {:.6e} -> {:.6e}, {} evaluations, {} Jacobians, {} start{}, {:.3f} s",
                     converged ? "converged" : "NOT CONVERGED", reason, cost_start, cost, evaluations,
                     jacobians, starts.size(), starts.size() == 1 ? "" : "s", seconds);
}

double cost_of(const std::vector<Parameter>& parameters, const Eigen::VectorXd& x,
               const Eigen::VectorXd& residuals) {
  double cost = 0.5 * residuals.squaredNorm();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    if (!parameters[j].prior) continue;
    const double z = (x[static_cast<Eigen::Index>(j)] - parameters[j].prior->mean) /
                     parameters[j].prior->standard_deviation;
    cost += 0.5 * z * z;
  }
  return cost;
}

Summary solve(const LeastSquaresProblem& problem, const SolveOptions& options) {
  check_parameters(problem.parameters());
  check_options(options);
  if (problem.parameters().empty())
    throw data::InputError("nothing-free", "the problem has no free parameter");
  if (options.start) {
    const Eigen::VectorXd &x = *options.start, lower = lower_of(problem.parameters()),
                          upper = upper_of(problem.parameters());
    if (x.size() != lower.size() || !((x - lower).minCoeff() >= 0.0) || !((upper - x).minCoeff() >= 0.0))
      throw data::InputError("out-of-range",
                             "the start given to the solver is not inside the parameters' bounds");
  }
  const auto begin = std::chrono::steady_clock::now();

  Summary summary;
  summary.starts.resize(options.starts);
  std::vector<std::vector<Iteration>> logs(options.starts);
  std::mutex mutex;
  data::parallel_for(options.starts, options.threads, [&](std::size_t index) {
    StartResult& result = summary.starts[index];
    result.start = drawn_start(problem.parameters(), options, index);
    result.cost = std::numeric_limits<double>::infinity();
    Objective objective(problem);
    const Report report = [&](Iteration row) {
      row.start = index;
      logs[index].push_back(row);
      if (!options.progress) return;
      const std::lock_guard lock(mutex);
      options.progress(row);
    };
    if (options.solver == Solver::levenberg_marquardt)
      run_levenberg_marquardt(objective, options, report, result);
    else if (options.solver == Solver::gsl_levenberg_marquardt)
      run_gsl(objective, options, report, result);
    else
      run_nlopt(objective, options, options.seed + index, report, result);
    if (result.x.size())
      result.x = result.x.cwiseMax(lower_of(problem.parameters())).cwiseMin(upper_of(problem.parameters()));
    result.evaluations = objective.evaluations();
    result.jacobians = objective.jacobians();
    if (objective.failures() > 0 && result.x.size())
      result.reason += fmt::format(" ({} points without a value)", objective.failures());
  });

  for (std::size_t index = 0; index < summary.starts.size(); ++index) {
    const StartResult& result = summary.starts[index];
    summary.evaluations += result.evaluations;
    summary.jacobians += result.jacobians;
    if (result.cost < summary.starts[summary.best_start].cost) summary.best_start = index;
  }
  const StartResult& best = summary.starts[summary.best_start];
  if (best.x.size() == 0)
    throw data::ConvergenceFailure({"solve", best.reason, best.iterations, 0.0, 0.0, "every start failed"});
  summary.x = best.x;
  summary.cost = best.cost;
  summary.cost_start = summary.starts.front().cost_start;
  summary.converged = best.converged;
  summary.reason = best.reason;
  summary.iterations = std::move(logs[summary.best_start]);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return summary;
}

}  // namespace brachium::optimise
