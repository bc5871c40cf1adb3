#include "fem/solve/predictor.hpp"

namespace brachium::fem {

bool predict(Equations& equations, TangentFactor& factor, const LoadPoint& from, const LoadPoint& to,
             Configuration& configuration, Eigen::MatrixXd& pressure) {
  constexpr double part = 1e-4;
  if (!factor.ready()) return false;
  Configuration here = configuration;
  const Evaluation now = equations.evaluate(here, from);
  LoadPoint on;
  on.amplitude = from.amplitude + part * (to.amplitude - from.amplitude);
  on.activation = from.activation + part * (to.activation - from.activation);
  on.released = from.released + part * (to.released - from.released);
  Configuration moved = configuration;
  equations.constraints().impose(on.amplitude, moved.dofs);
  Eigen::MatrixXd change;
  if (equations.condensed()) {
    const Eigen::MatrixXd volumetric = equations.volumetric_pressure(configuration);
    const Eigen::MatrixXd next = equations.volumetric_pressure(moved);
    change = (next - volumetric) / part;
    pressure = volumetric;
    if (configuration.multiplier.size() > 0) pressure += configuration.multiplier;
    moved.multiplier = pressure - next;
  }
  const Evaluation next = equations.evaluate(moved, on);
  if (!now.valid() || !next.valid()) return false;
  Eigen::VectorXd increment = -(next.residual - now.residual) / part;
  if (equations.condensed()) increment -= factor.coupling(equations, change);
  factor.solve(increment);
  if (!increment.allFinite()) return false;
  if (equations.condensed()) pressure += change + factor.pressure_change(equations, increment);
  configuration.dofs += equations.unknowns().extend(increment);
  equations.constraints().impose(to.amplitude, configuration.dofs);
  configuration.activation = to.activation;
  return true;
}

Eigen::VectorXd extrapolate(const Eigen::VectorXd& before, const Eigen::VectorXd& now,
                            const Eigen::VectorXd& first, double ratio) {
  // c h^2 = (u_(n-1) - u_n + Δu τ/h) (h/τ)^2
  return first + ratio * ratio * (before - now) + ratio * (first - now);
}

}  // namespace brachium::fem
