#include "fem/linear/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace brachium::fem {

namespace {

// r = b - A x and the backward error of x, in one pass over the matrix.
double residual(const SymmetricMatrixView& matrix, std::span<const double> b, std::span<const double> x,
                std::vector<double>& r, std::vector<double>& size) {
  const SymmetricPattern& p = *matrix.pattern;
  std::copy(b.begin(), b.end(), r.begin());
  std::transform(b.begin(), b.end(), size.begin(), [](double v) { return std::abs(v); });
  for (int j = 0; j < p.n; ++j) {
    for (int e = p.column_start[j]; e < p.column_start[j + 1]; ++e) {
      const int i = p.row[e];
      const double a = matrix.values[e];
      r[i] -= a * x[j];
      size[i] += std::abs(a * x[j]);
      if (i == j) continue;
      r[j] -= a * x[i];
      size[j] += std::abs(a * x[i]);
    }
  }
  double error = 0.0;
  for (int i = 0; i < p.n; ++i) {
    if (r[i] != 0.0) error = std::max(error, std::abs(r[i]) / size[i]);
  }
  return error;
}

}  // namespace

Refinement solve_refined(const SymmetricSolver& solver, const SymmetricMatrixView& matrix,
                         std::span<const double> b, std::span<double> x, double tolerance, int max_steps) {
  const auto n = static_cast<std::size_t>(matrix.pattern->n);
  check_size("the right-hand side", b.size(), n);
  check_size("the solution", x.size(), n);
  std::vector<double> r(n), size(n), trial(n);
  std::copy(b.begin(), b.end(), x.begin());
  solver.solve(x);
  Refinement result;
  result.backward_error = residual(matrix, b, x, r, size);
  while (result.steps < max_steps && result.backward_error > tolerance) {
    solver.solve(r);
    for (std::size_t i = 0; i < n; ++i) trial[i] = x[i] + r[i];
    const double error = residual(matrix, b, trial, r, size);
    if (!(error < result.backward_error)) break;
    const bool slow = error > 0.5 * result.backward_error;
    std::copy(trial.begin(), trial.end(), x.begin());
    result.backward_error = error;
    ++result.steps;
    if (slow) break;
  }
  return result;
}

}  // namespace brachium::fem
