#pragma once
/// Rings of round cross-sections. For the .cpp files of this folder only.

#include "fem/mesh/cylinder.hpp"

namespace brachium::fem {

/// Outer radii of the rings between core_radius and outer.
std::vector<double> round_section_radii(const RoundSection& section, double core_radius, double outer);

}  // namespace brachium::fem
