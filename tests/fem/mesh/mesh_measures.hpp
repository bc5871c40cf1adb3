#pragma once
/// Volume and area of meshes for tests, by Gauss rules of high degree: independent of the rules that the
/// solver uses.

#include <Eigen/Dense>
#include <string>

#include "data/model/mesh.hpp"
#include "fem/element/quadrature.hpp"
#include "fem/element/shape.hpp"

namespace brachium::fem::tests {

inline Eigen::Matrix3Xd cell_points(const data::Mesh& mesh, int cell) {
  return mesh.points(Eigen::all, mesh.cells.col(cell));
}

/// Tetrahedra are integrated as collapsed cubes: degree enough for every cell type.
inline double volume(const data::Mesh& mesh, const std::string& region = "") {
  static const Quadrature rule = gauss_hexahedron(5);
  const bool hexahedra = data::corners_per_cell(mesh.type) == 8;
  double sum = 0.0;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    if (!region.empty() &&
        mesh.regions[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])] != region)
      continue;
    const Eigen::Matrix3Xd x = cell_points(mesh, c);
    for (int q = 0; q < rule.size(); ++q) {
      Eigen::Vector3d xi = rule.points.col(q);
      double weight = rule.weights[q];
      if (!hexahedra) {
        const Eigen::Vector3d s = 0.5 * (xi.array() + 1.0);  // unit cube
        xi = {s[0], s[1] * (1 - s[0]), s[2] * (1 - s[0]) * (1 - s[1])};
        weight *= 0.125 * (1 - s[0]) * (1 - s[0]) * (1 - s[1]);
      }
      const Eigen::Matrix3d jacobian = x * cell_shape(mesh.type, xi).derivative;
      sum += weight * jacobian.determinant();
    }
  }
  return sum;
}

/// Vector area of a surface, the integral of its outward normal; `area` if given gets the plain area.
inline Eigen::Vector3d vector_area(const data::Mesh& mesh, const std::string& surface,
                                   double* area = nullptr) {
  const Quadrature& rule = face_quadrature(mesh.type);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  if (area) *area = 0.0;
  for (const data::CellFace& f : mesh.surface(surface).faces) {
    const auto local = data::face_nodes(mesh.type, f.face);
    Eigen::Matrix3Xd x(3, static_cast<Eigen::Index>(local.size()));
    for (std::size_t i = 0; i < local.size(); ++i)
      x.col(static_cast<Eigen::Index>(i)) = mesh.points.col(mesh.cells(local[i], f.cell));
    for (int q = 0; q < rule.size(); ++q) {
      const Eigen::Matrix<double, 3, 2> tangents = x * face_shape(mesh.type, rule.points.col(q)).derivative;
      const Eigen::Vector3d normal = tangents.col(0).cross(tangents.col(1));
      sum += rule.weights[q] * normal;
      if (area) *area += rule.weights[q] * normal.norm();
    }
  }
  return sum;
}

/// Codes of everything that check_structure() finds.
inline std::string structure(const data::Mesh& mesh) {
  std::string text;
  for (const data::Diagnostic& d : data::check_structure(mesh)) text += d.code + ": " + d.message + "\n";
  return text;
}

inline constexpr data::CellType all_types[] = {data::CellType::tet4, data::CellType::tet10,
                                               data::CellType::hex8, data::CellType::hex20,
                                               data::CellType::hex27};

}  // namespace brachium::fem::tests
