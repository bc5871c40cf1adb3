#pragma once
/// Options -> solve -> Summary: one door to all solvers of a bounded least-squares problem.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "optimise/problem.hpp"

namespace brachium::optimise {

enum class Solver {
  levenberg_marquardt,      ///< own: projected on the bounds (active set); uses the residuals' structure
                            ///< (default)
  gsl_levenberg_marquardt,  ///< GSL multifit_nlinear; bounds by x = mid + half * sin(z) (James & Roos 1975)
  slsqp,                    ///< NLopt LD_SLSQP (Kraft 1994), gradient
  lbfgs,                    ///< NLopt LD_LBFGS, gradient
  mma,                      ///< NLopt LD_MMA (Svanberg 2002), gradient
  bobyqa,                   ///< NLopt LN_BOBYQA (Powell 2009), derivative-free
  subplex,                  ///< NLopt LN_SBPLX (Rowan 1990), derivative-free
  crs2,                     ///< NLopt GN_CRS2_LM (Kaelo & Ali 2006), global, derivative-free
  isres,                    ///< NLopt GN_ISRES (Runarsson & Yao 2005), global, derivative-free
  mlsl                      ///< NLopt GD_MLSL_LDS with LD_SLSQP inside (Rinnooy Kan & Timmer 1987), global
};
std::string to_string(Solver solver);
/// Throws InputError("unknown-solver") with the nearest name.
Solver parse_solver(const std::string& name);
std::vector<std::string> solver_names();

/// One row of a solver's log.
struct Iteration {
  std::size_t start = 0;  ///< which of the multi-starts
  int iteration = 0;
  int evaluations = 0;  ///< of the residuals, so far
  double cost = 0.0;    ///< f(x)
  double gradient_norm =
      0.0;  ///< max |projected gradient| in scaled parameters; NaN is never given: 0 if unknown
  double step_norm = 0.0;  ///< max |dx| / scale
  double damping = 0.0;    ///< Levenberg-Marquardt's; 0 elsewhere
};
/// Fixed-width text of one row, and the heading above it.
std::string log_heading();
std::string log_row(const Iteration& row);

struct SolveOptions {
  Solver solver = Solver::levenberg_marquardt;
  int max_iterations = 200;
  int max_evaluations = 20000;    ///< a bound on the work of derivative-free and global solvers
  double cost_tolerance = 1e-14;  ///< stop when the relative decrease of f is below ...
  double step_tolerance = 1e-11;  ///< ... or the step in scaled parameters is below ...
  double gradient_tolerance =
      1e-11;  ///< ... or the projected gradient relative to sqrt(2 f) max |J column| is below
  double stall_tolerance = 1e-9;         ///< ... or, Levenberg-Marquardt, the relative decrease of f over 10
                                         ///< iterations: at a kink of f the gradient never vanishes
  std::optional<Eigen::VectorXd> start;  ///< first start; default: the parameters' own
  std::size_t starts = 1;                ///< the first start, then points drawn between the bounds
  std::uint64_t seed = 1;                ///< of starts and of stochastic solvers; results repeat exactly
  std::size_t threads = 1;  ///< multi-starts in parallel (0: all cores); results do not depend on it
  std::function<void(const Iteration&)> progress;  ///< called under a lock, from any thread
};

/// What came of one start.
struct StartResult {
  Eigen::VectorXd start, x;
  double cost_start = 0.0, cost = 0.0;
  int iterations = 0, evaluations = 0, jacobians = 0;
  bool converged = false;
  std::string reason;  ///< why it stopped, in words
};

struct Summary {
  Eigen::VectorXd x;        ///< best point found
  double cost_start = 0.0;  ///< f at the parameters' start
  double cost = 0.0;        ///< f(x)
  bool converged = false;
  std::string reason;
  std::size_t best_start = 0;
  int evaluations = 0;  ///< of the residuals, over all starts
  int jacobians = 0;
  double seconds = 0.0;
  std::vector<StartResult> starts;
  std::vector<Iteration> iterations;  ///< of the best start

  /// Closing line of a log: reason, cost, work, time.
  std::string message() const;
};

/// Minimises f. A start at which the model fails is recorded with its reason; throws data::ConvergenceFailure
/// if all fail. Throws InputError for bad parameters or options.
Summary solve(const LeastSquaresProblem& problem, const SolveOptions& options);

/// f, priors included.
double cost_of(const std::vector<Parameter>& parameters, const Eigen::VectorXd& x,
               const Eigen::VectorXd& residuals);

}  // namespace brachium::optimise
