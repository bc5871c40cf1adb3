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
  quadratic,    ///< k/2 (J - 1)^2
  logarithmic,  ///< k/2 (ln J)^2
};

/// Resistance to change of volume. `bulk_modulus_pa` infinite: exactly incompressible (Taylor-Hood, or
/// augmented Lagrange around `penalty_pa`).
struct Volumetric {
  VolumetricLaw law = VolumetricLaw::quadratic;
  double bulk_modulus_pa = not_given;
};

struct RegionMaterial {
  Material material;
  Volumetric volumetric;
};

/// Energy, stress and tangent at one point, in double precision (results, tests). The solver's kernels use
/// the lanes of fem/material/laws.inc; this is the same text with one lane and the C library's functions.
///
/// A law that is_rate_dependent() has no potential where inverse_dt > 0: `energy` then holds the isometric
/// active part, so that it belongs to the stress only as the rate vanishes. A search along a line that
/// compares energies must not be used with it.
void evaluate(const Material& material, const MaterialPoint<double>& point,
              MaterialResponse<double>& response);

/// The same at four points at once, by the instruction set that this machine runs best.
void evaluate(const Material& material, const MaterialPoint<Lanes>& point, MaterialResponse<Lanes>& response);

/// The same by a named instruction set, so that they can be compared and timed. `avx2` without such a machine
/// throws std::logic_error; see has_avx2().
enum class InstructionSet { baseline, avx2 };
void evaluate(const Material& material, InstructionSet set, Wanted wanted, const MaterialPoint<Lanes>& point,
              MaterialResponse<Lanes>& response);
bool has_avx2();

/// "muscle_tendon", "neo_hooke", "mooney_rivlin", "fung_guccione", "blemker_muscle".
std::string law_name(const Material& material);

/// Whether the law has a preferred direction, an active part, a rate-dependent part.
bool needs_fibres(const Material& material);
bool is_active(const Material& material);
bool is_rate_dependent(const Material& material);

/// Throws InputError("bad-parameter") with every parameter out of range: law, parameter, value, allowed
/// range.
void check(const Material& material);
/// The same for the bulk modulus: > 0, infinity for exactly incompressible.
void check(const Volumetric& volumetric);

}  // namespace brachium::fem
