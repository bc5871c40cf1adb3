#pragma once
/// The equations of equilibrium over the unknowns: R(u) = f_int(u) - f_ext(u) = 0 at the components that
/// nothing holds.
///
/// How small a residual is, is judged against forces that really act (dimensionless):
///   relative = max( |R_u| / reference,  |R_p| √n_p / V ),
///   reference = max( |f_int|, |f_ext|, 1e-3 (Σ_cells |f_cell|^2)^(1/2), 1e-6 E h^2 √n_cells ),
///   rounding  = 50 ε max(E, κ) h^2 √n_cells / reference:  a relative residual below cannot be told from 0
/// R_u at free displacements, f_int at all of them: at equilibrium it consists of reactions and loads. A body
/// that is stressed but bears on nothing (active, unloaded) is judged by the forces of its cells before they
/// cancel; a body at rest by those of a strain of 1e-6 (E: the stiffness at rest, κ: the bulk modulus or
/// penalty of condensed formulations, h^3: the mean volume of a cell, ε = 2.2e-16). R_p are the residuals of
/// continuous pressures [m3], n_p of them, V the volume.

#include <memory>
#include <string>
#include <vector>

#include "fem/assembly/assembly.hpp"
#include "fem/solve/constraints.hpp"
#include "fem/solve/loads.hpp"
#include "fem/solve/programme.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::fem {

/// One evaluation of the residual.
struct Evaluation {
  Assembled sums;
  Eigen::VectorXd internal, external;  ///< by dof, global axes
  Eigen::VectorXd residual;            ///< by unknown
  double residual_norm = 0.0;          ///< N, free displacements
  double reference = 0.0;              ///< N
  double relative = 0.0;
  double rounding = 0.0;  ///< of the relative residual
  bool valid() const { return !sums.failure; }
};

/// Tangent over the unknowns: the lower triangle of the internal part on the unknowns' pattern, and the
/// loads' part.
struct TangentValues {
  std::vector<double> lower;
  std::vector<FaceTangent> loads;  ///< ∂f_ext/∂u, in global axes
};

class Equations {
 public:
  Equations(const Problem& problem, const SolveOptions& options);

  const Problem& problem() const { return *problem_; }
  const Discretisation& discretisation() const { return *discretisation_; }
  const Assembly& assembly() const { return *assembly_; }
  const Constraints& constraints() const { return *constraints_; }
  const Unknowns& unknowns() const { return unknowns_; }
  const Loads& loads() const { return *loads_; }
  double penalty_pa() const { return penalty_pa_; }  ///< 0 where no region is condensed and incompressible
  double stiffness_pa() const {
    return stiffness_pa_;
  }  ///< stiffest region at rest, or ten times its active stress
  bool augmented() const { return penalty_pa_ > 0.0; }
  bool condensed() const { return condensed_; }  ///< pressures are discontinuous and eliminated cell by cell
  bool rate_dependent() const { return rate_dependent_; }
  bool saddle_point() const { return discretisation_->pressure_node_count() > 0; }
  /// Loads that follow a surface with a free edge: the tangent is unsymmetric.
  bool unsymmetric() const { return unsymmetric_; }
  double cell_size_m() const { return cell_size_m_; }

  /// Leaves out the conditions named. Numbers the unknowns; true when they changed.
  bool constrain(const std::vector<std::string>& released);

  /// Reactions by dof that fade, from here on; empty: none.
  void set_released_force(const Eigen::VectorXd& force) { released_force_ = force; }

  /// Residual at a configuration whose held components are imposed. The activation is the load point's.
  Evaluation evaluate(Configuration& configuration, const LoadPoint& load);
  /// The same with the tangent.
  Evaluation linearise(Configuration& configuration, const LoadPoint& load, TangentValues& tangent);

  /// U'(θ) of condensed formulations at a configuration's displacements, without multipliers;
  /// pressures_per_cell x n_cells.
  Eigen::MatrixXd volumetric_pressure(const Configuration& configuration);
  /// Internal forces by dof; the pressure is U'(θ) and the configuration's multiplier.
  Eigen::VectorXd internal_force(const Configuration& configuration);

  /// dofs += scale * (increment by unknown).
  void add(const Eigen::VectorXd& increment, double scale, Eigen::VectorXd& dofs) const;
  /// |.| over displacements of a vector by unknown.
  double displacement_norm(const Eigen::VectorXd& by_unknown) const;
  /// Unknowns that are displacements; they come first.
  Eigen::Index displacement_unknowns() const { return displacement_unknowns_; }
  /// The displacements of a vector by dof.
  auto displacements(const Eigen::VectorXd& by_dof) const {
    return by_dof.head(3 * static_cast<Eigen::Index>(discretisation_->node_count()));
  }

  long residual_evaluations = 0, tangent_evaluations = 0, pressure_evaluations = 0;
  double seconds = 0.0;  ///< spent in the assembly

 private:
  const Problem* problem_;
  std::shared_ptr<const Discretisation> discretisation_;
  std::unique_ptr<Assembly> assembly_;
  std::unique_ptr<Loads> loads_;
  std::unique_ptr<Constraints> constraints_;
  Unknowns unknowns_;
  Eigen::VectorXd released_force_;
  double penalty_pa_ = 0.0, stiffness_pa_ = 0.0, cell_size_m_ = 0.0, volume_ = 0.0, stiffest_pa_ = 0.0;
  bool rate_dependent_ = false, unsymmetric_ = false, condensed_ = false;
  Eigen::Index displacement_unknowns_ = 0;

  void finish(Evaluation& e, const Configuration& configuration, const LoadPoint& load) const;
  bool find_unsymmetry() const;
};

/// Stiffness that scales a problem: the largest entry of 2 dS/dC at rest over the regions, or ten times the
/// largest active stress where that is more [Pa].
double stiffness_scale(const Problem& problem);

}  // namespace brachium::fem
