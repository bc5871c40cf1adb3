#pragma once
/// A muscle as a uniform strap with the continuum's law: what the continuum has to earn its cost against.
///
///   F = A P(λ, α),   λ = (L_path(q) - L_c)/L_0,   A = V/L_0
///
/// | symbol | meaning                                   | unit |
/// |--------|-------------------------------------------|------|
/// | P      | nominal stress along the fibre            | Pa   |
/// | V, L_0 | volume, length of the stress-free belly   | m3, m|
/// | L_c    | rigid tendon                              | m    |
///
/// Incompressible and uniaxial: P = 2 (λ - λ^-2)(c1 + c2/λ) + passive and active fibres. No contact, no held
/// ends, one stretch for all fibres. Meshed tendons are not modelled.

#include "fem/limb/muscle_body.hpp"

namespace brachium::fem {

/// P(λ, α) [Pa].
double uniaxial_stress_pa(const MuscleTendon& law, double stretch, double activation);

/// V/L_0 of the belly's profile [m2].
double mean_area_m2(const MuscleBody& body);

/// λ at an angle.
double strap_stretch(const MuscleBody& body, double q_rad);

/// F [N]. Throws InputError("limb-geometry") for a muscle with meshed tendons.
double strap_force_n(const MuscleBody& body, double q_rad, double activation);

}  // namespace brachium::fem
