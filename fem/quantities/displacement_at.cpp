#include "fem/quantities/displacement_at.hpp"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fem/element/shape.hpp"
#include "fem/quantities/cell_point.hpp"

namespace brachium::fem {
namespace {

bool is_tetrahedron(data::CellType type) {
  return data::corners_per_cell(type) == 4;
}

/// How far local coordinates lie outside the cell; at most 0 inside.
double outside(data::CellType type, const Eigen::Vector3d& xi) {
  if (is_tetrahedron(type)) return std::max(-xi.minCoeff(), xi.sum() - 1.0);
  return xi.cwiseAbs().maxCoeff() - 1.0;
}

/// Newton's method on X(xi) = X; none where it leaves the cell for good.
std::optional<Eigen::Vector3d> local_coordinates(const data::Mesh& mesh, int cell, const Eigen::Vector3d& X,
                                                 double length) {
  Eigen::Vector3d xi = is_tetrahedron(mesh.type) ? Eigen::Vector3d::Constant(0.25) : Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < 30; ++iteration) {
    const Shape shape = cell_shape(mesh.type, xi);
    Eigen::Vector3d miss = X;
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    for (Eigen::Index a = 0; a < shape.value.size(); ++a) {
      const Eigen::Vector3d node = mesh.points.col(mesh.cells(a, cell));
      miss -= shape.value[a] * node;
      jacobian += node * shape.derivative.row(a);
    }
    const Eigen::Vector3d step = jacobian.fullPivLu().solve(miss);
    if (!step.allFinite()) return std::nullopt;
    xi += step;
    if (miss.norm() <= 1e-13 * length && step.norm() <= 1e-10) return xi;
    if (outside(mesh.type, xi) > 3.0) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

Located locate(const Discretisation& discretisation, const Eigen::Vector3d& reference_m) {
  constexpr double tolerance = 1e-8;  // local coordinates: a point on a face belongs to a cell
  const data::Mesh& mesh = discretisation.mesh();
  int nearest = -1;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (int c = 0; c < mesh.cell_count(); ++c) {
    Eigen::Vector3d low = mesh.points.col(mesh.cells(0, c)), high = low, centre = Eigen::Vector3d::Zero();
    for (const int node : mesh.cells.col(c)) {
      low = low.cwiseMin(mesh.points.col(node));
      high = high.cwiseMax(mesh.points.col(node));
      centre += mesh.points.col(node);
    }
    centre /= static_cast<double>(mesh.cells.rows());
    const double distance = (centre - reference_m).norm(), length = (high - low).norm();
    if (distance < nearest_distance) {
      nearest_distance = distance;
      nearest = c;
    }
    // A curved cell bulges beyond the box of its nodes by less than a quarter of the box.
    if ((reference_m.array() < low.array() - 0.25 * length).any() ||
        (reference_m.array() > high.array() + 0.25 * length).any()) {
      continue;
    }
    const auto xi = local_coordinates(mesh, c, reference_m, length);
    if (xi && outside(mesh.type, *xi) <= tolerance) return {c, *xi};
  }
  throw data::InputError(
      "point-outside",
      fmt::format("the point ({:.6g}, {:.6g}, {:.6g}) m lies in no cell of the mesh", reference_m[0],
                  reference_m[1], reference_m[2]),
      fmt::format("the nearest is cell {}, whose centre is {:.3g} m away", nearest, nearest_distance));
}

Eigen::Vector3d displacement_at(const Discretisation& discretisation, const Configuration& configuration,
                                const Eigen::Vector3d& reference_m) {
  const Located place = locate(discretisation, reference_m);
  return cell_point(discretisation, configuration.dofs, place.cell, place.xi).displacement;
}

}  // namespace brachium::fem
