#include "data/io/gmsh_elements.hpp"

namespace brachium::io {

std::optional<GmshElement> gmsh_element(long long type) {
  using data::CellType;
  static const GmshElement elements[19] = {
      {2, 1, "line2"},  // type 1
      {3, 2, "tri3"},
      {4, 2, "quad4"},
      {4, 3, "tet4", CellType::tet4},
      {8, 3, "hex8", CellType::hex8},
      {6, 3, "prism6"},
      {5, 3, "pyramid5"},
      {3, 1, "line3"},
      {6, 2, "tri6"},
      {9, 2, "quad9"},
      {10, 3, "tet10", CellType::tet10},
      {27, 3, "hex27", CellType::hex27},
      {18, 3, "prism18"},
      {14, 3, "pyramid14"},
      {1, 0, "point"},
      {8, 2, "quad8"},
      {20, 3, "hex20", CellType::hex20},
      {15, 3, "prism15"},
      {13, 3, "pyramid13"},
  };
  if (type < 1 || type > 19) return std::nullopt;
  return elements[type - 1];
}

}  // namespace brachium::io
