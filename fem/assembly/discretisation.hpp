#pragma once
/// What of a problem does not change while it is solved: nodes (points of the mesh, and bubbles), pressures,
/// quadrature geometry.

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <vector>

#include "data/model/mesh.hpp"
#include "fem/element/quadrature.hpp"
#include "fem/formulation.hpp"

namespace brachium::fem {

class Discretisation {
 public:
  /// Throws InputError: cell-type-mismatch (with the way to elevate), inverted-cell (named), mesh-* of
  /// check_structure.
  Discretisation(std::shared_ptr<const data::Mesh> mesh, Formulation formulation);

  const data::Mesh& mesh() const { return *mesh_; }
  Formulation formulation() const { return formulation_; }
  int node_count() const { return node_count_; }  ///< points of the mesh, and one bubble a cell
  int cell_count() const { return mesh_->cell_count(); }
  int nodes_per_cell() const { return nodes_per_cell_; }  ///< with the bubble
  int pressures_per_cell() const {
    return pressures_per_cell_;
  }  ///< 0, 1, 4 (discontinuous) or 8, 4 (continuous)
  int pressure_node_count() const { return pressure_node_count_; }  ///< continuous pressures; 0 otherwise
  int dof_count() const { return 3 * node_count_ + pressure_node_count_; }
  const Eigen::MatrixXi& nodes_of_cell() const { return nodes_; }  ///< nodes_per_cell x n_cells
  const Eigen::MatrixXi& pressure_nodes_of_cell() const { return pressure_nodes_; }  ///< continuous only
  /// Vertex of the mesh that a continuous pressure belongs to.
  const std::vector<int>& pressure_vertices() const { return pressure_vertices_; }
  const Quadrature& quadrature() const { return *quadrature_; }
  /// dN_a/dX of cell c at quadrature point q (nodes_per_cell x 3), and weight times dX/dxi.
  void reference_gradients(int cell, int q, Eigen::MatrixX3d& gradient, double& weight) const;
  /// Reference position of a quadrature point.
  Eigen::Vector3d position(int cell, int q) const;
  /// Values of the nodes' shape functions, nodes_per_cell x n_q.
  const Eigen::MatrixXd& shape_values() const { return local_values_; }
  double volume() const { return volume_; }  ///< of the reference mesh [m3]

 private:
  std::shared_ptr<const data::Mesh> mesh_;
  Formulation formulation_;
  const Quadrature* quadrature_;
  int node_count_, nodes_per_cell_, pressures_per_cell_, pressure_node_count_;
  Eigen::MatrixXi nodes_, pressure_nodes_;
  std::vector<int> pressure_vertices_;
  std::vector<Eigen::MatrixX3d> local_derivatives_;  ///< dN/dxi by quadrature point
  Eigen::MatrixXd local_values_;                     ///< N, nodes_per_cell x n_q
  double volume_ = 0.0;
};

}  // namespace brachium::fem
