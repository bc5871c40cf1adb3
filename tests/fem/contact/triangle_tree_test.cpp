/// Closest points on triangle meshes: against all triangles one by one, sides at edges and corners, bad
/// meshes.

#include <cmath>
#include <random>

#include "data/model/error.hpp"
#include "fem/contact/triangle_tree.hpp"
#include "tests/fem/contact/sphere_mesh.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;

TriangleMesh cube() {
  TriangleMesh mesh;
  mesh.points.resize(3, 8);
  for (int i = 0; i < 8; ++i) mesh.points.col(i) = Vector3d(i & 1, (i >> 1) & 1, (i >> 2) & 1);
  mesh.triangles.resize(3, 12);
  const int t[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (int i = 0; i < 12; ++i) mesh.triangles.col(i) = Eigen::Vector3i(t[i][0], t[i][1], t[i][2]);
  return mesh;
}

/// Exact signed distance to the unit cube.
double cube_distance(const Vector3d& x) {
  const Vector3d d = (x - Vector3d::Constant(0.5)).cwiseAbs() - Vector3d::Constant(0.5);
  return d.cwiseMax(0.0).norm() + std::min(0.0, d.maxCoeff());
}

TEST(TriangleTree, SignedDistanceOfACubeIsExactAtFacesEdgesAndCorners) {
  const TriangleTree tree(cube());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 2.0);
  for (int i = 0; i < 3000; ++i) {
    const Vector3d x(uniform(random), uniform(random), uniform(random));
    EXPECT_NEAR(tree.closest(x).signed_distance, cube_distance(x), 1e-14) << x.transpose();
  }
}

TEST(TriangleTree, FindsWhatASearchThroughAllTrianglesFinds) {
  const TriangleMesh mesh = sphere_mesh(1.0, 3);
  const TriangleTree tree(mesh);
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int i = 0; i < 100; ++i) {
    const Vector3d x(uniform(random), uniform(random), uniform(random));
    double best = 1e300;
    for (Eigen::Index t = 0; t < mesh.triangles.cols();
         ++t) {  // by dense sampling of each triangle: never below the truth
      for (int a = 0; a <= 20; ++a) {
        for (int b = 0; a + b <= 20; ++b) {
          const Vector3d p =
              (a * mesh.points.col(mesh.triangles(0, t)) + b * mesh.points.col(mesh.triangles(1, t)) +
               (20 - a - b) * mesh.points.col(mesh.triangles(2, t))) /
              20.0;
          best = std::min(best, (x - p).norm());
        }
      }
    }
    const ClosestPoint found = tree.closest(x);
    EXPECT_LE(std::abs(found.signed_distance), best + 1e-12);
    EXPECT_GT(std::abs(found.signed_distance), best - 0.01);
    EXPECT_NEAR((x - found.point).norm(), std::abs(found.signed_distance), 1e-14);
  }
}

std::string refusal(const TriangleMesh& mesh) {
  try {
    check(mesh);
  } catch (const data::InputError& e) {
    return e.diagnostics()[0].code + ": " + e.diagnostics()[0].message;
  }
  return "accepted";
}

TEST(TriangleMesh, RefusesWhatEnclosesNothing) {
  EXPECT_EQ(refusal(cube()), "accepted");
  TriangleMesh open = cube();
  open.triangles.conservativeResize(3, 11);
  EXPECT_NE(refusal(open).find("triangle-mesh-open: edge"), std::string::npos) << refusal(open);
  TriangleMesh inward = cube();
  inward.triangles.row(1).swap(inward.triangles.row(2));
  EXPECT_EQ(refusal(inward),
            "triangle-mesh-inverted: the triangles face inward: the volume they enclose is negative");
  TriangleMesh torn = cube();
  std::swap(torn.triangles(1, 3), torn.triangles(2, 3));
  EXPECT_NE(refusal(torn).find("in the same direction"), std::string::npos) << refusal(torn);
  TriangleMesh flat = cube();
  flat.points.col(7) = 0.5 * (flat.points.col(5) + flat.points.col(6));
  EXPECT_EQ(refusal(flat), "triangle-mesh-degenerate: triangle 3 has no area");
  TriangleMesh missing = cube();
  missing.triangles(0, 5) = 8;
  EXPECT_EQ(refusal(missing), "triangle-mesh-index: triangle 5 names point 8 of 8");
}

}  // namespace
}  // namespace brachium::fem
