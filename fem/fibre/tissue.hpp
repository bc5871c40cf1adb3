#pragma once
/// From rules to fibres and blending at the quadrature points, with the figures that a log shows.

#include "data/model/mesh.hpp"
#include "data/model/table.hpp"
#include "fem/fibre/field.hpp"
#include "fem/fibre/rules.hpp"
#include "fem/formulation.hpp"

namespace brachium::fem {

struct Tissue {
  TissueField field;
  /// One row a region with fibres: volume-weighted mean axis (fem/fibre/statistics.hpp) and angles to it.
  data::Table directions;
  /// One row a harmonic rule: unknowns, smallest and largest gradient, the cell with the smallest.
  data::Table harmonic;
  /// One row a fraction that rules give: mean, smallest and largest value over the points (volume-weighted
  /// mean), and at how many points interpolation left [0, 1] and was brought back.
  data::Table fractions;
};

/// Directions are unit vectors to rounding; where no rule reaches, they are zero. Throws InputError:
///   missing-region       a name that the mesh does not have, with the nearest; so missing-surface
///   missing-mesh-field   likewise for a field
///   bad-mesh-field       wrong number of components or of entries
///   bad-fibre            a vector that is zero or off unit length by more than 1e-3 (point or cell named),
///                        opposed directions in a cell, a vanishing gradient, mesh lines of tetrahedra
///   bad-fraction         a value outside [0, 1] (point or cell named)
///   bad-harmonic-fibres  origin and insertion touch; a part of the body that does not touch both
///   twice-given          two rules for one region
///   cell-type-mismatch   cells of the mesh are not those of the formulation
///   inverted-cell        a cell turned inside out, in harmonic fibres
Tissue build_tissue(const data::Mesh& mesh, Formulation formulation, const TissueRules& rules);

}  // namespace brachium::fem
