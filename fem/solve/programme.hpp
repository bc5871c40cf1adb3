#pragma once
/// Amplitudes and activations along the phases of a problem.

#include <Eigen/Core>

#include "fem/solve/problem.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::fem {

/// All that drives the body at one time.
struct LoadPoint {
  Eigen::VectorXd amplitude;   ///< by condition
  Eigen::VectorXd activation;  ///< by region
  double released = 0.0;       ///< part of the released reactions that still acts, 1 to 0
};

class Programme {
 public:
  explicit Programme(const Problem& problem) : problem_(&problem) {}

  /// State before the first phase: unloaded, inactive; `dof_count` zeros.
  SolveState start(int dof_count) const;

  /// Amplitudes and activations at `time` in [0, 1] of the state's phase.
  LoadPoint at(const SolveState& state, double time) const;

  /// Moves the state's amplitudes to `time` of its phase.
  void advance(SolveState& state, double time) const;

  /// Makes the next phase the one in progress.
  void next_phase(SolveState& state) const;

 private:
  const Problem* problem_;
};

}  // namespace brachium::fem
