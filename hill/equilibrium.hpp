#pragma once
/// Static equilibrium of tendon and fibres: the root z of
///
///   R(z) = f_t((L - z)/l_s - 1) - Q(z, α z + β, a)
///
/// The fibre's rate is linear in the unknown, w = α z + β: α = 0 for a given rate, else a backward
/// difference. Guaranteed bracket: R > 0 at the shortest fibre unless the path is slack, and R <= 0 at max(L
/// - l_s, -β/α): there the tendon carries nothing (a tendon cannot push: f_t = 0 below slack length) and the
/// fibre does not shorten, so that Q >= 0. With α = 0 and fast shortening the fibres may push even there;
/// then nothing is carried. Newton's method, safeguarded by bisection of the bracket.

#include <algorithm>
#include <cmath>

#include "hill/element.hpp"

namespace brachium::hill {

template <class Set>
inline data::CurveValue taut_tendon(const Set& set, double strain) {
  if (strain <= 0.0) return {0.0, 0.0};
  return set.tendon(strain);
}

struct Equilibrium {
  enum class Kind {
    root,    ///< R(z) = 0
    untaut,  ///< z = L - l_s, nothing is carried
    slack,   ///< no fibre is short enough: z = z_min
    unconverged
  };
  Kind kind = Kind::root;
  double z = 0.0;
  double tendon = 0.0;  ///< f_t
  Projected fibres{};   ///< at the last iterate but `step`
  double step = 0.0;    ///< z - last iterate, below the tolerance
  int evaluations = 0;
};

struct EquilibriumProblem {
  double L, a, alpha, beta;
};

template <class Set>
class EquilibriumSolver {
 public:
  EquilibriumSolver(const Set& set, const ElementConstants& constants) : set_(set), k_(constants) {}

  Equilibrium solve(const EquilibriumProblem& p, double guess) const {
    Equilibrium e;
    const double taut = p.L - k_.ls;
    if (!(taut > k_.z_min)) return slack();
    double lower = k_.z_min;
    double upper = p.alpha > 0.0 && k_.with_velocity ? std::max(taut, -p.beta / p.alpha) : taut;
    // Fibres that carry nothing at the taut tendon: the root is there, where Newton would only creep.
    if (p.a == 0.0 && carried(p, taut) == 0.0) return untaut(taut);
    bool lower_checked = false, upper_checked = false;
    double z = guess > lower && guess < upper ? guess : std::max(0.5 * (lower + upper), upper - 0.02 * k_.ls);
    for (e.evaluations = 1; e.evaluations < kMaxEvaluations; ++e.evaluations) {
      const data::CurveValue t = taut_tendon(set_, strain(p, z));
      const Projected q = project(set_, k_, z, p.alpha * z + p.beta, p.a);
      const double residual = t.value - q.Q;
      const double slope = t.slope * k_.per_ls + q.Q_z + p.alpha * q.Q_w;  // -dR/dz
      (residual > 0.0 ? lower : upper) = z;
      const double step = residual / slope;
      if (slope > 0.0 && std::abs(step) <= kStepTolerance * k_.lo &&
          std::abs(residual) <= kResidualTolerance) {
        // What remains is of the order of step squared, below rounding: f_t and l follow by one term of
        // Taylor's series.
        e.z = z + step;
        e.tendon = t.value - t.slope * k_.per_ls * step;
        e.step = step;
        e.fibres = q;
        return e;
      }
      double next = z + step;
      // Late in the search every other step halves the bracket: Newton alone creeps down a steep exponential.
      const bool halve = e.evaluations > 8 && e.evaluations % 2 == 1;
      if (halve || !(slope > 0.0 && next > lower && next < upper)) {
        if (lower == k_.z_min && !lower_checked) {
          lower_checked = true;
          if (!(residual_at(p, lower) > 0.0)) return slack();
        }
        if (upper == taut && !upper_checked) {
          upper_checked = true;
          if (!(residual_at(p, upper) <= 0.0)) return untaut(taut);
        }
        next = 0.5 * (lower + upper);
        if (next == lower || next == upper) {  // the bracket is as narrow as numbers are
          e.z = z;
          e.tendon = t.value;
          e.fibres = q;
          return e;
        }
      }
      z = next;
    }
    e.kind = Equilibrium::Kind::unconverged;
    e.z = z;
    return e;
  }

 private:
  static constexpr int kMaxEvaluations = 200;
  static constexpr double kStepTolerance = 1e-8;  // in optimal fibre lengths
  static constexpr double kResidualTolerance =
      1e-4;  // in F0; a small step from a large residual is no convergence

  Equilibrium slack() const {
    Equilibrium e;
    e.kind = Equilibrium::Kind::slack;
    e.z = k_.z_min;
    return e;
  }
  static Equilibrium untaut(double taut) {
    Equilibrium e;
    e.kind = Equilibrium::Kind::untaut;
    e.z = taut;
    return e;
  }
  double strain(const EquilibriumProblem& p, double z) const { return (p.L - z) * k_.per_ls - 1.0; }
  double carried(const EquilibriumProblem& p, double z) const {
    return project(set_, k_, z, p.alpha * z + p.beta, p.a).Q;
  }
  double residual_at(const EquilibriumProblem& p, double z) const {
    return taut_tendon(set_, strain(p, z)).value - carried(p, z);
  }

  const Set& set_;
  const ElementConstants& k_;
};

}  // namespace brachium::hill
