#pragma once
/// Volume meshes from files of other programs: regions and surfaces by name, nodes in the order of
/// data/model/mesh.hpp, lengths in metres.
///
/// | format                            | regions                  | surfaces              | fields                       |
/// |-----------------------------------|--------------------------|-----------------------|------------------------------|
/// | Gmsh .msh 2.2 and 4.1,            | physical volumes         | physical surfaces     | $NodeData, $ElementData      |
/// |   ASCII and binary                |                          |                       |                              |
/// | VTU .vtu: ASCII, base64, raw,     | cell array               | 2D cells, by the same | point and cell arrays        |
/// |   zlib; legacy VTK .vtk, ASCII    |   `region_array` of      |   array               |                              |
/// |   and binary                      |   integers or texts      |                       |                              |
/// | FEBio .feb 2.5, 3.0, 4.0          | Elements blocks          | Surface               | ElementSets as 0/1; MeshData |
/// |                                   |   (domains)              |                       |   (fiber, mat_axis_a and _d, |
/// |                                   |                          |                       |   tables of the user's)      |
///
/// Sources: Gmsh 4.11 reference manual, ch. 10 "Gmsh file formats"; VTK file formats (docs.vtk.org, "VTK XML
/// formats", "VTK legacy file formats"); FEBio 4.0 user's manual, ch. 3 "Mesh section" and "MeshData section".
///
/// What a reader cannot take is refused with file and line (text) or byte (binary): codes mesh-unit-missing,
/// mesh-truncated, mesh-syntax, mesh-unsupported, mesh-cell-type, mesh-mixed-cells, mesh-unmatched-surface,
/// mesh-double-region, and those of data::check_structure.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "data/model/mesh.hpp"

namespace brachium::io {

struct MeshReadOptions {
  std::string length_unit;              ///< "m", "cm", "mm", ...: mesh files state none, so it must be given
  std::string region_array = "region";  ///< VTU and VTK: the cell array that tells regions and surfaces
  /// VTU and VTK: names of the integers in region_array; others are called by their number.

  std::map<long long, std::string> region_names;
};

struct MeshFile {
  data::Mesh mesh;
  std::vector<data::Diagnostic> notes;  ///< what was left out or assumed, e.g. points of no cell
};

/// By the file's extension: .msh, .vtu, .vtk, .feb. Throws InputError, also "mesh-unsupported" for other
/// extensions.
MeshFile read_mesh(const std::filesystem::path& file, const MeshReadOptions& options);

MeshFile read_gmsh(const std::filesystem::path& file, const MeshReadOptions& options);
MeshFile read_vtu(const std::filesystem::path& file, const MeshReadOptions& options);
MeshFile read_vtk(const std::filesystem::path& file, const MeshReadOptions& options);
MeshFile read_febio(const std::filesystem::path& file, const MeshReadOptions& options);

}  // namespace brachium::io
