#pragma once
/// Residual, energy and tangent of the whole mesh at one state. Loops over cells run in parallel; every entry
/// is summed in a fixed order, so results are equal to the last bit for any number of threads.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "fem/assembly/discretisation.hpp"
#include "fem/assembly/unknowns.hpp"
#include "fem/fibre/field.hpp"
#include "fem/material/material.hpp"

namespace brachium::fem {

/// What the interior of the body depends on. Vectors by dof, global axes (fem/assembly/unknowns.hpp).
struct Configuration {
  Eigen::VectorXd dofs;        ///< dof_count: displacements [m], continuous pressures [Pa] (tension positive)
  Eigen::VectorXd activation;  ///< by region, [0, 1]
  Eigen::MatrixXd multiplier;  ///< pressures_per_cell x n_cells [Pa], augmented Lagrange; empty: zero
  Eigen::VectorXd dofs_before;         ///< of the last accepted state, for rates; empty: no rates
  double inverse_dt = 0.0;             ///< 1/s, with dofs_before
  Eigen::VectorXd contact_multiplier;  ///< by contact point [Pa] (fem/contact/contact.hpp); empty: none
  double viscosity_pa_s = 0.0;  ///< S += 2 eta E_dot, with dofs_before: regularisation that vanishes at rest
};

struct AssemblyFailure {
  int cell = -1;          ///< cell with J <= 0 or a value that is not finite
  double jacobian = 0.0;  ///< smallest J found
};

/// Sums over the mesh.
struct Assembled {
  std::optional<double> energy;  ///< J, stored and volumetric, without loads; where it was asked for
  double volume = 0.0;           ///< m3, deformed
  double worst_volume = 0.0;     ///< max over cells and points of |theta - 1| (discontinuous) or of |J - 1|
  double cell_force_norm =
      0.0;  ///< N, sqrt(sum over cells of |f_cell|^2): internal forces before they cancel at nodes
  double smallest_jacobian = 1.0;
  int smallest_jacobian_cell = -1;
  std::optional<AssemblyFailure> failure;  ///< then nothing else is valid
};

class Assembly {
 public:
  /// `penalty_pa`: bulk modulus of the augmented Lagrange iteration where a region's is infinite.
  Assembly(std::shared_ptr<const Discretisation> discretisation, std::vector<RegionMaterial> materials,
           TissueField tissue, double penalty_pa, std::size_t threads);
  ~Assembly();

  const Discretisation& discretisation() const;
  const std::vector<RegionMaterial>& materials() const;
  const TissueField& tissue() const;
  std::string kernel() const;  ///< which instruction set the element loops use

  /// Derivative of the energy by dof, global axes: internal forces [N], and of continuous pressures the
  /// constraint int phi (J - 1 - p / k) [m3]. Size dof_count.
  Assembled residual(const Configuration& configuration, Eigen::VectorXd& force,
                     bool with_energy = false) const;

  /// The same, and its tangent: values on unknowns.pattern, in the axes of the nodes.
  Assembled tangent(const Configuration& configuration, const Unknowns& unknowns, Eigen::VectorXd& force,
                    std::vector<double>& values) const;

  /// Pressures by cell of the condensed formulations, U'(theta) + multiplier: what the augmented Lagrange
  /// iteration takes as its next multiplier; pressures_per_cell x n_cells [Pa].
  Eigen::MatrixXd pressures(const Configuration& configuration) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brachium::fem
