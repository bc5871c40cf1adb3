#pragma once
/// Geometry of a mesh's cells judged before anything is solved on it.
///
///   symbol  identifier       unit  meaning
///   J       jacobian_*       m^3   det(dX/dxi), at the quadrature points and the nodes of a cell
///   -       jacobian_ratio   -     min J / max J of a cell: 1 for parallelepipeds and straight tetrahedra,
///   <= 0 inverted
///   -       scaled_jacobian  -     corner with the smallest det of unit edges: 1 for a cube's, <= 0
///   inverted; of
///                                  tetrahedra times sqrt 2, so that the regular one has 1
///   -       aspect           -     hexahedra: longest / shortest of the three axes that join opposite faces
///   (sums of four
///                                  edges); tetrahedra: longest edge / (2 sqrt 6 inradius), 1 for the regular
///                                  one
/// Sources: Stimpson, Ernst, Knupp, Pebay & Thompson 2007, The Verdict geometric quality library,
/// SAND2007-1751 (hexahedra: "aspect", "scaled Jacobian"; tetrahedra: "aspect ratio beta", "scaled
/// Jacobian").

#include <Eigen/Core>

#include "data/model/mesh.hpp"
#include "data/model/table.hpp"

namespace brachium::fem {

struct CellQuality {
  Eigen::VectorXd volume_m3;
  Eigen::VectorXd jacobian_min_m3;
  Eigen::VectorXd jacobian_ratio;
  Eigen::VectorXd scaled_jacobian;
  Eigen::VectorXd aspect;
};

/// One entry a cell. The mesh's structure must be sound (data::check_structure).
CellQuality cell_quality(const data::Mesh& mesh);

/// One row a region and one for all: cells, volume, and the worst value of each measure with its cell.
data::Table quality_table(const data::Mesh& mesh, const CellQuality& quality);

struct QualityLimits {
  double jacobian_ratio_min = 0.02;  ///< below: refused; must be >= 0 (an inverted cell always is)
  double scaled_jacobian_min = 0.0;
  double aspect_max = 500.0;
  bool several_parts = false;  ///< whether a mesh may fall into parts that share no points
  bool unused_points = false;  ///< whether there may be points of no cell
};

/// Everything wrong with structure, geometry and connectivity. Codes: mesh-* of data::check_structure;
/// inverted-cells, degenerate-cells (no volume to speak of: |J| below 1e-12 of the longest edge cubed),
/// distorted-cells, stretched-cells, disconnected-mesh, unused-points. Cells are named by index (from 0),
/// region and centre, the worst first.
std::vector<data::Diagnostic> check_quality(const data::Mesh& mesh, const QualityLimits& limits = {});

/// Throws InputError with all findings of check_quality, if any.
void require_quality(const data::Mesh& mesh, const QualityLimits& limits = {});

/// Parts of the mesh that share no points: the part of each cell, numbered by their first cells.
std::vector<int> connected_parts(const data::Mesh& mesh);

/// Points that no cell uses.
std::vector<int> unused_points(const data::Mesh& mesh);

}  // namespace brachium::fem
