/// Levenberg-Marquardt on a box.
///
///     (J'J + lambda D) p = -J'r,   D = running maximum of diag(J'J)      (Moré 1978, doi:10.1007/BFb0067700)
///     lambda <- lambda max(1/3, 1 - (2 rho - 1)^3) after a success, lambda nu (nu = 2, 4, 8, ...) after a
///     failure
///                                                        (Nielsen 1999, report IMM-REP-1999-05, Technical
///                                                        University of Denmark; rho = actual / predicted
///                                                        decrease)
///
/// Bounds: parameters at a bound whose gradient points outward are held. A step that would leave the box is
/// stopped at the bounds it meets, and the other components are solved again with these displacements given.

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "optimise/objective.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Minimises 1/2 p'(A + lambda D)p + g'p over lower <= u + p <= upper, approximately: held components are
/// final.
VectorXd boxed_step(const MatrixXd& A, const VectorXd& D, double lambda, const VectorXd& g, const VectorXd& u,
                    const VectorXd& lower, const VectorXd& upper) {
  const Index n = u.size();
  VectorXd p = VectorXd::Zero(n);
  std::vector<bool> held(static_cast<std::size_t>(n), false);
  for (Index j = 0; j < n; ++j)
    held[static_cast<std::size_t>(j)] = (u[j] <= lower[j] && g[j] > 0.0) || (u[j] >= upper[j] && g[j] < 0.0);
  for (Index pass = 0; pass <= n; ++pass) {
    std::vector<Index> free;
    for (Index j = 0; j < n; ++j)
      if (!held[static_cast<std::size_t>(j)]) free.push_back(j);
    if (free.empty()) break;
    const Index k = static_cast<Index>(free.size());
    MatrixXd K(k, k);
    VectorXd rhs(k);
    for (Index a = 0; a < k; ++a) {
      const Index ja = free[static_cast<std::size_t>(a)];
      rhs[a] = -g[ja];
      for (Index j = 0; j < n; ++j)
        if (held[static_cast<std::size_t>(j)]) rhs[a] -= A(ja, j) * p[j];
      for (Index b = 0; b < k; ++b) K(a, b) = A(ja, free[static_cast<std::size_t>(b)]);
      K(a, a) += lambda * D[ja];
    }
    const VectorXd q = K.ldlt().solve(rhs);
    bool stopped = false;
    for (Index a = 0; a < k; ++a) {
      const Index j = free[static_cast<std::size_t>(a)];
      p[j] = q[a];
      if (!(u[j] + p[j] >= lower[j]))
        p[j] = lower[j] - u[j];
      else if (!(u[j] + p[j] <= upper[j]))
        p[j] = upper[j] - u[j];
      else
        continue;
      held[static_cast<std::size_t>(j)] = true;
      stopped = true;
    }
    if (!stopped) break;
  }
  return p;
}

}  // namespace

void run_levenberg_marquardt(Objective& objective, const SolveOptions& options, const Report& report,
                             StartResult& result) {
  const VectorXd &lower = objective.lower(), &upper = objective.upper();
  VectorXd u = objective.scaled(result.start), r, r_trial;
  MatrixXd J, J_trial;
  if (!objective.evaluate(u, r, &J)) {
    result.reason = "no value at the start: " + objective.failure();
    return;
  }
  double cost = 0.5 * r.squaredNorm(), lambda = 1e-3, nu = 2.0, step = 0.0;
  result.cost_start = cost;
  MatrixXd A = J.transpose() * J;
  VectorXd g = J.transpose() * r, D = VectorXd::Zero(u.size());
  const auto log = [&] {
    report({0, result.iterations, objective.evaluations(), cost, projected_gradient_norm(u, g, lower, upper),
            step, lambda});
  };
  log();
  constexpr int stall_iterations = 10;
  std::deque<double> costs;
  result.reason = "iteration limit reached";
  while (result.iterations < options.max_iterations && objective.evaluations() < options.max_evaluations) {
    if (cost <= 0.5e-26 * static_cast<double>(r.size())) {  // root mean square of the scaled residuals 1e-13
      result.converged = true;
      result.reason = "residuals at rounding";
      break;
    }
    D = D.cwiseMax(A.diagonal());
    const double floor = 1e-12 * std::max(D.maxCoeff(), 1e-300);
    const double gradient_scale =
        std::sqrt(2.0 * cost) * std::sqrt(std::max(A.diagonal().maxCoeff(), 1e-300));
    if (!(projected_gradient_norm(u, g, lower, upper) > options.gradient_tolerance * gradient_scale)) {
      result.converged = true;
      result.reason = "gradient below tolerance";
      break;
    }
    const VectorXd p = boxed_step(A, D.cwiseMax(floor), lambda, g, u, lower, upper);
    const double predicted = -(g.dot(p) + 0.5 * p.dot(A * p));
    step = p.lpNorm<Eigen::Infinity>();
    if (!(step > options.step_tolerance)) {
      result.converged = true;
      result.reason = "step below tolerance";
      break;
    }
    costs.push_back(cost);
    if (costs.size() > stall_iterations) {
      if (costs.front() - cost <= options.stall_tolerance * cost) {
        result.converged = true;
        result.reason = "no further decrease";
        break;
      }
      costs.pop_front();
    }
    ++result.iterations;
    const VectorXd trial = (u + p).cwiseMax(lower).cwiseMin(upper);
    const bool valued = predicted > 0.0 && objective.evaluate(trial, r_trial, &J_trial);
    const double cost_trial = valued ? 0.5 * r_trial.squaredNorm() : HUGE_VAL;
    const double rho = valued ? (cost - cost_trial) / predicted : -1.0;
    if (!(rho > 1e-4)) {
      if (valued && predicted <= options.cost_tolerance * cost) {  // what is left to gain is below rounding
        result.converged = true;
        result.reason = "predicted decrease below tolerance";
        break;
      }
      lambda = std::max(lambda, 1e-12) * nu;
      nu *= 2.0;
      if (!(lambda < 1e30)) {
        result.reason = "no step lowers the cost";
        break;
      }
      continue;
    }
    const double decrease = (cost - cost_trial) / std::max(cost, 1e-300);
    u = trial;
    r.swap(r_trial);
    J.swap(J_trial);
    cost = cost_trial;
    A.noalias() = J.transpose() * J;
    g.noalias() = J.transpose() * r;
    lambda *= std::max(1.0 / 3.0, 1.0 - std::pow(2.0 * rho - 1.0, 3));
    if (rho > 0.9) lambda *= 0.1;  // nearly linear: let the Gauss-Newton step through
    nu = 2.0;
    log();
    if (decrease < options.cost_tolerance) {
      result.converged = true;
      result.reason = "relative decrease below tolerance";
      break;
    }
  }
  result.x = objective.unscaled(u);
  result.cost = cost;
}

}  // namespace brachium::optimise
