#pragma once
/// LU of a matrix whose pattern is symmetric and whose values are not: tangents with follower pressure.

#include <memory>
#include <span>

#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

/// Values by entries of the full pattern (`expand`): column by column, rows ascending.
class UnsymmetricSolver {
 public:
  explicit UnsymmetricSolver(const SolverOptions& options = {});
  ~UnsymmetricSolver();
  UnsymmetricSolver(UnsymmetricSolver&&) noexcept;
  UnsymmetricSolver& operator=(UnsymmetricSolver&&) noexcept;

  /// InputError("linear-pattern")
  void analyse(const SymmetricPattern& pattern);

  /// The pattern that `factorise` takes its values by.
  const FullPattern& pattern() const;

  /// Errors as SymmetricSolver::factorise. The kind is regular or singular.
  FactorStatus factorise(std::span<const double> values);

  /// x := A^-1 x, one step of iterative refinement included. Errors as SymmetricSolver::solve.
  void solve(std::span<double> x, int columns = 1) const;

  SolverStatistics statistics() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace brachium::fem
