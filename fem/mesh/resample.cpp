/// New nodes at local coordinates of old cells: elevation of the order, and halved cells.

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "fem/element/shape.hpp"
#include "fem/mesh/convert.hpp"

namespace brachium::fem {
namespace {

using data::CellFace;
using data::CellType;
using data::Mesh;

/// A point as a combination of old points: (point, weight x 2^20), rising. All local coordinates are
/// multiples of 1/4, so that neighbours find the same weights exactly; on a face only that face's nodes have
/// any.
using Combination = std::vector<std::pair<int, int>>;

struct CombinationHash {
  std::size_t operator()(const Combination& c) const {
    std::size_t hash = c.size();
    for (const auto& [point, weight] : c) {
      hash ^= static_cast<std::size_t>(point) + 0x9e3779b97f4a7c15U + (hash << 6) + (hash >> 2);
      hash ^= static_cast<std::size_t>(weight) + 0x9e3779b97f4a7c15U + (hash << 6) + (hash >> 2);
    }
    return hash;
  }
};

/// Numbers combinations; old points keep their numbers.
class NewPoints {
 public:
  explicit NewPoints(const Mesh& mesh) : count_(mesh.point_count()) {}

  int number(Combination c) {
    if (c.size() == 1) return c.front().first;
    const auto [found, is_new] = numbers_.try_emplace(std::move(c), count_);
    if (is_new) {
      ++count_;
      order_.push_back(&found->first);
    }
    return found->second;
  }

  /// Points, point fields and node sets of `from`, with the new points behind.
  void fill(const Mesh& from, Mesh& to) const {
    to.points = extended(from.points);
    for (const auto& [name, field] : from.point_fields) to.point_fields[name] = extended(field);
    for (const auto& [name, set] : from.node_sets) {
      std::vector<char> in(static_cast<std::size_t>(from.point_count()), 0);
      for (const int p : set) in[static_cast<std::size_t>(p)] = 1;
      std::vector<int> list = set;
      for (std::size_t i = 0; i < order_.size(); ++i) {
        bool all = true;
        for (const auto& [point, weight] : *order_[i]) all = all && in[static_cast<std::size_t>(point)];
        if (all) list.push_back(from.point_count() + static_cast<int>(i));
      }
      to.node_sets[name] = std::move(list);
    }
  }

 private:
  Eigen::MatrixXd extended(const Eigen::MatrixXd& old) const {
    Eigen::MatrixXd all(old.rows(), count_);
    all.leftCols(old.cols()) = old;
    for (std::size_t i = 0; i < order_.size(); ++i) {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(old.rows());
      for (const auto& [point, weight] : *order_[i]) sum += std::ldexp(weight, -20) * old.col(point);
      all.col(old.cols() + static_cast<Eigen::Index>(i)) = sum;
    }
    return all;
  }

  int count_;
  std::unordered_map<Combination, int, CombinationHash> numbers_;
  std::vector<const Combination*> order_;
};

/// Weights of a cell's nodes at local points, one column each, in units of 2^-20.
Eigen::MatrixXi weights_at(CellType type, const Eigen::Matrix3Xd& local) {
  Eigen::MatrixXi weights(data::nodes_per_cell(type), local.cols());
  for (Eigen::Index i = 0; i < local.cols(); ++i) {
    weights.col(i) =
        (cell_shape(type, local.col(i)).value * std::ldexp(1.0, 20)).array().round().matrix().cast<int>();
  }
  return weights;
}

Combination combination(const Mesh& mesh, int cell, const Eigen::Ref<const Eigen::VectorXi>& weights) {
  Combination c;
  for (Eigen::Index a = 0; a < weights.size(); ++a) {
    if (weights[a] != 0) c.emplace_back(mesh.cells(a, cell), weights[a]);
  }
  std::sort(c.begin(), c.end());
  return c;
}

/// Local coordinates of the nodes of each of the eight parts of a cell.
std::vector<Eigen::Matrix3Xd> parts_of(CellType type) {
  const Eigen::Matrix3Xd& nodes = node_coordinates(type);
  std::vector<Eigen::Matrix3Xd> parts;
  if (data::corners_per_cell(type) == 8) {
    for (int p = 0; p < 8; ++p) {
      const Eigen::Vector3d shift(p & 1 ? 0.5 : -0.5, p & 2 ? 0.5 : -0.5, p & 4 ? 0.5 : -0.5);
      parts.emplace_back((0.5 * nodes).colwise() + shift);
    }
    return parts;
  }
  // Four tetrahedra at the corners, four around the diagonal from the middle of edge 02 to that of edge 13.
  Eigen::Matrix3Xd x(3, 10);
  x << 0, 1, 0, 0, .5, .5, 0, 0, .5, 0,  //
      0, 0, 1, 0, 0, .5, .5, 0, 0, .5,   //
      0, 0, 0, 1, 0, 0, 0, .5, .5, .5;
  constexpr int corners[8][4] = {{0, 4, 6, 7}, {4, 1, 5, 8}, {6, 5, 2, 9}, {7, 8, 9, 3},
                                 {6, 8, 4, 5}, {6, 8, 5, 9}, {6, 8, 9, 7}, {6, 8, 7, 4}};
  for (const auto& c : corners) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = x.col(c[i + 1]) - x.col(c[0]);
    // Positive volume, so that the part's own reference cell maps onto it without turning over.
    if (edges.determinant() < 0.0) edges.col(1).swap(edges.col(2));
    parts.emplace_back((edges * nodes).colwise() + x.col(c[0]));
  }
  return parts;
}

/// The faces of parts that make up each face of a cell: those whose corners lie in its plane.
std::vector<std::vector<CellFace>> face_parts(CellType type, const std::vector<Eigen::Matrix3Xd>& parts) {
  const bool hexahedron = data::corners_per_cell(type) == 8;
  const auto distance = [&](int face, const Eigen::Vector3d& x) {
    if (hexahedron) return std::abs(x[face / 2] - (face % 2 ? 1.0 : -1.0));
    return face == 0 ? std::abs(1.0 - x.sum()) : std::abs(x[face - 1]);
  };
  std::vector<std::vector<CellFace>> lists(static_cast<std::size_t>(data::faces_per_cell(type)));
  for (int face = 0; face < data::faces_per_cell(type); ++face) {
    for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
      for (int f = 0; f < data::faces_per_cell(type); ++f) {
        bool inside = true;
        for (const int a : data::face_nodes(type, f))
          inside = inside && distance(face, parts[static_cast<std::size_t>(p)].col(a)) < 1e-9;
        if (inside) lists[static_cast<std::size_t>(face)].push_back({p, f});
      }
    }
  }
  return lists;
}

}  // namespace

Mesh elevate(const Mesh& mesh, CellType type) {
  if (type == mesh.type) return mesh;
  if (data::corners_per_cell(type) != data::corners_per_cell(mesh.type) ||
      data::nodes_per_cell(type) < data::nodes_per_cell(mesh.type)) {
    throw data::InputError("cell-type-mismatch",
                           fmt::format("cells of type {} cannot be raised to {}", data::to_string(mesh.type),
                                       data::to_string(type)),
                           "hex8 can become hex20 or hex27, hex20 hex27, and tet4 tet10");
  }
  const Eigen::MatrixXi weights = weights_at(mesh.type, node_coordinates(type));
  NewPoints points(mesh);
  Mesh result = mesh;
  result.type = type;
  result.cells.resize(weights.cols(), mesh.cell_count());
  for (int c = 0; c < mesh.cell_count(); ++c) {
    for (Eigen::Index a = 0; a < weights.cols(); ++a)
      result.cells(a, c) = points.number(combination(mesh, c, weights.col(a)));
  }
  points.fill(mesh, result);
  return result;
}

Mesh refine(const Mesh& mesh) {
  const auto parts = parts_of(mesh.type);
  const int count = static_cast<int>(parts.size());
  std::vector<Eigen::MatrixXi> weights;
  for (const auto& part : parts) weights.push_back(weights_at(mesh.type, part));
  NewPoints points(mesh);
  Mesh result;
  result.type = mesh.type;
  result.regions = mesh.regions;
  result.cells.resize(mesh.cells.rows(), static_cast<Eigen::Index>(count) * mesh.cell_count());
  std::vector<int> parent;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    for (int p = 0; p < count; ++p) {
      const auto& w = weights[static_cast<std::size_t>(p)];
      for (Eigen::Index a = 0; a < w.cols(); ++a)
        result.cells(a, count * c + p) = points.number(combination(mesh, c, w.col(a)));
      parent.push_back(c);
      result.region_of_cell.push_back(mesh.region_of_cell[static_cast<std::size_t>(c)]);
    }
  }
  points.fill(mesh, result);
  for (const auto& [name, field] : mesh.cell_fields)
    result.cell_fields[name] = Eigen::MatrixXd(field(Eigen::all, parent));
  const auto faces = face_parts(mesh.type, parts);
  for (const data::NamedSurface& surface : mesh.surfaces) {
    data::NamedSurface fine{surface.name, {}};
    for (const CellFace& f : surface.faces) {
      for (const CellFace& part : faces[static_cast<std::size_t>(f.face)])
        fine.faces.push_back({count * f.cell + part.cell, part.face});
    }
    result.surfaces.push_back(std::move(fine));
  }
  return result;
}

}  // namespace brachium::fem
