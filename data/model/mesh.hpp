#pragma once
/// A volume mesh with named regions and surfaces, as solvers use it and files carry it. Plain values, no I/O.
///
/// Nodes of a cell are numbered as in VTK (VTK file formats, kitware; "vtkTriQuadraticHexahedron" and kin):
///   tet4   0-3 corners
///   tet10  tet4, then edges 01 12 20 03 13 23
///   hex8   0-3 bottom face counter-clockwise seen from the top, 4-7 the top face above them
///   hex20  hex8, then edges 01 12 23 30 | 45 56 67 74 | 04 15 26 37
///   hex27  hex20, then face centres -x (0473) +x (1562) -y (0154) +y (3267) -z (0321) +z (4567), then the
///   centre
/// Local coordinates: hexahedra in [-1, 1]^3 with node 0 at (-1,-1,-1), 1 at (1,-1,-1), 3 at (-1,1,-1), 4 at
/// (-1,-1,1); tetrahedra with node 0 at the origin, 1, 2, 3 at the unit points.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::data {

enum class CellType { tet4, tet10, hex8, hex20, hex27 };

int nodes_per_cell(CellType type);
int faces_per_cell(CellType type);    ///< 4 or 6
int corners_per_cell(CellType type);  ///< 4 or 8
std::string to_string(CellType type);

/// Local nodes of a face, corners first and counter-clockwise seen from outside, then edge nodes in the same
/// order, then the face centre (hex27): 3, 4, 6, 8 or 9 entries.
/// Faces: hexahedra 0..5 = -x +x -y +y -z +z; tetrahedra 0..3 = the face opposite to node 0..3.
std::span<const int> face_nodes(CellType type, int face);

/// One face of one cell.
struct CellFace {
  int cell = 0;
  int face = 0;  ///< 0 .. faces_per_cell - 1
  auto operator<=>(const CellFace&) const = default;
};

struct NamedSurface {
  std::string name;
  std::vector<CellFace> faces;
};

struct Mesh {
  CellType type = CellType::hex8;
  Eigen::Matrix3Xd points;                              ///< 3 x n_points [m]
  Eigen::MatrixXi cells;                                ///< nodes_per_cell x n_cells, indices into points
  std::vector<std::string> regions;                     ///< names, unique
  std::vector<int> region_of_cell;                      ///< n_cells, indices into regions
  std::vector<NamedSurface> surfaces;                   ///< names unique
  std::map<std::string, std::vector<int>> node_sets;    ///< named points
  std::map<std::string, Eigen::MatrixXd> point_fields;  ///< components x n_points
  std::map<std::string, Eigen::MatrixXd> cell_fields;   ///< components x n_cells

  int point_count() const { return static_cast<int>(points.cols()); }
  int cell_count() const { return static_cast<int>(cells.cols()); }
  /// Throws InputError("missing-surface") / ("missing-region") with the nearest name.
  const NamedSurface& surface(const std::string& name) const;
  int region(const std::string& name) const;
  /// Points of a surface, sorted, each once.
  std::vector<int> surface_points(const std::string& name) const;
};

/// Faces that belong to one cell only, in the order of cells.
std::vector<CellFace> boundary_faces(const Mesh& mesh);

/// Finds the cells at a face by its corners.
class FaceTable {
 public:
  explicit FaceTable(const Mesh& mesh);
  /// The faces with these 3 or 4 corner points, in any order: none, one at the boundary, two inside.
  std::vector<CellFace> find(std::span<const int> corners) const;

  using Key = std::array<int, 4>;  ///< corner points, rising; -1 first for triangles
  struct Entry {
    Key key;
    CellFace face;
    auto operator<=>(const Entry&) const = default;
  };
  const std::vector<Entry>& entries() const { return entries_; }  ///< sorted: faces of one key stand together

 private:
  std::vector<Entry> entries_;
};

/// Structure: sizes agree, indices in range, names unique, no cell twice, at most two cells at a face and
/// these with the same edge nodes. Every mistake found, none thrown: codes mesh-empty, mesh-size, mesh-index,
/// mesh-not-finite, mesh-duplicate-name, mesh-repeated-point, mesh-duplicate-cell, mesh-shared-face,
/// mesh-nonconforming; empty when sound. Of each kind the first places are named, with the count. Geometry
/// (inverted cells) is judged by fem/mesh/quality.hpp.
std::vector<Diagnostic> check_structure(const Mesh& mesh);

}  // namespace brachium::data
