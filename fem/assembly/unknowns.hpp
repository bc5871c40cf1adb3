#pragma once
/// Which degrees of freedom are free, in which axes, and where their couplings stand in the tangent. One per
/// set of constraints.
///
/// Dofs are numbered 3 node + component; continuous pressures follow as 3 n_nodes + pressure node. Vectors by
/// dof are always in global axes. A node may have axes of its own (oblique symmetry planes): its dofs are
/// then held or free as components in them, and vectors of unknowns hold such components.

#include <Eigen/Core>
#include <vector>

#include "fem/assembly/discretisation.hpp"
#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

struct Unknowns {
  std::vector<int> unknown_of_dof;  ///< -1: held
  std::vector<int> dof_of_unknown;
  Eigen::Matrix3Xd frames;   ///< empty, or 3 x 3 n_nodes: the columns of block n are the axes of node n
  std::vector<char> framed;  ///< by node: 1 where its axes are not the global ones; empty: none are
  SymmetricPattern pattern;  ///< of the tangent, lower triangle
  UnknownGroups groups;      ///< unknowns of a node share a block; continuous pressures are constraints
  /// Position in the pattern's values of every entry of every cell's tangent; -1: held, or the other half of
  /// a diagonal block. A cell has `entries_per_cell`: displacement blocks as in KernelOutput::tangent, then
  /// the coupling (n_p x 3 nodes), then the pressures' own (n_p x n_p, lower half).
  std::vector<int> scatter;
  int entries_per_cell = 0;

  int count() const { return static_cast<int>(dof_of_unknown.size()); }
  bool has_frames() const { return frames.cols() > 0; }

  /// Components of a vector by dof that belong to unknowns.
  Eigen::VectorXd restrict(const Eigen::VectorXd& by_dof) const;
  /// The vector by dof whose unknowns are `x` and whose held components are 0.
  Eigen::VectorXd extend(const Eigen::VectorXd& x) const;
};

/// Numbers the dofs that are not held (`held` by dof, in the nodes' axes) and finds the pattern. `frames` may
/// be empty.
Unknowns number_unknowns(const Discretisation& discretisation, const std::vector<char>& held,
                         const Eigen::Matrix3Xd& frames);

}  // namespace brachium::fem
