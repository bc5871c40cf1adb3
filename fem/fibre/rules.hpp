#pragma once
/// What a user asks of fibres and tissues, as plain values: rules that each fill some regions of a mesh.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace brachium::fem {

/// One direction everywhere; any length but zero.
struct ConstantFibres {
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

/// Unit vectors that the mesh brings along, by point (interpolated) or by cell; by point where there are
/// both. Vectors count as axes: where two points of a cell differ in sign only, nothing cancels.
struct MeshFieldFibres {
  std::string field;
};

/// Tangent dx/dxi_axis of the cells' own coordinates, hexahedra only.
struct MeshLineFibres {
  int axis = 0;  ///< 0, 1, 2
};

/// Rotation of fibres by `angle_rad` about a fixed axis (right hand), in the plane that the axis is normal
/// to.
struct Pennation {
  double angle_rad = 0.0;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();  ///< any length but zero
};

/// grad phi/|grad phi| of the harmonic function phi, 0 on `origin` and 1 on `insertion`, without flux through
/// the rest of the regions' boundary; from origin to insertion.
struct HarmonicFibres {
  std::string origin;  ///< surfaces of the mesh
  std::string insertion;
  std::optional<Pennation> pennation;
};

struct FibreRule {
  std::vector<std::string> regions;  ///< empty: all
  std::variant<ConstantFibres, MeshFieldFibres, MeshLineFibres, HarmonicFibres> source;
};

/// A number in [0, 1]: one value, or a field with one component that the mesh brings along, by point or by
/// cell; by point where there are both.
struct FractionRule {
  std::vector<std::string> regions;  ///< empty: all
  std::variant<double, std::string> source = 0.0;
};

struct TissueRules {
  std::vector<FibreRule> fibres;          ///< no rule for a region: it has no fibres
  std::vector<FractionRule> muscle;       ///< gamma_M; no rule: 1
  std::vector<FractionRule> soft_tissue;  ///< gamma_ST; no rule: 0
};

}  // namespace brachium::fem
