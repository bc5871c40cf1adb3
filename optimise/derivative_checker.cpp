#include "optimise/derivative_checker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kRows = 8;         // of Ridders' tableau
constexpr double kShrink = 1.6;  // step ratio from row to row

struct NumericColumn {
  VectorXd value, error;
};

/// Ridders' tableau of central differences, each residual keeping the entry with the smallest error estimate.
NumericColumn numeric_column(Evaluator& evaluator, const VectorXd& x, Index j, double h, Index m) {
  NumericColumn out{VectorXd::Zero(m), VectorXd::Constant(m, HUGE_VAL)};
  std::array<std::array<VectorXd, kRows>, kRows> tableau;
  VectorXd plus, minus;
  for (int row = 0; row < kRows; ++row, h /= kShrink) {
    VectorXd xp = x, xm = x;
    xp[j] += h;
    xm[j] -= h;
    evaluator.evaluate(xp, plus, nullptr);
    evaluator.evaluate(xm, minus, nullptr);
    tableau[0][static_cast<std::size_t>(row)] = (plus - minus) / (xp[j] - xm[j]);
    double factor = kShrink * kShrink;
    for (int level = 1; level <= row; ++level, factor *= kShrink * kShrink) {
      const auto l = static_cast<std::size_t>(level), r = static_cast<std::size_t>(row);
      const VectorXd& coarse = tableau[l - 1][r - 1];
      const VectorXd& fine = tableau[l - 1][r];
      tableau[l][r] = (fine * factor - coarse) / (factor - 1.0);
      const VectorXd error = (tableau[l][r] - fine).cwiseAbs().cwiseMax((tableau[l][r] - coarse).cwiseAbs());
      for (Index i = 0; i < m; ++i) {
        if (error[i] <= out.error[i]) {
          out.error[i] = error[i];
          out.value[i] = tableau[l][r][i];
        }
      }
    }
  }
  return out;
}

}  // namespace

DerivativeCheck check_derivatives(const LeastSquaresProblem& problem, const VectorXd& x,
                                  const DerivativeCheckOptions& options) {
  const auto& parameters = problem.parameters();
  const VectorXd lower = lower_of(parameters), upper = upper_of(parameters);
  if (x.size() != lower.size() || !((x - lower).minCoeff() >= 0.0) || !((upper - x).minCoeff() >= 0.0))
    throw data::InputError("out-of-range",
                           "derivatives are to be checked at a point outside the parameters' bounds");
  const auto m = static_cast<Index>(problem.residual_count());
  const auto evaluator = problem.evaluator();
  VectorXd r;
  Eigen::MatrixXd J;
  evaluator->evaluate(x, r, &J);
  if (J.rows() != m || J.cols() != x.size())
    throw data::InputError("wrong-size", fmt::format("the Jacobian is {} x {}, it should be {} x {}",
                                                     J.rows(), J.cols(), m, x.size()));

  DerivativeCheck check;
  check.passed = true;
  for (Index j = 0; j < x.size(); ++j) {
    double h = options.initial_step * parameters[static_cast<std::size_t>(j)].scale;
    if (options.respect_bounds) h = std::min({h, x[j] - lower[j], upper[j] - x[j]});
    if (!(h > 0.0))
      throw data::InputError(
          "out-of-range",
          fmt::format("parameter `{}` lies on its bound: no two-sided difference can be taken",
                      parameters[static_cast<std::size_t>(j)].label()),
          "check at a point inside the bounds");
    const NumericColumn numeric = numeric_column(*evaluator, x, j, h, m);
    const double floor = options.floor_fraction * std::max(J.col(j).lpNorm<Eigen::Infinity>(),
                                                           numeric.value.lpNorm<Eigen::Infinity>());
    DerivativeMismatch worst;
    for (Index i = 0; i < m; ++i) {
      const double size = std::max({std::abs(J(i, j)), std::abs(numeric.value[i]), floor, 1e-300});
      const double difference = std::max(0.0, std::abs(J(i, j) - numeric.value[i]) - 2.0 * numeric.error[i]);
      const double relative = difference / size;
      check.worst_relative_error = std::max(check.worst_relative_error, relative);
      if (!(relative <= worst.relative_error) || i == 0) {
        worst = {parameters[static_cast<std::size_t>(j)].label(),
                 problem.residual_name(static_cast<std::size_t>(i)),
                 static_cast<std::size_t>(i),
                 static_cast<std::size_t>(j),
                 J(i, j),
                 numeric.value[i],
                 numeric.error[i],
                 relative};
      }
    }
    if (!(worst.relative_error <= options.relative_tolerance)) {
      check.passed = false;
      check.worst.push_back(worst);
    }
  }
  std::stable_sort(check.worst.begin(), check.worst.end(),
                   [](const auto& a, const auto& b) { return a.relative_error > b.relative_error; });
  return check;
}

std::string DerivativeCheck::text() const {
  if (passed) return fmt::format("passed (worst {:.1e})", worst_relative_error);
  std::string out;
  for (const DerivativeMismatch& w : worst)
    out += fmt::format(
        "wrong derivative: `{}` at {}: analytic {:.9g}, numeric {:.9g} (+-{:.1g}), relative error {:.2g}\n",
        w.parameter, w.residual, w.analytic, w.numeric, w.numeric_error, w.relative_error);
  return out;
}

}  // namespace brachium::optimise
