/// NLopt's solvers on f = 1/2 |r|^2 in scaled parameters.

#include <nlopt.hpp>

#include <cmath>
#include <limits>

#include "optimise/objective.hpp"

namespace brachium::optimise {
namespace {

using Eigen::VectorXd;

nlopt::algorithm algorithm(Solver solver) {
  switch (solver) {
    case Solver::slsqp:
      return nlopt::LD_SLSQP;
    case Solver::lbfgs:
      return nlopt::LD_LBFGS;
    case Solver::mma:
      return nlopt::LD_MMA;
    case Solver::bobyqa:
      return nlopt::LN_BOBYQA;
    case Solver::subplex:
      return nlopt::LN_SBPLX;
    case Solver::crs2:
      return nlopt::GN_CRS2_LM;
    case Solver::isres:
      return nlopt::GN_ISRES;
    default:
      return nlopt::GD_MLSL_LDS;
  }
}

bool is_global(Solver solver) {
  return solver == Solver::crs2 || solver == Solver::isres || solver == Solver::mlsl;
}

struct Context {
  Objective* objective;
  const Report* report;
  const SolveOptions* options;
  StartResult* result;
  nlopt::opt* opt;
  VectorXd r, best;
  Eigen::MatrixXd J;
  double best_cost = std::numeric_limits<double>::infinity();
};

double cost(const std::vector<double>& u, std::vector<double>& gradient, void* data) {
  auto& context = *static_cast<Context*>(data);
  const VectorXd point = Eigen::Map<const VectorXd>(u.data(), static_cast<Eigen::Index>(u.size()));
  if (context.objective->evaluations() >= context.options->max_evaluations) throw nlopt::forced_stop();
  const bool wanted = !gradient.empty();
  if (!context.objective->evaluate(point, context.r, wanted ? &context.J : nullptr)) {
    std::fill(gradient.begin(), gradient.end(), 0.0);
    return std::numeric_limits<double>::max();
  }
  const double f = 0.5 * context.r.squaredNorm();
  double norm = 0.0;
  if (wanted) {
    const VectorXd g = context.J.transpose() * context.r;
    for (std::size_t j = 0; j < gradient.size(); ++j) gradient[j] = g[static_cast<Eigen::Index>(j)];
    norm = projected_gradient_norm(point, g, context.objective->lower(), context.objective->upper());
  }
  if (f < context.best_cost) {
    const double step = context.best.size() ? (point - context.best).lpNorm<Eigen::Infinity>() : 0.0;
    context.best_cost = f;
    context.best = point;
    (*context.report)(
        {0, ++context.result->iterations, context.objective->evaluations(), f, norm, step, 0.0});
  }
  return f;
}

std::string describe(nlopt::result code) {
  switch (code) {
    case nlopt::STOPVAL_REACHED:
      return "stop value reached";
    case nlopt::FTOL_REACHED:
      return "relative decrease below tolerance";
    case nlopt::XTOL_REACHED:
      return "step below tolerance";
    case nlopt::MAXEVAL_REACHED:
      return "evaluation limit reached";
    case nlopt::MAXTIME_REACHED:
      return "time limit reached";
    default:
      return "done";
  }
}

}  // namespace

void run_nlopt(Objective& objective, const SolveOptions& options, std::uint64_t seed, const Report& report,
               StartResult& result) {
  const std::size_t n = static_cast<std::size_t>(objective.size());
  nlopt::opt opt(algorithm(options.solver), static_cast<unsigned>(n));
  Context context{&objective, &report, &options, &result, &opt, {}, {}, {}};
  const auto as_vector = [](const VectorXd& v) { return std::vector<double>(v.data(), v.data() + v.size()); };
  opt.set_lower_bounds(as_vector(objective.lower()));
  opt.set_upper_bounds(as_vector(objective.upper()));
  opt.set_min_objective(cost, &context);
  opt.set_ftol_rel(options.cost_tolerance);
  opt.set_xtol_rel(options.step_tolerance);
  opt.set_maxeval(options.max_evaluations);
  if (options.solver == Solver::mlsl) {
    nlopt::opt local(nlopt::LD_SLSQP, static_cast<unsigned>(n));
    local.set_ftol_rel(1e-8);
    local.set_xtol_rel(1e-8);
    opt.set_local_optimizer(local);
  }
  // NLopt's generator is per thread but shared by calls on it: seeded anew for every start.
  if (is_global(options.solver)) nlopt::srand(static_cast<unsigned long>(seed));
  std::vector<double> u =
      as_vector(objective.scaled(result.start).cwiseMax(objective.lower()).cwiseMin(objective.upper()));
  VectorXd r;
  if (!objective.evaluate(Eigen::Map<const VectorXd>(u.data(), static_cast<Eigen::Index>(n)), r, nullptr)) {
    result.reason = "no value at the start: " + objective.failure();
    return;
  }
  result.cost_start = 0.5 * r.squaredNorm();
  try {
    double f = 0.0;
    const nlopt::result code = opt.optimize(u, f);
    result.reason = describe(code);
    result.converged = code == nlopt::FTOL_REACHED || code == nlopt::XTOL_REACHED || code == nlopt::SUCCESS ||
                       code == nlopt::STOPVAL_REACHED;
  } catch (const nlopt::roundoff_limited&) {
    result.reason = "progress is limited by rounding";
    result.converged = true;
  } catch (const nlopt::forced_stop&) {
    result.reason = "evaluation limit reached";
  } catch (const std::runtime_error& error) {
    result.reason = std::string("NLopt: ") + error.what();
  }
  if (context.best.size() == 0) return;
  result.x = objective.unscaled(context.best);
  result.cost = context.best_cost;
}

}  // namespace brachium::optimise
