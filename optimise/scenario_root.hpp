#pragma once
/// Internal: Newton's method that never leaves a bracket.

#include <functional>
#include <vector>

#include "optimise/scenario.hpp"

namespace brachium::optimise {

struct RootPoint {
  double moment = 0.0, slope = 0.0, tolerance = 0.0;
};
using RootFunction = std::function<RootPoint(double)>;

struct Root {
  double at = 0.0;
  RootPoint point;
  std::vector<ConvergenceRow> history;
};

/// A root between a and b, where `f` has different signs (fa, fb), from `start` (the middle if it is not
/// between them). Throws ConvergenceFailure where |M| does not come below the tolerance.
Root root_between(const RootFunction& f, double a, double b, double fa, double start,
                  const ScenarioOptions& options);

/// f at an angle of the system.
RootFunction moment_of_angle(const StaticSystem& system, const Eigen::VectorXd& activation, double load_N,
                             const ScenarioOptions& options);

/// An equilibrium with its derivatives, at an angle that is one.
EquilibriumAngle describe_equilibrium(const StaticSystem& system, double angle_rad,
                                      const Eigen::VectorXd& activation, double load_N,
                                      std::vector<ConvergenceRow> history);

}  // namespace brachium::optimise
