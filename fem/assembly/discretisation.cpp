#include "fem/assembly/discretisation.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

/// Worst first, at most this many cells are named in a message.
constexpr std::size_t named_cells = 5;

}  // namespace

Discretisation::Discretisation(std::shared_ptr<const data::Mesh> mesh, Formulation formulation)
    : mesh_(std::move(mesh)), formulation_(formulation), quadrature_(&cell_quadrature(formulation)) {
  std::vector<data::Diagnostic> mistakes = data::check_structure(*mesh_);
  if (!mistakes.empty()) throw data::InputError(std::move(mistakes));
  const data::CellType wanted = cell_type(formulation);
  if (mesh_->type != wanted) {
    throw data::InputError("cell-type-mismatch",
                           fmt::format("element `{}` needs cells of type {}, the mesh has {}",
                                       to_string(formulation), to_string(wanted), to_string(mesh_->type)),
                           "elevate the mesh to that type, or choose an element of the mesh's type");
  }
  const int cells = mesh_->cell_count(), points = mesh_->point_count(),
            corners = data::corners_per_cell(wanted);
  const bool bubble = has_bubble(formulation);
  nodes_per_cell_ = data::nodes_per_cell(wanted) + (bubble ? 1 : 0);
  node_count_ = points + (bubble ? cells : 0);
  nodes_.resize(nodes_per_cell_, cells);
  nodes_.topRows(data::nodes_per_cell(wanted)) = mesh_->cells;
  if (bubble) nodes_.bottomRows(1) = Eigen::RowVectorXi::LinSpaced(cells, points, points + cells - 1);

  pressure_node_count_ = 0;
  pressures_per_cell_ = 0;
  switch (pressure_space(formulation)) {
    case PressureSpace::none:
      break;
    case PressureSpace::constant:
      pressures_per_cell_ = 1;
      break;
    case PressureSpace::linear_discontinuous:
      pressures_per_cell_ = 4;
      break;
    case PressureSpace::continuous: {
      pressures_per_cell_ = corners;
      std::vector<int> number(static_cast<std::size_t>(points), -1);
      for (int c = 0; c < cells; ++c) {
        for (int a = 0; a < corners; ++a) number[static_cast<std::size_t>(mesh_->cells(a, c))] = 0;
      }
      for (int n = 0; n < points; ++n) {
        if (number[static_cast<std::size_t>(n)] < 0) continue;
        number[static_cast<std::size_t>(n)] = pressure_node_count_++;
        pressure_vertices_.push_back(n);
      }
      pressure_nodes_.resize(corners, cells);
      for (int c = 0; c < cells; ++c) {
        for (int a = 0; a < corners; ++a)
          pressure_nodes_(a, c) = number[static_cast<std::size_t>(mesh_->cells(a, c))];
      }
    }
  }

  const int n_q = quadrature_->size();
  local_values_.resize(nodes_per_cell_, n_q);
  for (int q = 0; q < n_q; ++q) {
    const Eigen::Vector3d xi = quadrature_->points.col(q);
    const Shape shape = cell_shape(wanted, xi);
    Eigen::MatrixX3d derivative(nodes_per_cell_, 3);
    derivative.topRows(shape.derivative.rows()) = shape.derivative;
    local_values_.col(q).head(shape.value.size()) = shape.value;
    if (bubble) {
      const Shape b = bubble_shape(xi);
      derivative.bottomRows(1) = b.derivative;
      local_values_(nodes_per_cell_ - 1, q) = b.value[0];
    }
    local_derivatives_.push_back(std::move(derivative));
  }

  // Sums of weights, and the cells that are turned inside out.
  std::vector<std::pair<double, int>> inverted;
  Eigen::MatrixX3d gradient;
  for (int c = 0; c < cells; ++c) {
    double worst = std::numeric_limits<double>::infinity();
    for (int q = 0; q < n_q; ++q) {
      double weight = 0.0;
      reference_gradients(c, q, gradient, weight);
      worst = std::min(worst, weight / quadrature_->weights[q]);
      volume_ += weight;
    }
    if (!(worst > 0.0)) inverted.emplace_back(worst, c);
  }
  if (inverted.empty()) return;
  std::sort(inverted.begin(), inverted.end());
  std::string list;
  for (std::size_t i = 0; i < std::min(named_cells, inverted.size()); ++i) {
    const int c = inverted[i].second;
    list += fmt::format(
        "{}{} (region `{}`, Jacobian {:.3g})", i > 0 ? ", " : "", c,
        mesh_->regions[static_cast<std::size_t>(mesh_->region_of_cell[static_cast<std::size_t>(c)])],
        inverted[i].first);
  }
  throw data::InputError(
      "inverted-cell",
      fmt::format("{} of {} cells are turned inside out or flat at a quadrature point: {}{}", inverted.size(),
                  cells, list, inverted.size() > named_cells ? ", ..." : ""),
      "mend the mesh there; node order and curved edges are the usual causes");
}

void Discretisation::reference_gradients(int cell, int q, Eigen::MatrixX3d& gradient, double& weight) const {
  const Eigen::MatrixX3d& local = local_derivatives_[static_cast<std::size_t>(q)];
  const int geometric = static_cast<int>(mesh_->cells.rows());
  Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();  // dX_i/dxi_j
  for (int a = 0; a < geometric; ++a) jacobian += mesh_->points.col(mesh_->cells(a, cell)) * local.row(a);
  weight = quadrature_->weights[q] * jacobian.determinant();
  gradient = local * jacobian.inverse();
}

Eigen::Vector3d Discretisation::position(int cell, int q) const {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  for (int a = 0; a < mesh_->cells.rows(); ++a)
    x += local_values_(a, q) * mesh_->points.col(mesh_->cells(a, cell));
  return x;
}

}  // namespace brachium::fem
