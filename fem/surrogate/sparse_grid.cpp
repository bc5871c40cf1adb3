#include "fem/surrogate/sparse_grid.hpp"

#include <fmt/format.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

HierarchicalIndex dyadic(double position, int lowest, int max_level, const StatePoint& state) {
  const int n = 1 << max_level;
  const double scaled = position * n, nearest = std::round(scaled);
  int index = static_cast<int>(nearest), level = max_level;
  const bool end = index == 0 || index == n;
  if (!(std::abs(scaled - nearest) < 1e-6 * n) || nearest < 0.0 || nearest > n || (end && lowest > 0)) {
    throw data::InputError(
        "not-a-grid",
        fmt::format(
            "the state at {:.6g} rad with activation {:.6g} is no point of a sparse grid of at most level {}",
            state.theta_rad, state.activation, max_level));
  }
  if (end) return {0, index == 0 ? 0 : 1};
  while (index % 2 == 0) {
    index /= 2;
    --level;
  }
  return {level, index};
}

}  // namespace

SparseGrid SparseGrid::regular(SparseBoundary boundary, int level) {
  const int lowest = lowest_level(boundary), sum = level + lowest;
  if (level < lowest || level > 10)
    throw data::InputError(
        "bad-option", fmt::format("a regular sparse grid of level {}: levels are {} to 10", level, lowest));
  SparseGrid grid(boundary);
  for (int lt = lowest; lt <= sum - lowest; ++lt) {
    for (int la = lowest; lt + la <= sum; ++la) {
      for (const HierarchicalIndex& t : level_indices(lt)) {
        for (const HierarchicalIndex& a : level_indices(la)) grid.points_.insert({t, a});
      }
    }
  }
  return grid;
}

std::vector<SparseIndex> SparseGrid::insert(const SparseIndex& point) {
  if (contains(point)) return {};
  points_.insert(point);
  std::vector<SparseIndex> added{point};
  const auto ancestors = [&](const SparseIndex& parent) {
    for (const SparseIndex& p : insert(parent)) added.push_back(p);
  };
  for (const HierarchicalIndex& t : parents(point.theta, boundary_)) ancestors({t, point.alpha});
  for (const HierarchicalIndex& a : parents(point.alpha, boundary_)) ancestors({point.theta, a});
  return added;
}

std::vector<SparseIndex> SparseGrid::children_of(const SparseIndex& point) {
  std::vector<SparseIndex> out;
  for (const HierarchicalIndex& t : children(point.theta)) out.push_back({t, point.alpha});
  for (const HierarchicalIndex& a : children(point.alpha)) out.push_back({point.theta, a});
  return out;
}

bool SparseGrid::is_leaf(const SparseIndex& point) const {
  for (const SparseIndex& child : children_of(point)) {
    if (contains(child)) return false;
  }
  return true;
}

StatePoint state_of(const SparseIndex& point, const StateBounds& bounds) {
  return {bounds.theta_lower_rad + bounds.theta_span() * point.theta.position(),
          bounds.activation_lower + bounds.activation_span() * point.alpha.position()};
}

SparseIndex index_of(const StatePoint& state, const StateBounds& bounds, SparseBoundary boundary,
                     int max_level) {
  const int lowest = lowest_level(boundary);
  return {dyadic((state.theta_rad - bounds.theta_lower_rad) / bounds.theta_span(), lowest, max_level, state),
          dyadic((state.activation - bounds.activation_lower) / bounds.activation_span(), lowest, max_level,
                 state)};
}

}  // namespace brachium::fem
