#include "fem/surrogate/hierarchical_basis.hpp"

#include "fem/surrogate/piecewise.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector4d;

std::vector<double> knots(int level) {
  const int n = 1 << level;
  std::vector<double> k;
  for (int i = -3; i <= n + 3; ++i) {
    if (i != 1 && i != n - 1) k.push_back(static_cast<double>(i) / n);
  }
  return k;
}

// B-spline `index` of a level >= 2 and its derivatives.
Vector4d spline(int level, int index, double x) {
  const SplineValues b = bsplines(knots(level), 3, x, 3);
  const Eigen::Index r = index - static_cast<Eigen::Index>(b.first);
  if (r < 0 || r > 3) return Vector4d::Zero();
  return b.derivative.col(r);
}

// Lagrange polynomials of the points 0, 1 and of 0, 1/2, 1.
Vector4d lagrange(int level, int index, double x) {
  if (level == 0) return index == 0 ? Vector4d(1.0 - x, -1.0, 0.0, 0.0) : Vector4d(x, 1.0, 0.0, 0.0);
  return {4.0 * x * (1.0 - x), 4.0 - 8.0 * x, -8.0, 0.0};
}

}  // namespace

std::vector<HierarchicalIndex> level_indices(int level) {
  if (level == 0) return {{0, 0}, {0, 1}};
  std::vector<HierarchicalIndex> out;
  for (int i = 1; i < (1 << level); i += 2) out.push_back({level, i});
  return out;
}

std::vector<HierarchicalIndex> children(const HierarchicalIndex& at) {
  if (at.level == 0) return {{1, 1}};
  return {{at.level + 1, 2 * at.index - 1}, {at.level + 1, 2 * at.index + 1}};
}

std::vector<HierarchicalIndex> parents(const HierarchicalIndex& at, SparseBoundary boundary) {
  if (at.level <= lowest_level(boundary)) return {};
  if (at.level == 1) return {{0, 0}, {0, 1}};
  const int half = at.index / 2;  // of the two neighbours on the level above, the odd one is its own
  return {{at.level - 1, half % 2 == 1 ? half : half + 1}};
}

Vector4d hierarchical_basis(SparseBoundary boundary, const HierarchicalIndex& of, double x) {
  const auto [level, index] = of;
  if (boundary == SparseBoundary::included)
    return level < 2 ? lagrange(level, index, x) : spline(level, index, x);
  if (level == 1) return Vector4d(1.0, 0.0, 0.0, 0.0);
  const int last = (1 << level) - 1;
  Vector4d phi = spline(level, index, x);
  // φ_1 - φ_1''(0) / φ_0''(0) φ_0, and its mirror image; the ratio is the same at every level
  const auto outer = [&](int neighbour, double end) {
    const double ratio = spline(level, index, end)(2) / spline(level, neighbour, end)(2);
    phi -= ratio * spline(level, neighbour, x);
  };
  if (index == 1) outer(0, 0.0);
  if (index == last) outer(last + 1, 1.0);
  return phi;
}

}  // namespace brachium::fem
