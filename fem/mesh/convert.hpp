#pragma once
/// The same body in other cells: higher or lower order, tetrahedra from hexahedra, halved cells. Regions,
/// surfaces, node sets and fields go along. A new point belongs to a node set if all points that it is
/// interpolated from do; point fields are interpolated, and directions are not normalised again.

#include "data/model/mesh.hpp"

namespace brachium::fem {

/// hex8 -> hex20, hex27; hex20 -> hex27; tet4 -> tet10: new nodes at the images of their local coordinates,
/// shared by neighbours. The same type: unchanged. Throws InputError("cell-type-mismatch") for other pairs.
data::Mesh elevate(const data::Mesh& mesh, data::CellType type);

/// hex27 -> hex20, hex8; hex20 -> hex8; tet10 -> tet4: surplus nodes dropped, with the points that nothing
/// uses then. Curved faces become straight. Throws InputError("cell-type-mismatch") for other pairs.
data::Mesh reduce(const data::Mesh& mesh, data::CellType type);

/// hex8 -> tet4, hex27 -> tet10 (its curved edges kept): six tetrahedra a cell, each face cut by the diagonal
/// at its point of lowest number, so that neighbours conform whatever the mesh (the pulling triangulation; De
/// Loera, Rambau & Santos 2010, doi:10.1007/978-3-642-12971-1, 4.3.2). Throws
/// InputError("cell-type-mismatch") for other cells.
data::Mesh split_into_tetrahedra(const data::Mesh& mesh);

/// From hexahedra with 27 nodes to any type, by the above.
data::Mesh as_type(data::Mesh hex27, data::CellType type);

/// Every cell into eight of its own type, on the geometry that its shape functions give.
data::Mesh refine(const data::Mesh& mesh);

}  // namespace brachium::fem
