#pragma once
/// A unipennate muscle: a parallelepiped of fibres between two sheets that run on into tendons.
///
///           z ^            _____________________________======  insertion tendon
///             |           /------------------------------        superficial aponeurosis
///             |          /  /  /  /  /  /  /  /  /  /  /         fibres at the pennation angle to x
///   ======____|_________/__/__/__/__/__/__/__/__/__/__/          deep aponeurosis
///   origin tendon       x = 0 ... length_m

#include "data/model/mesh.hpp"
#include "fem/mesh/axis.hpp"

namespace brachium::fem {

struct PennateOptions {
  data::CellType type = data::CellType::hex27;
  Axis length;                  ///< along x: what each sheet covers
  Axis width;                   ///< along y
  Axis thickness;               ///< along z: distance of the sheets; the cells follow the fibres
  double pennation_rad = 0.35;  ///< in [0.05, pi/2]; fibre length = thickness / sin(pennation)
  Axis aponeurosis{0.0, 1};     ///< thickness of each sheet; 0: none, and then no tendons
  Axis tendon{0.0, 2};          ///< length of each tendon beyond the sheet; 0: none
};

/// Regions muscle, aponeurosis_deep, aponeurosis_superficial, tendon_origin, tendon_insertion (those there
/// are). Surfaces: origin and insertion (free ends of the tendons; of the sheets if there are none; the lower
/// and upper side of the muscle if there are no sheets either), deep, superficial (outer sides of the
/// sheets), y0, y1, proximal, distal (the oblique ends of the muscle). Cell fields `fibre` (along x in sheets
/// and tendons) and `gamma_M` (1 in muscle, else 0). Throws InputError("bad-mesh-option").
data::Mesh pennate_belly(const PennateOptions& options);

}  // namespace brachium::fem
