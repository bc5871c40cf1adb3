#pragma once
/// How an accepted equilibrium moves with its loads, from the factor at hand.
///
///   R(u(s), p(s)) = 0,    K v = -dR/ds,    x <- x - K_0^-1 dR/ds(x)
///
/// | symbol   | meaning                                                                                   |
/// |----------|-------------------------------------------------------------------------------------------|
/// | p(s)     | amplitudes and activations, moving at given rates                                         |
/// | dR/ds(x) | residual's slope along held motion and unknowns x, by central differences of the residual |
/// | K_0      | tangent last factorised; where it is of this state one back-substitution is enough        |
///
/// Differences are taken over 1e-5 of a cell's size: their error is about 1e-7 of the slope (condition times
/// rounding). Pressures that are multipliers (infinite bulk modulus, contact to a tolerance) follow in the
/// same iteration. Where contacts have them it is accelerated, and ends at corrections of 1e-4 of the slope: a
/// contact has more points than its faces have freedoms, so that parts of the points' pressures move nothing and
/// settle slowly, and the state itself is known to the contact's tolerance only.

#include <map>
#include <string>

#include "fem/solve/equations.hpp"
#include "fem/solve/tangent_factor.hpp"

namespace brachium::fem {

/// Rates by name; what is not named rests.
struct LoadRate {
  std::map<std::string, double> amplitude;   ///< by boundary condition
  std::map<std::string, double> activation;  ///< by region
};

struct StateRate {
  Eigen::VectorXd dofs;                            ///< by dof
  Eigen::VectorXd internal_force, external_force;  ///< by dof, global axes
  int iterations = 0;                              ///< back-substitutions
  double left = 0.0;                               ///< last correction over the rate: what is left open
};

class Sensitivity {
 public:
  Sensitivity(Equations& equations, TangentFactor& factor, const Configuration& at, const LoadPoint& load)
      : equations_(equations), factor_(factor), at_(at), load_(load) {}

  /// Throws InputError("unknown-condition") and ("unknown-region"); ConvergenceFailure where the state is too
  /// near a limit point.
  StateRate along(const LoadRate& rate);

 private:
  struct Direction {
    LoadPoint load;
    Eigen::VectorXd dofs, contact;
    Eigen::MatrixXd multiplier;
  };
  Equations& equations_;
  TangentFactor& factor_;
  const Configuration& at_;
  const LoadPoint& load_;

  LoadPoint direction_of(const LoadRate& rate) const;
  Eigen::VectorXd held_rate(const LoadPoint& load) const;
  double largest_penalty() const;  ///< of the contacts [Pa/m]
  double part_of(const Eigen::VectorXd& dofs) const;
  Configuration moved(const Direction& d, double part, LoadPoint& load) const;
  template <class F>
  auto slope(const Direction& d, F&& f) const;
};

}  // namespace brachium::fem
