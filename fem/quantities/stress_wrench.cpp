#include "fem/quantities/stress_wrench.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <set>

#include "data/model/error.hpp"
#include "fem/element/shape.hpp"
#include "fem/quantities/cell_state.hpp"

namespace brachium::fem {
namespace {

constexpr double in_plane = 1e-6;  // of a face's size

/// Adds `share` of -P N dA over one face of a cell, N outward.
void add_face(const data::Mesh& mesh, const CellStates& states, const data::CellFace& face, double share,
              const Eigen::Vector3d& point_m, Wrench& sum) {
  const Quadrature& rule = face_quadrature(mesh.type);
  const Eigen::Matrix3Xd& corner = node_coordinates(mesh.type);
  const auto nodes = data::face_nodes(mesh.type, face.face);
  for (int q = 0; q < rule.size(); ++q) {
    const Shape shape = face_shape(mesh.type, rule.points.col(q));
    Eigen::Vector3d xi = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const auto row = static_cast<Eigen::Index>(a);
      xi += shape.value[row] * corner.col(nodes[a]);
      tangents += mesh.points.col(mesh.cells(nodes[a], face.cell)) * shape.derivative.row(row);
    }
    const Eigen::Vector3d N_dA = rule.weights[q] * tangents.col(0).cross(tangents.col(1));
    const CellState state = states.at(face.cell, xi);
    const Eigen::Vector3d f = -share * (state.first_piola_pa * N_dA);
    sum.force_n += f;
    sum.moment_n_m += (state.point.position + state.point.displacement - point_m).cross(f);
  }
}

/// Side on which a cell lies of a plane that one of its faces lies in: the centre's signed distance.
double side_of(const data::Mesh& mesh, int cell, const Eigen::Vector3d& point,
               const Eigen::Vector3d& normal) {
  double sum = 0.0;
  for (Eigen::Index a = 0; a < mesh.cells.rows(); ++a)
    sum += normal.dot(mesh.points.col(mesh.cells(a, cell)) - point);
  return sum;
}

bool lies_in(const data::Mesh& mesh, const data::CellFace& face, const Eigen::Vector3d& point,
             const Eigen::Vector3d& normal) {
  const auto nodes = data::face_nodes(mesh.type, face.face);
  const Eigen::Vector3d first = mesh.points.col(mesh.cells(nodes[0], face.cell));
  const double size = (mesh.points.col(mesh.cells(nodes[1], face.cell)) - first).norm();
  for (const int a : nodes) {
    if (std::abs(normal.dot(mesh.points.col(mesh.cells(a, face.cell)) - point)) > in_plane * size)
      return false;
  }
  return true;
}

}  // namespace

Wrench stress_wrench(const Problem& problem, const Discretisation& discretisation,
                     const Configuration& configuration, const std::string& surface,
                     const Eigen::Vector3d& point_m) {
  const data::Mesh& mesh = discretisation.mesh();
  const CellStates states(problem, discretisation, configuration);
  Wrench sum;
  for (const data::CellFace& face : mesh.surface(surface).faces)
    add_face(mesh, states, face, 1.0, point_m, sum);
  return sum;
}

Wrench section_stress_wrench(const Problem& problem, const Discretisation& discretisation,
                             const Configuration& configuration, const Eigen::Vector3d& plane_point_m,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& point_m,
                             SectionFaces which) {
  const data::Mesh& mesh = discretisation.mesh();
  const CellStates states(problem, discretisation, configuration);
  const Eigen::Vector3d n = normal.normalized();
  std::set<data::CellFace> parting;
  if (which == SectionFaces::parting) {
    const data::FaceTable table(mesh);
    const auto& entries = table.entries();
    for (std::size_t i = 1; i < entries.size(); ++i) {
      const data::CellFace &a = entries[i - 1].face, &b = entries[i].face;
      if (entries[i - 1].key != entries[i].key ||
          (side_of(mesh, a.cell, plane_point_m, n) < 0.0) == (side_of(mesh, b.cell, plane_point_m, n) < 0.0))
        continue;
      parting.insert(a);
      parting.insert(b);
    }
  }
  const int faces = data::faces_per_cell(mesh.type);
  Wrench before, after;
  bool found = false;
  for (int cell = 0; cell < discretisation.cell_count(); ++cell) {
    for (int f = 0; f < faces; ++f) {
      const data::CellFace face{cell, f};
      if (which == SectionFaces::parting ? !parting.contains(face) : !lies_in(mesh, face, plane_point_m, n))
        continue;
      found = true;
      const bool is_before = side_of(mesh, cell, plane_point_m, n) < 0.0;
      add_face(mesh, states, face, is_before ? 0.5 : -0.5, point_m, is_before ? before : after);
    }
  }
  if (!found || before.force_n.isZero(0.0) || after.force_n.isZero(0.0))
    throw data::InputError(
        "plane-misses-body",
        fmt::format("no faces between cells lie in the plane through ({:.6g}, {:.6g}, {:.6g}) m",
                    plane_point_m.x(), plane_point_m.y(), plane_point_m.z()),
        "take a plane between two layers of cells");
  return {before.force_n + after.force_n, before.moment_n_m + after.moment_n_m};
}

}  // namespace brachium::fem
