#include "fem/solve/growing_mode.hpp"

#include <cmath>

namespace brachium::fem {
namespace {

constexpr double least_shift = 1e-6, first_shift = 0.1, largest_shift = 1e9;  // 1/s
constexpr int most_sweeps = 200;

/// K + s V at an equilibrium.
class ShiftedTangent {
 public:
  ShiftedTangent(Equations& equations, TangentFactor& factor, const Configuration& equilibrium,
                 const LoadPoint& load)
      : equations_(equations), factor_(factor), load_(load), here_(equilibrium) {
    here_.activation = load.activation;
    here_.dofs_before = here_.dofs;
    here_.viscosity_pa_s = equations.stiffness_pa();
  }

  bool factorise(double shift) {
    here_.inverse_dt = shift;
    if (!factor_.make(equations_, here_, load_).empty()) return false;
    const auto modes = factor_.negative_modes();
    force_ = equations_.internal_force(here_);
    return modes && modes->count == 0;
  }

  /// Least shift found without negative modes; 0: none.
  double bracket() {
    double shift = first_shift;
    if (factorise(shift)) {
      while (shift > least_shift && factorise(0.1 * shift)) shift *= 0.1;
    } else {
      do {
        shift *= 10.0;
        if (shift > largest_shift) return 0.0;
      } while (!factorise(shift));
    }
    if (const double middle = shift / std::sqrt(10.0); factorise(middle)) return middle;
    return factorise(shift) ? shift : 0.0;
  }

  /// s V x: the viscous force of a body that was at -x a moment ago.
  Eigen::VectorXd viscous(const Eigen::VectorXd& x) {
    const Eigen::VectorXd motion = equations_.unknowns().extend(x);
    const double part =
        1e-4 * equations_.cell_size_m() / equations_.displacements(motion).cwiseAbs().maxCoeff();
    Configuration moved = here_;
    moved.dofs_before -= part * motion;
    Eigen::VectorXd force = equations_.unknowns().restrict(equations_.internal_force(moved) - force_) / part;
    force.tail(force.size() - equations_.displacement_unknowns()).setZero();
    return force;
  }

 private:
  Equations& equations_;
  TangentFactor& factor_;
  const LoadPoint& load_;
  Configuration here_;
  Eigen::VectorXd force_;
};

}  // namespace

std::optional<Eigen::VectorXd> growing_mode(Equations& equations, TangentFactor& factor,
                                            const Configuration& equilibrium, const LoadPoint& load) {
  ShiftedTangent tangent(equations, factor, equilibrium, load);
  const Eigen::Index moving = equations.displacement_unknowns();
  if (moving == 0 || tangent.bracket() == 0.0) return std::nullopt;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(equations.unknowns().count());
  for (Eigen::Index i = 0; i < moving; ++i) x[i] = std::sin(0.37 + 12.9898 * static_cast<double>(i));
  Eigen::VectorXd force = tangent.viscous(x);
  double quotient = 0.0;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const Eigen::VectorXd pushed = force;
    x = force;
    factor.solve(x);
    const double size = x.head(moving).cwiseAbs().maxCoeff();
    if (!x.allFinite() || !(size > 0.0)) return std::nullopt;
    force = tangent.viscous(x);
    // x'(K + s V) x / x' s V x = 1 + μ/s: below 1 the energy falls along x.
    const double before = quotient;
    quotient = x.dot(pushed) / x.dot(force);
    x /= size;
    force /= size;
    if (quotient < 1.0 && std::abs(quotient - before) < 0.01 * (1.0 - quotient)) break;
  }
  if (!(quotient < 1.0)) return std::nullopt;
  return x;
}

}  // namespace brachium::fem
