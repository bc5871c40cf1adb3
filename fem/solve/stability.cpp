#include "fem/solve/stability.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cmath>

namespace brachium::fem {
namespace {

/// Largest move of a node between two configurations, over the cells' size; infinite where anything else
/// differs.
double distance(const Equations& equations, const Configuration& a, const Configuration& b) {
  if (a.dofs.size() != b.dofs.size() || a.viscosity_pa_s != b.viscosity_pa_s ||
      a.inverse_dt != b.inverse_dt || a.activation != b.activation ||
      a.dofs_before.size() != b.dofs_before.size() || a.dofs_before != b.dofs_before) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::Index displacements = 3 * static_cast<Eigen::Index>(equations.discretisation().node_count());
  return (a.dofs - b.dofs).head(displacements).cwiseAbs().maxCoeff() / equations.cell_size_m();
}

Stability judged(const TangentFactor::NegativeModes& modes, const std::string& where) {
  return {modes.count > 0 ? "unstable" : "stable", modes.count, modes.method + ", " + where};
}

}  // namespace

Stability check_stability(Equations& equations, TangentFactor& factor, const SolveOptions& options,
                          Configuration& configuration, const LoadPoint& load) {
  if (equations.unsymmetric()) {
    // A factor of its own: the symmetric part.
    TangentValues tangent;
    if (!equations.linearise(configuration, load, tangent).valid())
      return {"not checked", 0, "the tangent is not finite"};
    SolverOptions solver_options;
    solver_options.fall_back = false;
    const auto solver = make_symmetric_solver("ldl", solver_options);
    solver->analyse(equations.unknowns().pattern, equations.unknowns().groups);
    const std::vector<double> symmetric = symmetric_part(equations, tangent);
    const FactorStatus status = solver->factorise(symmetric);
    const auto inertia = solver->inertia();
    if (status.kind == FactorKind::positive_definite && !equations.saddle_point()) {
      return {"stable", 0, "symmetric part of an unsymmetric tangent is positive definite (LDL')"};
    }
    return {
        "not checked", 0,
        fmt::format(
            "the tangent is unsymmetric and its symmetric part has {} negative modes, which does not decide",
            inertia ? std::to_string(inertia->negative) : std::string("uncounted"))};
  }
  const double away = factor.ready() && factor.amplitude() == load.amplitude
                          ? distance(equations, factor.configuration(), configuration)
                          : std::numeric_limits<double>::infinity();
  if (away <= 1e-3) {
    if (const auto modes = factor.negative_modes()) {
      return judged(*modes, away == 0.0
                                ? "at the state"
                                : fmt::format("tangent {:.1e} of a cell's size before the state", away));
    }
  }
  if (const std::string trouble = factor.make(equations, configuration, load); !trouble.empty()) {
    return {"unstable", 0, trouble + ": a neutral mode"};
  }
  if (const auto modes = factor.negative_modes()) return judged(*modes, "at the state");
  return {"not checked", 0, fmt::format("`{}` does not count negative modes", options.linear_solver)};
}

std::optional<Eigen::VectorXd> negative_mode(const Equations& equations, const TangentFactor& factor) {
  constexpr Eigen::Index block = 8;
  constexpr int sweeps = 6;
  const Eigen::Index n = equations.unknowns().count();
  if (n < 2 * block) return std::nullopt;
  Eigen::MatrixXd V(n, block);
  for (Eigen::Index j = 0; j < block; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) {
      V(i, j) =
          std::sin(0.37 + 12.9898 * static_cast<double>(i) + 78.233 * static_cast<double>(j * (i % 17)));
    }
  }
  std::optional<Eigen::VectorXd> mode;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (Eigen::Index j = 0; j < block; ++j) {
      Eigen::VectorXd x = V.col(j);
      factor.solve(x);
      V.col(j) = x / x.norm();
    }
    V = Eigen::HouseholderQR<Eigen::MatrixXd>(V).householderQ() * Eigen::MatrixXd::Identity(n, block);
    Eigen::MatrixXd KV(n, block);
    for (Eigen::Index j = 0; j < block; ++j) KV.col(j) = factor.multiply(equations, V.col(j));
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> ritz(V.transpose() * KV);
    if (ritz.eigenvalues()[0] < 0.0) mode = V * ritz.eigenvectors().col(0);
    if (mode && sweep >= 2) break;
  }
  if (!mode) return std::nullopt;
  Eigen::Index largest = 0;
  mode->cwiseAbs().maxCoeff(&largest);
  *mode /= (*mode)[largest];
  return mode;
}

}  // namespace brachium::fem
