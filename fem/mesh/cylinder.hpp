#pragma once
/// Round and fusiform bodies along z, on O-grid cross-sections: no degenerate cells.

#include "data/model/mesh.hpp"
#include "fem/mesh/axis.hpp"

namespace brachium::fem {

/// Cells of a round cross-section: a core of core_cells x core_cells, then ring_cells rings; 4 core_cells
/// around.
struct RoundSection {
  int core_cells = 2;
  int ring_cells = 1;
  double ring_grading = 1.0;  ///< thickness of the outermost ring / that of the innermost
};

struct CylinderOptions {
  data::CellType type = data::CellType::hex27;
  double radius_m = 0.0;
  double radius_y_m = 0.0;  ///< of an elliptic cross-section; 0: circular
  Axis z;
  RoundSection section;
  std::string region = "cylinder";
};

/// Surfaces z0 z1 side; cell field `fibre` along z. Throws InputError("bad-mesh-option").
data::Mesh cylinder(const CylinderOptions& options);

/// Fusiform muscle: tendon (z from 0) - belly - tendon.
///
///   belly radius  r(s) = r_t + (r_b - r_t) sin^2(pi s),  s in [0, 1] along the belly; or a monotone cubic
///   through `profile_m`, radii at evenly spaced s from 0 to 1 (the tendons then have the radii of its ends)
///
/// Regions tendon_origin, muscle, tendon_insertion, aponeurosis_origin, aponeurosis_insertion (those there
/// are). Surfaces origin (z = 0), insertion (far end), side (all around), belly (side of the muscle and its
/// sheets). Fields: `fibre` at points and cells, tangent to the mesh lines; `gamma_M` of cells: 1 in muscle,
/// 0 elsewhere; with a transition also of points.
struct SpindleOptions {
  data::CellType type = data::CellType::hex27;
  Axis origin_tendon{0.0, 2};  ///< length 0: none
  Axis belly{0.0, 12};
  Axis insertion_tendon{0.0, 2};  ///< length 0: none
  double belly_radius_m = 0.0;
  double tendon_radius_m = 0.0;
  std::vector<double> profile_m;  ///< instead of the two radii
  double flatness = 1.0;          ///< radius along y / radius along x
  RoundSection section;
  /// Sheets that continue the tendons on the belly's surface: their thickness as a share of the local radius
  /// (0: none), cells through it, and the share of the belly's length that each covers.
  double aponeurosis_thickness_norm = 0.0;
  int aponeurosis_cells = 1;
  double aponeurosis_origin_norm = 0.5;
  double aponeurosis_insertion_norm = 0.5;
  /// gamma_M rises from 0 at the tendons to 1 over this length inside the belly, as 3 t^2 - 2 t^3; 0: at
  /// once.
  double transition_m = 0.0;
};

/// Throws InputError("bad-mesh-option"); also if the sheets overlap, or a transition is asked beside sheets.
data::Mesh spindle(const SpindleOptions& options);

}  // namespace brachium::fem
