#pragma once
/// Is a Jacobian the derivative of its residuals? Compares it with Ridders' extrapolated central differences.

#include <string>
#include <vector>

#include "optimise/problem.hpp"

namespace brachium::optimise {

struct DerivativeCheckOptions {
  double relative_tolerance = 1e-6;  ///< of |J_ij| and of the largest entry of column j times floor_fraction
  double floor_fraction =
      1e-3;                    ///< entries below this fraction of their column's largest are compared with it
  double initial_step = 1e-2;  ///< first difference step, as a fraction of the parameter's scale
  bool respect_bounds = true;  ///< steps that would leave the bounds are made smaller
};

/// One entry that does not agree.
struct DerivativeMismatch {
  std::string parameter;  ///< label of the parameter
  std::string residual;   ///< name of the residual
  std::size_t row = 0, column = 0;
  double analytic = 0.0, numeric = 0.0;
  double numeric_error = 0.0;  ///< Ridders' own estimate of the error of `numeric`
  double relative_error = 0.0;
};

struct DerivativeCheck {
  bool passed = false;
  double worst_relative_error = 0.0;
  std::vector<DerivativeMismatch> worst;  ///< the worst entry of every parameter that fails, worst first
  std::string text() const;  ///< for a log: "passed (worst 3e-9)" or one line per failing parameter
};

/// Checks all columns at x. Entries whose numeric estimate is itself uncertain by more than the tolerance are
/// judged against that uncertainty (Ridders 1982, doi:10.1016/S0141-1195(82)80057-0). Throws data::InputError
/// if x is outside the bounds.
DerivativeCheck check_derivatives(const LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                                  const DerivativeCheckOptions& options = {});

}  // namespace brachium::optimise
