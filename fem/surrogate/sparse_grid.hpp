#pragma once
/// Sparse grids of states: pairs of hierarchical indices in angle and activation, closed under parents.

#include <array>
#include <set>
#include <vector>

#include "fem/surrogate/hierarchical_basis.hpp"
#include "fem/surrogate/samples.hpp"

namespace brachium::fem {

struct SparseIndex {
  HierarchicalIndex theta, alpha;
  auto operator<=>(const SparseIndex&) const = default;
};

class SparseGrid {
 public:
  explicit SparseGrid(SparseBoundary boundary) : boundary_(boundary) {}

  /// All points with |l| <= level + 1 (modified, levels from 1: 1, 5, 17, 49, 129 points for level 1 to 5) or
  /// |l| <= level (included, levels from 0: 4, 8, 17, 37, 81 points for level 0 to 4).
  static SparseGrid regular(SparseBoundary boundary, int level);

  SparseBoundary boundary() const { return boundary_; }
  const std::set<SparseIndex>& points() const { return points_; }
  std::size_t size() const { return points_.size(); }
  bool contains(const SparseIndex& p) const { return points_.contains(p); }

  /// Adds a point and all ancestors that are missing; returns what was added.
  std::vector<SparseIndex> insert(const SparseIndex& point);
  void erase(const SparseIndex& point) { points_.erase(point); }
  /// No point of the grid has it as parent.
  bool is_leaf(const SparseIndex& point) const;
  /// Children in both directions.
  static std::vector<SparseIndex> children_of(const SparseIndex& point);

 private:
  SparseBoundary boundary_;
  std::set<SparseIndex> points_;
};

/// Where a point of a grid over `bounds` lies.
StatePoint state_of(const SparseIndex& point, const StateBounds& bounds);

/// The hierarchical index of a state whose position in `bounds` is a multiple of 2^-max_level (to 1e-6);
/// throws InputError("not-a-grid") for any other.
SparseIndex index_of(const StatePoint& state, const StateBounds& bounds, SparseBoundary boundary,
                     int max_level);

}  // namespace brachium::fem
