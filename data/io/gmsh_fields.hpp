#pragma once
/// Fields in Gmsh's files: $NodeData and $ElementData. For the .cpp files of data/io only.

#include <map>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "data/io/mesh_cursor.hpp"
#include "data/io/mesh_raw.hpp"

namespace brachium::io {

/// Values are kept by tag until all nodes and elements are known.
class GmshFields {
 public:
  /// One section, the cursor behind its first line.
  void read(MeshCursor& in, bool binary, bool of_nodes, RawMesh& raw);

  /// Into raw's fields, by the numbers of tags. What has no value gets 0, which is noted.
  void finish(RawMesh& raw, const std::unordered_map<long long, int>& point_of_node,
              const std::unordered_map<long long, int>& cell_of_element) const;

 private:
  using Rows = std::vector<std::pair<long long, std::vector<double>>>;
  std::map<std::pair<bool, std::string>, Rows> fields_;  // (of nodes, name)
};

}  // namespace brachium::io
