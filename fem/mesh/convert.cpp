#include "fem/mesh/convert.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brachium::fem {
namespace {

using data::CellType;
using data::Mesh;

[[noreturn]] void refuse(CellType from, const std::string& to, const std::string& help) {
  throw data::InputError("cell-type-mismatch",
                         fmt::format("cells of type {} cannot be made into {}", data::to_string(from), to),
                         help);
}

bool is_hexahedron(CellType type) {
  return data::corners_per_cell(type) == 8;
}

/// Drops points that no cell uses, and renumbers.
void drop_unused_points(Mesh& mesh) {
  std::vector<int> number(static_cast<std::size_t>(mesh.point_count()), -1);
  for (const int p : mesh.cells.reshaped()) number[static_cast<std::size_t>(p)] = 0;
  std::vector<int> kept;
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<int>(kept.size());
    kept.push_back(static_cast<int>(p));
  }
  mesh.points = Eigen::Matrix3Xd(mesh.points(Eigen::all, kept));
  for (auto& [name, field] : mesh.point_fields) field = Eigen::MatrixXd(field(Eigen::all, kept));
  for (int& p : mesh.cells.reshaped()) p = number[static_cast<std::size_t>(p)];
  for (auto& [name, set] : mesh.node_sets) {
    std::vector<int> left;
    for (const int p : set) {
      if (number[static_cast<std::size_t>(p)] >= 0) left.push_back(number[static_cast<std::size_t>(p)]);
    }
    set = std::move(left);
  }
}

}  // namespace

Mesh reduce(const Mesh& mesh, CellType type) {
  if (type == mesh.type) return mesh;
  const int nodes = data::nodes_per_cell(type);
  if (is_hexahedron(type) != is_hexahedron(mesh.type) || nodes > data::nodes_per_cell(mesh.type))
    refuse(mesh.type, data::to_string(type), "only nodes can be dropped here");
  Mesh result = mesh;
  result.type = type;
  result.cells = Eigen::MatrixXi(mesh.cells.topRows(nodes));
  drop_unused_points(result);
  return result;
}

Mesh split_into_tetrahedra(const Mesh& mesh) {
  if (mesh.type != CellType::hex8 && mesh.type != CellType::hex27) {
    refuse(mesh.type, "tetrahedra",
           mesh.type == CellType::hex20 ? "elevate to hex27 first" : "only hexahedra are split");
  }
  const bool quadratic = mesh.type == CellType::hex27;
  // Node of the hexahedron between two corners: of an edge, a face or the cell.
  static const auto between = [] {
    Eigen::Matrix<int, 8, 8> table = Eigen::Matrix<int, 8, 8>::Constant(26);
    for (int f = 0; f < 6; ++f) {
      const auto nodes = data::face_nodes(CellType::hex27, f);
      for (std::size_t i = 0; i < 4; ++i) {
        const int a = nodes[i], b = nodes[(i + 1) % 4], opposite = nodes[(i + 2) % 4];
        table(a, b) = table(b, a) = nodes[4 + i];
        table(a, opposite) = table(opposite, a) = nodes[8];
      }
    }
    return table;
  }();
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};

  Mesh result;
  result.type = quadratic ? CellType::tet10 : CellType::tet4;
  result.points = mesh.points;
  result.regions = mesh.regions;
  result.node_sets = mesh.node_sets;
  result.point_fields = mesh.point_fields;
  result.cells.resize(quadratic ? 10 : 4, 6 * static_cast<Eigen::Index>(mesh.cell_count()));
  std::vector<int> parent;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const auto number = [&](int local) { return mesh.cells(local, c); };
    int apex = 0;
    for (int i = 1; i < 8; ++i) {
      if (number(i) < number(apex)) apex = i;
    }
    int made = 0;
    for (int f = 0; f < 6; ++f) {
      const auto nodes = data::face_nodes(CellType::hex8, f);
      if (std::ranges::count(nodes, apex)) continue;
      std::size_t low = 0;
      for (std::size_t i = 1; i < 4; ++i) {
        if (number(nodes[i]) < number(nodes[low])) low = i;
      }
      for (std::size_t half = 1; half <= 2; ++half) {
        // Seen from the apex, a face's outward corners run clockwise: reversed they make the base of a
        // tetrahedron.
        const int corner[4] = {nodes[low], nodes[(low + half + 1) % 4], nodes[(low + half) % 4], apex};
        const auto cell = static_cast<Eigen::Index>(parent.size());
        for (int i = 0; i < 4; ++i) result.cells(i, cell) = number(corner[i]);
        for (int e = 0; quadratic && e < 6; ++e)
          result.cells(4 + e, cell) = number(between(corner[edges[e][0]], corner[edges[e][1]]));
        parent.push_back(c);
        result.region_of_cell.push_back(mesh.region_of_cell[static_cast<std::size_t>(c)]);
        ++made;
      }
    }
    if (made != 6) refuse(mesh.type, "tetrahedra", "a cell uses a point twice");
  }
  for (const auto& [name, field] : mesh.cell_fields)
    result.cell_fields[name] = Eigen::MatrixXd(field(Eigen::all, parent));

  // A tetrahedron's face lies in a face of its own hexahedron if its three corners do.
  for (const data::NamedSurface& surface : mesh.surfaces) {
    data::NamedSurface split{surface.name, {}};
    for (const data::CellFace& face : surface.faces) {
      std::array<int, 4> corners{};
      const auto local = data::face_nodes(CellType::hex8, face.face);
      for (std::size_t i = 0; i < 4; ++i) corners[i] = mesh.cells(local[i], face.cell);
      for (int t = 6 * face.cell; t < 6 * face.cell + 6; ++t) {
        for (int f = 0; f < 4; ++f) {
          const auto triangle = data::face_nodes(CellType::tet4, f);
          if (std::ranges::all_of(triangle,
                                  [&](int i) { return std::ranges::count(corners, result.cells(i, t)); }))
            split.faces.push_back({t, f});
        }
      }
    }
    result.surfaces.push_back(std::move(split));
  }
  return result;
}

Mesh as_type(Mesh hex27, CellType type) {
  if (is_hexahedron(type)) return reduce(hex27, type);
  return reduce(split_into_tetrahedra(hex27), type);
}

}  // namespace brachium::fem
