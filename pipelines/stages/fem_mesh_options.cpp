/// Options of the table `mesh` of fem.solve.

#include "pipelines/stages/fem_option_kinds.hpp"
#include "pipelines/stages/fem_options.hpp"

namespace brachium::pipelines {
namespace {

std::vector<OptionSpec> round_section_fields() {
  return {cells_option("core_cells", 2,
                       "cells along each side of the core of a cross-section; four times as many around"),
          cells_option("ring_cells", 1, "rings of cells around the core"),
          number_option("ring_grading", "1", 1.0, above(0.0),
                        "thickness of the outermost ring over that of the innermost")};
}

}  // namespace

OptionSpec fem_mesh_option() {
  OptionSpec file = optional_text("file", "mesh file: Gmsh .msh, VTK .vtu or .vtk, FEBio .feb");
  file.is_file = true;
  OptionSpec size = vector_option("size_m", "m", "lengths along x, y, z");
  size.optional = false;
  OptionSpec cells = vector_option("cells", "1", "cells along x, y, z");
  cells.optional = false;
  cells.lower = 1.0;
  std::vector<OptionSpec> round = round_section_fields();
  std::vector<OptionSpec> cylinder{
      required_number("radius_m", "m", above(0.0), "radius (along x where it is elliptic)"),
      optional_number("radius_y_m", "m", above(0.0), "radius along y; absent: circular"),
      required_number("length_m", "m", above(0.0), "length along z"),
      cells_option("cells", 8, "cells along z"),
      number_option("grading", "1", 1.0, above(0.0), "size of the last cell along z over that of the first"),
      text_option("region", "cylinder", "name of the region")};
  std::vector<OptionSpec> spindle{
      required_number("belly_m", "m", above(0.0), "length of the belly along z"),
      cells_option("belly_cells", 12, "cells along the belly"),
      number_option("belly_grading", "1", 1.0, above(0.0),
                    "length of a cell in the belly's middle over that of one at its ends"),
      required_number("belly_radius_m", "m", above(0.0), "largest radius"),
      required_number("tendon_radius_m", "m", above(0.0), "radius of the tendons"),
      number_option("origin_tendon_m", "m", 0.0, at_least(0.0),
                    "length of the tendon at the origin; 0: none"),
      cells_option("origin_tendon_cells", 2, "cells along it"),
      number_option("insertion_tendon_m", "m", 0.0, at_least(0.0),
                    "length of the tendon at the insertion; 0: none"),
      cells_option("insertion_tendon_cells", 2, "cells along it"),
      number_option("flatness", "1", 1.0, above(0.0), "radius along y over radius along x"),
      number_option("aponeurosis_thickness_norm", "1", 0.0, between(0.0, 0.9),
                    "thickness of the sheets on the belly over the local radius; 0: none"),
      cells_option("aponeurosis_cells", 1, "cells through a sheet"),
      number_option("aponeurosis_origin_norm", "1", 0.5, between(0.0, 1.0),
                    "share of the belly that the origin's sheet covers"),
      number_option("aponeurosis_insertion_norm", "1", 0.5, between(0.0, 1.0),
                    "share of the belly that the insertion's sheet covers"),
      number_option("transition_m", "m", 0.0, at_least(0.0),
                    "length inside the belly over which gamma_M rises from 0 to 1; 0: at once")};
  for (const OptionSpec& field : round) {
    cylinder.push_back(field);
    spindle.push_back(field);
  }
  std::vector<OptionSpec> pennate{
      required_number("length_m", "m", above(0.0), "what each sheet covers along x"),
      cells_option("length_cells", 8, "cells along it"),
      number_option("length_grading", "1", 1.0, above(0.0),
                    "length of a cell in the middle over that of one at the ends"),
      required_number("width_m", "m", above(0.0), "width along y"),
      cells_option("width_cells", 3, "cells along it"),
      required_number("thickness_m", "m", above(0.0), "distance of the sheets along z"),
      cells_option("thickness_cells", 4, "cells along the fibres"),
      number_option("thickness_grading", "1", 1.0, above(0.0),
                    "length of a cell halfway along the fibres over that of one at the sheets"),
      required_number("pennation_deg", "deg", between(3.0, 90.0), "angle of the fibres to x"),
      number_option("aponeurosis_m", "m", 0.0, at_least(0.0),
                    "thickness of each sheet; 0: no sheets and no tendons"),
      cells_option("aponeurosis_cells", 1, "cells through a sheet"),
      number_option("tendon_m", "m", 0.0, at_least(0.0), "length of each tendon beyond its sheet; 0: none"),
      cells_option("tendon_cells", 2, "cells along a tendon")};
  OptionSpec mesh = table_option(
      "mesh",
      {file,
       optional_text(
           "length_unit",
           "unit of a mesh file's coordinates (m, cm, mm); mesh files do not state it, so it must be given"),
       text_option("region_array", "region", "VTK files: the cell array that tells regions and surfaces"),
       map_option("region_numbers", {},
                  "VTK files: names of the numbers in that array, { muscle = 1, tendon = 2 }"),
       flag_option("elevate", false,
                   "add the midside nodes that the element needs (hex8 to hex27, tet4 to tet10); the faces "
                   "stay as they are"),
       integer_option("refine", 0, between(0, 5), "how many times every cell is cut into eight"),
       table_option(
           "block",
           {size, cells,
            vector_option("grading", "1", "size of the last cell over that of the first, along x, y, z"),
            vector_option("corner_m", "m", "lowest corner; absent: the origin"),
            text_option("region", "block", "name of the region")},
           "a generated block; surfaces x0 x1 y0 y1 z0 z1"),
       table_option("cylinder", std::move(cylinder), "a generated cylinder along z; surfaces z0 z1 side"),
       table_option("spindle", std::move(spindle),
                    "a generated fusiform muscle along z; regions tendon_origin, muscle, tendon_insertion "
                    "(and sheets), surfaces origin, insertion, side, belly"),
       table_option(
           "pennate", std::move(pennate),
           "a generated unipennate muscle; regions muscle, aponeurosis_*, tendon_*, surfaces "
           "origin, insertion, deep, superficial, y0, y1, proximal, distal, fields fibre (along the cells' "
           "second lines) and gamma_M")},
      "the body: either `file` or one of the generators");
  mesh.optional = false;
  return mesh;
}

}  // namespace brachium::pipelines
