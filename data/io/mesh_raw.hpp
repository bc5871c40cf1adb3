#pragma once
/// What every reader of meshes gathers, and how it becomes a mesh. For the .cpp files of data/io only.

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "data/io/mesh_file.hpp"

namespace brachium::io {

/// Names in the order of their first use.
class NameList {
 public:
  int index(const std::string& name) {
    const auto [found, is_new] = numbers_.try_emplace(name, static_cast<int>(names.size()));
    if (is_new) names.push_back(name);
    return found->second;
  }
  std::vector<std::string> names;

 private:
  std::unordered_map<std::string, int> numbers_;
};

struct RawMesh {
  std::filesystem::path file;
  std::vector<Eigen::Vector3d> points;  ///< in the file's unit

  /// Volume cells: types, regions, and their nodes back to back in the order of data/model/mesh.hpp.
  std::vector<data::CellType> types;
  std::vector<int> region_of_cell;
  std::vector<int> nodes;
  NameList regions;

  /// 2D cells: 3 or 4 corners (-1 at the end of triangles) and the surface they belong to.
  struct Facet {
    std::array<int, 4> corners{-1, -1, -1, -1};
    int surface = 0;
  };
  std::vector<Facet> facets;
  NameList surfaces;

  std::map<std::string, std::vector<int>> node_sets;
  std::map<std::string, Eigen::MatrixXd> point_fields;  ///< components x points
  std::map<std::string, Eigen::MatrixXd> cell_fields;   ///< components x volume cells
  std::vector<data::Diagnostic> notes;

  void note(std::string message) {
    notes.push_back({data::Severity::note, "mesh-reading", std::move(message), std::nullopt, ""});
  }
  /// `file_nodes` in the file's order; order[a] is the place of our node a in it.
  void add_cell(data::CellType type, int region, const std::vector<int>& file_nodes, const int* order);
};

/// Orders of nodes that are VTK's: corners, edges, faces, centre.
extern const int vtk_order[27];

/// Scales to metres, matches 2D cells with faces of volume cells, drops points that no volume cell uses
/// (noted), and checks the structure. Throws InputError.
MeshFile assemble(RawMesh raw, const MeshReadOptions& options);

/// Metres in one unit of the file. Throws InputError("mesh-unit-missing" | "wrong-unit" | "unknown-unit").
double metres_per_unit(const std::filesystem::path& file, const MeshReadOptions& options);

}  // namespace brachium::io
