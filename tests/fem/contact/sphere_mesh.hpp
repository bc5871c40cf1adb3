#pragma once
/// A sphere of triangles: an octahedron whose faces are halved `levels` times and pushed out to the radius.

#include <map>

#include "fem/contact/triangle_tree.hpp"

namespace brachium::fem {

inline TriangleMesh sphere_mesh(double radius, int levels,
                                const Eigen::Vector3d& centre = Eigen::Vector3d::Zero()) {
  std::vector<Eigen::Vector3d> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  std::vector<Eigen::Vector3i> triangles{{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                         {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middle;
    const auto between = [&](int a, int b) {
      const auto key = std::minmax(a, b);
      const auto found = middle.find(key);
      if (found != middle.end()) return found->second;
      points.push_back(
          (points[static_cast<std::size_t>(a)] + points[static_cast<std::size_t>(b)]).normalized());
      return middle[key] = static_cast<int>(points.size()) - 1;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& t : triangles) {
      const int a = between(t[0], t[1]), b = between(t[1], t[2]), c = between(t[2], t[0]);
      finer.insert(finer.end(), {{t[0], a, c}, {a, t[1], b}, {c, b, t[2]}, {a, b, c}});
    }
    triangles = finer;
  }
  TriangleMesh mesh;
  mesh.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    mesh.points.col(static_cast<Eigen::Index>(i)) = centre + radius * points[i];
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i)
    mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  return mesh;
}

}  // namespace brachium::fem
