#pragma once
/// The factorised tangent: one analysis per set of unknowns, the last factor kept for predictors, chord
/// iterations and the count of negative modes.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/linear/symmetric_solver.hpp"
#include "fem/linear/unsymmetric_solver.hpp"
#include "fem/solve/equations.hpp"

namespace brachium::fem {

class TangentFactor {
 public:
  explicit TangentFactor(const SolveOptions& options);

  /// For the equations' present unknowns; forgets the factor.
  void analyse(const Equations& equations);

  /// Takes the tangent at a configuration and factorises it. Empty when it can be solved with; else why not,
  /// naming node and component.
  std::string make(Equations& equations, const Configuration& at, const LoadPoint& load);

  bool ready() const { return ready_; }
  void forget() { ready_ = false; }

  /// x := K^-1 x.
  void solve(Eigen::VectorXd& x) const;

  /// Negative eigenvalues of the tangent beyond those that the pressures of a saddle point bring; none where
  /// the solver does not tell.
  struct NegativeModes {
    long count = 0;
    std::string method;
  };
  std::optional<NegativeModes> negative_modes() const;

  /// Where the factor was made.
  const Configuration& configuration() const { return at_; }
  const Eigen::VectorXd& amplitude() const { return amplitude_; }
  // Condensed formulations: the matrix is K + B' U'' B with the change of volume B = Dθ where the factor was
  // made. A correction of the pressure must go through the same B, or the bulk modulus multiplies the
  // difference.
  /// B' (pressure), by unknown.
  Eigen::VectorXd coupling(Equations& equations, const Eigen::MatrixXd& pressure) const;
  /// U'' B (step by unknown): the change of pressure that the matrix connects with a step.
  Eigen::MatrixXd pressure_change(Equations& equations, const Eigen::VectorXd& step) const;

  /// What a new tangent and factor costs over a chord iteration (residual and back-substitution), by counted
  /// work.
  double cost_ratio() const { return cost_ratio_; }

  long factorisations = 0, analyses = 0;
  mutable long back_substitutions = 0;
  double factor_seconds = 0.0, analyse_seconds = 0.0;
  mutable double solve_seconds = 0.0;
  double nonzeros = 0.0, flops = 0.0;
  std::string method, ordering;

 private:
  std::string name_;
  SolverOptions options_;
  std::unique_ptr<SymmetricSolver> symmetric_;
  std::unique_ptr<UnsymmetricSolver> unsymmetric_;
  long constraint_unknowns_ = 0;
  double cost_ratio_ = 1.0, tangent_flops_ = 0.0, residual_flops_ = 0.0;
  bool ready_ = false;
  Configuration at_;
  Eigen::VectorXd amplitude_, internal_;
  Eigen::MatrixXd volumetric_;

  TangentValues tangent_;

  std::string factorise(const Equations& equations);
  std::string judge(const Equations& equations, const FactorStatus& status);
};

/// Lower triangle of the symmetric part of the whole tangent, loads included.
std::vector<double> symmetric_part(const Equations& equations, const TangentValues& tangent);

}  // namespace brachium::fem
