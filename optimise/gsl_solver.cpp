/// GSL's multifit_nlinear (trust region, Levenberg-Marquardt with Moré scaling) on an unbounded problem made
/// by
///     x = mid + half sin(z)                                   (James & Roos 1975,
///     doi:10.1016/0010-4655(75)90039-9)
/// A solution on a bound is approached with dx/dz -> 0, so it is found, but more slowly than by projection.

#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "optimise/objective.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Context {
  Objective* objective;
  VectorXd mid, half;
  VectorXd r;
  Eigen::MatrixXd J;

  VectorXd u(const gsl_vector* z) const {
    VectorXd out(mid.size());
    for (Index j = 0; j < out.size(); ++j)
      out[j] = mid[j] + half[j] * std::sin(gsl_vector_get(z, static_cast<std::size_t>(j)));
    return out;
  }
};

int residuals(const gsl_vector* z, void* data, gsl_vector* f) {
  auto& context = *static_cast<Context*>(data);
  if (!context.objective->evaluate(context.u(z), context.r, nullptr)) return GSL_EDOM;
  for (Index i = 0; i < context.r.size(); ++i) gsl_vector_set(f, static_cast<std::size_t>(i), context.r[i]);
  return GSL_SUCCESS;
}

int jacobian(const gsl_vector* z, void* data, gsl_matrix* df) {
  auto& context = *static_cast<Context*>(data);
  if (!context.objective->evaluate(context.u(z), context.r, &context.J)) return GSL_EDOM;
  for (Index j = 0; j < context.J.cols(); ++j) {
    const double slope = context.half[j] * std::cos(gsl_vector_get(z, static_cast<std::size_t>(j)));
    for (Index i = 0; i < context.J.rows(); ++i)
      gsl_matrix_set(df, static_cast<std::size_t>(i), static_cast<std::size_t>(j), context.J(i, j) * slope);
  }
  return GSL_SUCCESS;
}

}  // namespace

void run_gsl(Objective& objective, const SolveOptions& options, const Report& report, StartResult& result) {
  static std::once_flag once;
  std::call_once(once,
                 [] { gsl_set_error_handler_off(); });  // a library must not abort; status codes are checked

  Context context{&objective,
                  0.5 * (objective.lower() + objective.upper()),
                  0.5 * (objective.upper() - objective.lower()),
                  {},
                  {}};
  const VectorXd start = objective.scaled(result.start);
  const std::size_t n = static_cast<std::size_t>(objective.size()),
                    m = static_cast<std::size_t>(objective.rows());
  VectorXd r;
  if (!objective.evaluate(start, r, nullptr)) {
    result.reason = "no value at the start: " + objective.failure();
    return;
  }
  result.cost_start = 0.5 * r.squaredNorm();
  if (m < n) {
    result.reason = "fewer residuals than parameters";
    return;
  }
  gsl_vector* z = gsl_vector_alloc(n);
  for (std::size_t j = 0; j < n; ++j) {
    const auto i = static_cast<Index>(j);
    // On the bound itself the transform has no slope: start a little inside.
    const double s = std::clamp((start[i] - context.mid[i]) / context.half[i], -0.999, 0.999);
    gsl_vector_set(z, j, std::asin(s));
  }
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  parameters.trs = gsl_multifit_nlinear_trs_lm;
  gsl_multifit_nlinear_workspace* work =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, m, n);
  gsl_multifit_nlinear_fdf fdf{residuals, jacobian, nullptr, m, n, &context, 0, 0, 0};
  int status = gsl_multifit_nlinear_init(z, &fdf, work);
  double cost = result.cost_start;
  int info = 0;
  result.reason = "iteration limit reached";
  while (status == GSL_SUCCESS && result.iterations < options.max_iterations) {
    status = gsl_multifit_nlinear_iterate(work);
    ++result.iterations;
    double sum = 0.0, gradient = 0.0, step = 0.0;
    const gsl_vector* f = gsl_multifit_nlinear_residual(work);
    for (std::size_t i = 0; i < m; ++i) sum += gsl_vector_get(f, i) * gsl_vector_get(f, i);
    for (std::size_t j = 0; j < n; ++j) {
      gradient = std::max(gradient, std::abs(gsl_vector_get(work->g, j)));
      step = std::max(step, std::abs(gsl_vector_get(work->dx, j)));
    }
    const double decrease = (cost - 0.5 * sum) / std::max(cost, 1e-300);
    cost = 0.5 * sum;
    report({0, result.iterations, objective.evaluations(), cost, gradient, step, 0.0});
    if (status != GSL_SUCCESS) break;
    if (gsl_multifit_nlinear_test(options.step_tolerance, options.gradient_tolerance, 0.0, &info, work) ==
        GSL_SUCCESS) {
      result.converged = true;
      result.reason = info == 1 ? "step below tolerance" : "gradient below tolerance";
      break;
    }
    if (decrease >= 0.0 && decrease < options.cost_tolerance) {
      result.converged = true;
      result.reason = "relative decrease below tolerance";
      break;
    }
  }
  if (status == GSL_ENOPROG) {  // no step lowers the cost any more: at rounding, that is the solution
    result.converged = true;
    result.reason = "no step lowers the cost";
  } else if (status != GSL_SUCCESS) {
    result.reason = std::string("GSL: ") + gsl_strerror(status);
    if (objective.failures() > 0) result.reason += ", " + objective.failure();
  }
  result.cost = cost;
  result.x = objective.unscaled(context.u(gsl_multifit_nlinear_position(work)));
  gsl_multifit_nlinear_free(work);
  gsl_vector_free(z);
}

}  // namespace brachium::optimise
