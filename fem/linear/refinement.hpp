#pragma once
/// Iterative refinement: a few cheap steps win back what growth in a factor has cost.

#include <span>

#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

struct Refinement {
  int steps = 0;
  /// max_i |b - A x|_i / (|A| |x| + |b|)_i: x solves a system whose entries differ by this, relatively
  /// (Oettli & Prager 1964, doi:10.1007/BF01386090).
  double backward_error = 0.0;
};

/// Solves A x = b with a solver that has factorised A (or a matrix near it) and refines until the backward
/// error is below `tolerance`, no longer halves, or `max_steps` are done. InputError("linear-size").
Refinement solve_refined(const SymmetricSolver& solver, const SymmetricMatrixView& matrix,
                         std::span<const double> b, std::span<double> x, double tolerance = 1e-15,
                         int max_steps = 5);

}  // namespace brachium::fem
