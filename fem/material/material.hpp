#pragma once
/// The material laws by name, and what belongs to one region of a mesh.

#include <string>
#include <variant>

#include "fem/material/laws.hpp"
#include "fem/material/point.hpp"

namespace brachium::fem {

using Material = std::variant<MuscleTendon, NeoHooke, MooneyRivlin, FungGuccione, BlemkerMuscle>;

/// Volumetric energy U(J) of the condensed formulations; pressure p = U'(J), tension positive.
enum class VolumetricLaw {
  quadratic,        ///< k/2 (J - 1)^2
  logarithmic,      ///< k/2 (ln J)^2
};

/// Resistance to change of volume. `bulk_modulus_pa` infinite: exactly incompressible (Taylor-Hood, or augmented
/// Lagrange around `penalty_pa`).
struct Volumetric {
  VolumetricLaw law = VolumetricLaw::quadratic;
  double bulk_modulus_pa;
};

struct RegionMaterial {
  Material material;
  Volumetric volumetric;
};

/// Energy, stress and tangent at one point, in double precision (results, tests). The solver's kernels use the lanes
/// of fem/material/laws.inc, which this calls with one lane.
void evaluate(const Material& material, const MaterialPoint<double>& point, MaterialResponse<double>& response);

/// Whether the law has a preferred direction, an active part, a rate-dependent part.
bool needs_fibres(const Material& material);
bool is_active(const Material& material);
bool is_rate_dependent(const Material& material);

/// Throws InputError("parameter-range") naming law, parameter, value and allowed range.
void check(const Material& material);

}  // namespace brachium::fem
