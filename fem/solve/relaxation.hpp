#pragma once
/// Viscous continuation: from where Newton is lost, or from an unstable equilibrium, down to a stable one at
/// the same loads. The body flows in a pseudo-time with the stress S + 2 η dE/dt (backward Euler),
///   R(u) + f_viscous(u, (u - u_k)/Δt) = 0,
/// a gradient flow: it has the equilibria of the body itself, and its energy falls. Steps grow while the
/// flow's tangent is positive definite (then each step is a minimum of energy plus dissipation), shrink where
/// it is not. At rest Newton without viscosity ends it, so that the state reached holds nothing of η; what is
/// reported is the number of steps and the energy dissipated on the way,  Σ_k f_viscous . (u_(k+1) - u_k).
///
/// η = (stiffness of the problem) x 1 s; only η/Δt enters.

#include <string>

#include "fem/solve/newton.hpp"

namespace brachium::fem {

struct Relaxation {
  bool reached = false;
  std::string reason;  ///< why not
  int steps = 0;
  double dissipated_energy = 0.0;  ///< J
  int newton = 0, chord = 0, augmentations = 0;
  Stability stability;
  Evaluation last;  ///< at the state reached
};

class Relaxer {
 public:
  Relaxer(Equations& equations, TangentFactor& factor, const SolveOptions& options)
      : equations_(equations), factor_(factor), options_(options) {}

  /// `configuration`: an equilibrium (stable or not) at `from`. Leaves it at a stable equilibrium at `to`, or
  /// untouched. `disturb`: leave an unstable equilibrium along a negative mode, by 1 % of a cell's size.
  Relaxation run(Configuration& configuration, const LoadPoint& from, const LoadPoint& to, bool disturb,
                 int step, std::vector<IterationRecord>& records);

 private:
  Equations& equations_;
  TangentFactor& factor_;
  const SolveOptions& options_;

  bool disturb(Configuration& configuration, const LoadPoint& load);
  /// A first guess at `to`, moved through a body that the viscosity makes stiff.
  bool move_held(Configuration& configuration, const LoadPoint& from, const LoadPoint& to, double inverse_dt);
};

}  // namespace brachium::fem
