#include "fem/assembly/batches.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

void check_tissue(const Discretisation& d, const TissueField& tissue, const std::vector<bool>& fibrous) {
  const Eigen::Index points = static_cast<Eigen::Index>(d.cell_count()) * d.quadrature().size();
  const auto size = [&](Eigen::Index given, const char* what) {
    if (given == 0 || given == points) return;
    throw data::InputError(
        "fibre-field-size",
        fmt::format("{} has {} values, the mesh has {} quadrature points", what, given, points),
        "make the field for the same element that is solved with");
  };
  size(tissue.fibre.cols(), "the fibre field");
  size(tissue.muscle.size(), "the share of muscle");
  size(tissue.soft_tissue.size(), "the share of soft tissue");
  const int n_q = d.quadrature().size();
  for (Eigen::Index i = 0; i < tissue.fibre.cols(); ++i) {
    const int region = d.mesh().region_of_cell[static_cast<std::size_t>(i / n_q)];
    if (!fibrous[static_cast<std::size_t>(region)]) continue;
    const double norm = tissue.fibre.col(i).norm();
    if (!(std::abs(norm - 1.0) < 1e-6)) {
      throw data::InputError("zero-fibre",
                             fmt::format("the fibre at quadrature point {} of cell {} has length {:.6g}",
                                         i % n_q, i / n_q, norm),
                             "fibres are unit vectors");
    }
  }
  const auto share = [&](const Eigen::VectorXd& values, const char* what) {
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      if (values[i] >= 0.0 && values[i] <= 1.0) continue;
      throw data::InputError(
          "blending-range",
          fmt::format("{} is {} at quadrature point {} of cell {}", what, values[i], i % n_q, i / n_q),
          "it lies in [0, 1]");
    }
  };
  share(tissue.muscle, "the share of muscle");
  share(tissue.soft_tissue, "the share of soft tissue");
}

/// Greedy: each batch gets the first colour that none of its nodes has yet.
std::vector<std::vector<std::size_t>> colour(const Discretisation& d, const Batches& batches) {
  std::vector<std::vector<std::size_t>> colours;
  std::vector<std::vector<char>> taken;  // by colour and point
  for (std::size_t b = 0; b < batches.size(); ++b) {
    const auto free = [&](std::size_t c) {
      for (int l = 0; l < batches.count[b]; ++l) {
        for (int a = 0; a < d.nodes_per_cell(); ++a) {
          if (taken[c][static_cast<std::size_t>(
                  d.nodes_of_cell()(a, batches.cell[b][static_cast<std::size_t>(l)]))])
            return false;
        }
      }
      return true;
    };
    std::size_t c = 0;
    while (c < colours.size() && !free(c)) ++c;
    if (c == colours.size()) {
      colours.emplace_back();
      taken.emplace_back(static_cast<std::size_t>(d.node_count()), 0);
    }
    colours[c].push_back(b);
    for (int l = 0; l < batches.count[b]; ++l) {
      for (int a = 0; a < d.nodes_per_cell(); ++a)
        taken[c]
             [static_cast<std::size_t>(d.nodes_of_cell()(a, batches.cell[b][static_cast<std::size_t>(l)]))] =
                 1;
    }
  }
  return colours;
}

/// Pressure functions 1, (X - X_c) / h of a cell: linear in physical coordinates (mapped ones lose order on
/// distorted cells; Boffi & Gastaldi 2002, doi:10.1007/s002110100382).
Eigen::MatrixXd discontinuous_shapes(const Discretisation& d, int cell) {
  const int n_q = d.quadrature().size(), p = d.pressures_per_cell();
  Eigen::MatrixXd phi(p, n_q);
  phi.row(0).setOnes();
  if (p == 1) return phi;
  Eigen::Matrix3Xd x(3, n_q);
  for (int q = 0; q < n_q; ++q) x.col(q) = d.position(cell, q);
  const Eigen::Vector3d centre = x.rowwise().mean();
  x.colwise() -= centre;
  phi.bottomRows(3) = x / x.cwiseAbs().maxCoeff();
  return phi;
}

}  // namespace

KernelInput Batches::input(std::size_t b) const {
  KernelInput in;
  in.nodes = nodes;
  in.padded_nodes = padded_nodes;
  in.points = points;
  in.pressures = pressures;
  const auto q = static_cast<std::size_t>(points), p = static_cast<std::size_t>(pressures),
             n = static_cast<std::size_t>(padded_nodes);
  in.gradient = gradient.data() + b * q * n * 3;
  in.weight = weight.data() + b * q;
  in.fibre = fibre.data() + b * q * 3;
  in.muscle = muscle.data() + b * q;
  in.soft_tissue = soft_tissue.data() + b * q;
  in.pressure_shape = pressure_shape.data() + (shared_pressure_shape ? 0 : b * q * p);
  in.mass_inverse = shared_pressure_shape ? nullptr : mass_inverse.data() + b * p * p;
  return in;
}

Batches make_batches(const Discretisation& d, const TissueField& tissue, const std::vector<bool>& fibrous) {
  check_tissue(d, tissue, fibrous);
  Batches batches;
  const int n_q = d.quadrature().size(), p = d.pressures_per_cell(), nodes = d.nodes_per_cell();
  batches.nodes = nodes;
  batches.padded_nodes = (nodes + 3) / 4 * 4;
  batches.points = n_q;
  batches.pressures = p;
  batches.shared_pressure_shape = d.pressure_node_count() > 0;
  const int regions = static_cast<int>(d.mesh().regions.size());
  for (int region = 0; region < regions; ++region) {
    std::vector<int> cells;
    for (int c = 0; c < d.cell_count(); ++c) {
      if (d.mesh().region_of_cell[static_cast<std::size_t>(c)] == region) cells.push_back(c);
    }
    for (std::size_t i = 0; i < cells.size(); i += lanes) {
      const std::size_t count = std::min<std::size_t>(lanes, cells.size() - i);
      std::array<int, lanes> cell;
      for (std::size_t l = 0; l < lanes; ++l) cell[l] = cells[i + std::min(l, count - 1)];
      batches.cell.push_back(cell);
      batches.count.push_back(static_cast<int>(count));
      batches.region.push_back(region);
    }
  }
  batches.colours = colour(d, batches);

  const auto total = batches.size(), q_total = total * static_cast<std::size_t>(n_q);
  batches.gradient.assign(q_total * static_cast<std::size_t>(3 * batches.padded_nodes), LaneBlock{});
  batches.weight.resize(q_total);
  batches.fibre.resize(q_total * 3);
  batches.muscle.resize(q_total);
  batches.soft_tissue.resize(q_total);
  if (batches.shared_pressure_shape) {
    for (int q = 0; q < n_q; ++q) {
      const data::CellType corners = p == 8 ? data::CellType::hex8 : data::CellType::tet4;
      const Shape shape = cell_shape(corners, d.quadrature().points.col(q));
      for (int m = 0; m < p; ++m) {
        LaneBlock block;
        for (double& x : block.lane) x = shape.value[m];
        batches.pressure_shape.push_back(block);
      }
    }
  } else {
    batches.pressure_shape.resize(q_total * static_cast<std::size_t>(p));
    batches.mass_inverse.resize(total * static_cast<std::size_t>(p * p));
  }
  Eigen::MatrixX3d gradient;
  for (std::size_t b = 0; b < total; ++b) {
    for (int l = 0; l < lanes; ++l) {
      const int cell = batches.cell[b][static_cast<std::size_t>(l)];
      Eigen::VectorXd weights(n_q);
      for (int q = 0; q < n_q; ++q) {
        double weight = 0.0;
        d.reference_gradients(cell, q, gradient, weight);
        weights[q] = weight;
        const std::size_t at = b * static_cast<std::size_t>(n_q) + static_cast<std::size_t>(q);
        const Eigen::Index column = static_cast<Eigen::Index>(cell) * n_q + q;
        batches.weight[at].lane[l] = weight;
        for (int a = 0; a < nodes; ++a) {
          for (int j = 0; j < 3; ++j)
            batches
                .gradient[(at * static_cast<std::size_t>(batches.padded_nodes) +
                           static_cast<std::size_t>(a)) *
                              3 +
                          static_cast<std::size_t>(j)]
                .lane[l] = gradient(a, j);
        }
        // Laws without fibres never look at the direction; a unit vector keeps every lane finite.
        const bool given = tissue.fibre.cols() > 0 && fibrous[static_cast<std::size_t>(batches.region[b])];
        for (int j = 0; j < 3; ++j)
          batches.fibre[at * 3 + static_cast<std::size_t>(j)].lane[l] =
              given ? tissue.fibre(j, column) : (j == 0 ? 1.0 : 0.0);
        batches.muscle[at].lane[l] = tissue.muscle.size() > 0 ? tissue.muscle[column] : 1.0;
        batches.soft_tissue[at].lane[l] = tissue.soft_tissue.size() > 0 ? tissue.soft_tissue[column] : 0.0;
      }
      if (batches.shared_pressure_shape || p == 0) continue;
      const Eigen::MatrixXd phi = discontinuous_shapes(d, cell);
      const Eigen::MatrixXd inverse =
          (phi * weights.asDiagonal() * phi.transpose()).llt().solve(Eigen::MatrixXd::Identity(p, p));
      for (int q = 0; q < n_q; ++q) {
        for (int m = 0; m < p; ++m)
          batches
              .pressure_shape[(b * static_cast<std::size_t>(n_q) + static_cast<std::size_t>(q)) *
                                  static_cast<std::size_t>(p) +
                              static_cast<std::size_t>(m)]
              .lane[l] = phi(m, q);
      }
      for (int m = 0; m < p; ++m) {
        for (int k = 0; k < p; ++k)
          batches.mass_inverse[b * static_cast<std::size_t>(p * p) + static_cast<std::size_t>(m * p + k)]
              .lane[l] = inverse(m, k);
      }
    }
  }
  return batches;
}

}  // namespace brachium::fem
