#pragma once
/// An unstructured grid as VTK's file formats hold it, on its way to a mesh. For the .cpp files of data/io
/// only.

#include <string>
#include <vector>

#include "data/io/mesh_cursor.hpp"
#include "data/io/mesh_raw.hpp"

namespace brachium::io {

struct VtkArray {
  std::string name;
  std::size_t components = 1;
  std::vector<double> numbers;
  std::vector<std::string> texts;  ///< instead of numbers
  std::size_t tuples() const { return texts.empty() ? numbers.size() / components : texts.size(); }
};

struct VtkGrid {
  std::vector<double> points;  ///< 3 per point
  std::vector<double> connectivity, types;
  std::vector<double> offsets;  ///< end of each cell in connectivity
  std::vector<VtkArray> point_arrays, cell_arrays;
};

/// Cells by VTK's types; regions and surfaces by options.region_array. Mistakes are told through `in`.
RawMesh raw_mesh(const VtkGrid& grid, const MeshCursor& in, const MeshReadOptions& options);

}  // namespace brachium::io
