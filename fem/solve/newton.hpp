#pragma once
/// Newton's method at one load point, with chord iterations (an old factor) where they are cheaper.
///
/// Measure of progress. With K a factor (of this or an earlier point) and d = -K^-1 R(u) the correction it
/// asks for, the natural monotonicity test compares d before and after a step under one and the same factor
/// (Deuflhard 2011, doi:10.1007/978-3-642-23899-4, section 3.3): Θ = |d(u + λ d)|/|d(u)|. Residuals are no
/// measure on the way: a nearly incompressible body multiplies the least error of volume by its bulk modulus.
///
/// Kind of iteration. A chord iteration costs a residual and a back-substitution, a Newton iteration r times
/// that (TangentFactor::cost_ratio). At the contraction Θ of the present factor, n = log(tolerance/|R|)/log Θ
/// iterations are left; a new factor about halves that number. The factor is kept while Θ < 0.7 and n <= 2 r.
/// Where multipliers set the pace (augmented Lagrange) a new factor changes nothing: it is kept while Θ < 0.7
/// is what the last new factor has reached.
///
/// Damping. A step with a new factor is taken whole where Θ <= 3/4; else λ is the damping that the last trial
/// proposes, λ' = λ^2 |d| / (2 |d(u + λ d) - (1 - λ) d|) within [λ/10, λ/2], until Θ <= 1 - λ/4.
///
/// Pressure of condensed formulations. Newton's method for displacements and pressures together keeps the
/// pressure p of a cell as an unknown beside u. With R(u, p) the residual at that pressure, and at the place
/// of the factor B = Dθ and the matrix K + B' U'' B of the condensed system,
///   Δp = U'(θ(u)) + m - p,   d = -(K + B' U'' B)^-1 (R + B' Δp),   p <- p + λ (Δp + U'' B d).
/// The multiplier m is 0 where the bulk modulus is finite, and p itself where it is infinite (augmented
/// Lagrange: the change of volume θ - 1 goes to zero with p, at no factorisation of its own; it contracts by
/// stiffness over penalty). With `augment` off, m stays what the configuration brings along. R at U'(θ(u))
/// instead, as a condensed body is often solved, has the same solution but multiplies every curvature of θ by
/// the bulk modulus on the way there. (Simo, Taylor & Pister 1985, doi:10.1016/0045-7825(85)90033-7; Wriggers
/// 2008, doi:10.1007/978-3-540-71001-1, ch. 10)
///
/// Done when the relative residual (equations.hpp) is below its tolerance or rounding, |θ - 1| below its own
/// where a bulk modulus is infinite, and the correction that the residual still asks for below relative_step
/// max(|u|, 1e-3 h √n).

#include <string>
#include <vector>

#include "fem/solve/equations.hpp"
#include "fem/solve/secant.hpp"
#include "fem/solve/tangent_factor.hpp"

namespace brachium::fem {

struct NewtonOutcome {
  bool converged = false;
  std::string reason;  ///< why not
  int newton = 0, chord = 0, augmentations = 0;
  Evaluation last;  ///< at the configuration that is left behind
};

class Newton {
 public:
  /// `prefix`: of the kinds in the records.
  Newton(Equations& equations, TangentFactor& factor, const NewtonSettings& settings,
         const std::string& prefix = "")
      : equations_(equations), factor_(factor), settings_(settings), prefix_(prefix) {}

  /// Moves the free unknowns (and multipliers) of `configuration`, whose held components are imposed already.
  /// `pressure`: of condensed formulations, as predicted; empty: U'(θ) and the configuration's multiplier.
  NewtonOutcome run(Configuration& configuration, const LoadPoint& load, int step,
                    std::vector<IterationRecord>& records, Eigen::MatrixXd pressure = {});

 private:
  /// A point, and what the factor at hand asks for there.
  struct Point {
    Configuration configuration;       ///< its multiplier makes the pressure p
    Eigen::MatrixXd pressure, excess;  ///< p and Δp of condensed formulations
    Evaluation evaluation;
    Eigen::VectorXd correction;  ///< d
    double length = 0.0;         ///< |d| over displacements [m]
    double part = 1.0;           ///< λ that led here
  };
  Equations& equations_;
  TangentFactor& factor_;
  NewtonSettings settings_;
  std::string prefix_;
  Eigen::MatrixXd multiplier_;  ///< m that stays; empty: 0, or p
  Secant secant_;
  double fresh_contraction_ = 0.0;  ///< Θ of the last whole step with a new factor
  NewtonOutcome outcome_;

  bool augmenting() const { return settings_.augment && equations_.augmented(); }
  double step_scale(const Configuration& configuration) const;
  bool arrived(const Point& p) const;
  bool chord_pays(const Point& p, double contraction) const;
  void set_pressure(Point& p, Eigen::MatrixXd pressure);
  void correct(Point& p);
  std::string new_factor(Point& p, const LoadPoint& load);
  Point move(const Point& from, const Eigen::VectorXd& step, double part, const LoadPoint& load);
  Point damped(const Point& from, const LoadPoint& load);
  void record(const std::string& kind, const Point& from, const Point& to, int step,
              std::vector<IterationRecord>& records) const;
};

}  // namespace brachium::fem
