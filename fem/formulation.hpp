#pragma once
/// Finite elements by name: which displacements, which pressure, and where the pressure goes in the linear algebra.
///
/// | name                  | cells | displacement                   | pressure                   | solved as             |
/// |-----------------------|-------|--------------------------------|----------------------------|-----------------------|
/// | q2_p1_discontinuous   | hex27 | tri-quadratic                  | linear per cell (in X)     | condensed, default    |
/// | q2_q1_taylor_hood     | hex27 | tri-quadratic                  | tri-linear, continuous     | saddle point, exact J |
/// | q1_p0                 | hex8  | tri-linear                     | constant per cell          | condensed             |
/// | p2_p1_taylor_hood     | tet10 | quadratic                      | linear, continuous         | saddle point, exact J |
/// | p2b_p1_discontinuous  | tet10 | quadratic + quartic bubble     | linear per cell (in X)     | condensed             |
/// | q1_displacement       | hex8  | tri-linear                     | none (locks; to show it)   | displacement only     |
/// | q2_displacement       | hex27 | tri-quadratic                  | none                       | displacement only     |
///
/// Sources: Boffi, Brezzi & Fortin 2013, doi:10.1007/978-3-642-36519-5, ch. 8 (stability of the pairs);
/// Simo, Taylor & Pister 1985, doi:10.1016/0045-7825(85)90033-7 (condensed pressure).

#include <string>
#include <vector>

#include "data/model/mesh.hpp"

namespace brachium::fem {

enum class Formulation {
  q2_p1_discontinuous,
  q2_q1_taylor_hood,
  q1_p0,
  p2_p1_taylor_hood,
  p2b_p1_discontinuous,
  q1_displacement,
  q2_displacement
};

enum class PressureSpace { none, constant, linear_discontinuous, continuous };

data::CellType cell_type(Formulation formulation);
PressureSpace pressure_space(Formulation formulation);
bool has_bubble(Formulation formulation);
std::string to_string(Formulation formulation);
/// Throws InputError("unknown-formulation") with the nearest name.
Formulation formulation_named(const std::string& name);
const std::vector<std::string>& formulation_names();

}  // namespace brachium::fem
