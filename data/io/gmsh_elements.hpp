#pragma once
/// Gmsh's elements by number, and its order of nodes (Gmsh 4.11 reference manual, "Node ordering"). For the
/// .cpp files of data/io only.

#include <optional>

#include "data/model/mesh.hpp"

namespace brachium::io {

/// Place of our node a in Gmsh's list.
inline constexpr int gmsh_hexahedron_order[27] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 13, 9,  16, 18,
                                                  19, 17, 10, 12, 14, 15, 22, 23, 21, 24, 20, 25, 26};
inline constexpr int gmsh_tetrahedron_order[10] = {0, 1, 2, 3, 4, 5, 6, 7, 9, 8};

struct GmshElement {
  int nodes;
  int dimension;
  const char* name;
  std::optional<data::CellType> cell{};  ///< volume elements that can be used
};

/// Element types 1 .. 19 (first and second order); nothing for others.
std::optional<GmshElement> gmsh_element(long long type);

}  // namespace brachium::io
