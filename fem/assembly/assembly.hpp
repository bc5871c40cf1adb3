#pragma once
/// Residual, energy and tangent of the whole mesh at one state. Loops over cells run in parallel; every entry is summed
/// in a fixed order, so results are equal to the last bit for any number of threads.

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "fem/assembly/discretisation.hpp"
#include "fem/fibre/field.hpp"
#include "fem/linear/symmetric_solver.hpp"
#include "fem/material/material.hpp"

namespace brachium::fem {

/// What the interior of the body depends on. Vectors by dof (assembly/discretisation.hpp), in global axes.
struct Configuration {
  Eigen::VectorXd dofs;              ///< dof_count: displacements [m], continuous pressures [Pa] (tension positive)
  Eigen::VectorXd activation;        ///< by region, [0, 1]
  Eigen::MatrixXd multiplier;        ///< pressures_per_cell x n_cells [Pa], augmented Lagrange; empty: zero
  Eigen::VectorXd dofs_before;       ///< of the last accepted state, for rates; empty: no rates
  double inverse_dt = 0.0;           ///< 1/s, with dofs_before
  double viscosity_pa_s = 0.0;       ///< S += 2 eta E_dot, with dofs_before: regularisation that vanishes at rest
};

struct AssemblyFailure {
  int cell = -1;           ///< cell with J <= 0 or a value that is not finite
  double jacobian = 0.0;   ///< smallest J found
};

/// Sums over the mesh.
struct Assembled {
  double energy = 0.0;         ///< J, stored and volumetric (without loads)
  double volume = 0.0;         ///< m3, deformed
  double worst_volume = 0.0;   ///< max over cells and points of |theta - 1| (discontinuous) or of |J - 1|
  double cell_force_norm = 0.0;  ///< N, sqrt(sum over cells of |f_cell|^2): internal forces before they cancel at nodes
  double smallest_jacobian = 1.0;
  int smallest_jacobian_cell = -1;
  std::optional<AssemblyFailure> failure;  ///< then nothing else is valid
};

/// Free unknowns, frames of nodes, and the pattern of the tangent over them; one per set of constraints.
struct Unknowns {
  std::vector<int> unknown_of_dof;     ///< -1: held
  std::vector<int> dof_of_unknown;
  std::vector<int> block_of_unknown;   ///< unknowns of one node share a block
  SymmetricPattern pattern;
  Eigen::Matrix3Xd frames;             ///< empty, or 3 x 3 n_nodes: columns are the axes of a node's dofs
  int count() const { return static_cast<int>(dof_of_unknown.size()); }
};

class Assembly {
 public:
  /// `penalty_pa`: bulk modulus of the augmented Lagrange iteration where a region's is infinite.
  Assembly(std::shared_ptr<const Discretisation> discretisation, std::vector<RegionMaterial> materials,
           TissueField tissue, double penalty_pa, std::size_t threads);
  ~Assembly();

  const Discretisation& discretisation() const;

  /// Numbers the dofs that are not held and finds the tangent's pattern. `held`: by dof; `frames` may be empty.
  Unknowns number(const std::vector<char>& held, const Eigen::Matrix3Xd& frames) const;

  /// Internal forces by dof (global axes): residual = dW/du - 0. Size dof_count.
  Assembled residual(const Configuration& configuration, Eigen::VectorXd& force) const;

  /// Residual (by dof, global axes) and tangent: values on unknowns.pattern (lower triangle), rows and columns of a node
  /// in its frame. The tangent of internal forces only.
  Assembled tangent(const Configuration& configuration, const Unknowns& unknowns, Eigen::VectorXd& force,
                    std::vector<double>& values) const;

  /// Pressures by cell of the condensed formulations, U'(theta) + multiplier: what the augmented Lagrange iteration
  /// takes as its next multiplier; pressures_per_cell x n_cells [Pa].
  Eigen::MatrixXd pressures(const Configuration& configuration) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace brachium::fem
