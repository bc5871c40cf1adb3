#include "fem/solve/stability.hpp"

#include <fmt/format.h>

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

}  // namespace brachium::fem
