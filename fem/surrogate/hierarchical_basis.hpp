#pragma once
/// Hierarchical cubic splines on [0, 1] with the not-a-knot condition (Valentin 2019,
/// doi:10.18419/opus-10504, ch. 3).
///
/// | symbol  | identifier   | meaning                                                                    |
/// |---------|--------------|----------------------------------------------------------------------------|
/// | l       | level        | mesh width 2^-l                                                            |
/// | i       | index        | odd in [1, 2^l - 1]; at level 0, of bases with boundary points, 0 or 1     |
/// | x_(l,i) | -            | i 2^-l                                                                     |
/// | φ_(l,i) | -            | basis function that belongs to x_(l,i)                                     |
///
/// From level 2 on, φ_(l,i) is the i-th cubic B-spline over the knots k 2^-l, k = -3 ... 2^l + 3, without k =
/// 1 and k = 2^l - 1. Levels 0 and 1 are the Lagrange polynomials of their 2 and 3 points.
///
/// The *modified* basis has no points on the boundary: φ_(1,1) = 1, and the first and last function of a
/// level get a multiple of their outer neighbour so that the second derivative vanishes at the end: functions
/// go on nearly linearly towards the boundary.

#include <Eigen/Core>
#include <compare>
#include <vector>

namespace brachium::fem {

enum class SparseBoundary {
  modified,  ///< no states on the boundary; reproduces linear functions
  included   ///< with them; reproduces cubic polynomials
};

struct HierarchicalIndex {
  int level = 0;
  int index = 0;
  auto operator<=>(const HierarchicalIndex&) const = default;

  double position() const { return static_cast<double>(index) / static_cast<double>(1 << level); }
};

/// Coarsest level of a basis: 1 without, 0 with boundary points.
inline int lowest_level(SparseBoundary boundary) {
  return boundary == SparseBoundary::modified ? 1 : 0;
}

/// The level's own indices.
std::vector<HierarchicalIndex> level_indices(int level);
std::vector<HierarchicalIndex> children(const HierarchicalIndex& at);
/// None at the lowest level, two (both ends) for the midpoint of a basis with boundary points, else one.
std::vector<HierarchicalIndex> parents(const HierarchicalIndex& at, SparseBoundary boundary);

/// φ_(l,i) and its derivatives up to the third at x in [0, 1], right-continuous at knots.
Eigen::Vector4d hierarchical_basis(SparseBoundary boundary, const HierarchicalIndex& of, double x);

}  // namespace brachium::fem
