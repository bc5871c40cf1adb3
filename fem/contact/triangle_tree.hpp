#pragma once
/// Closed triangle meshes and the signed distance to them, through a tree of boxes.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace brachium::fem {

/// Triangles with outward normals (counter-clockwise seen from outside).
struct TriangleMesh {
  Eigen::Matrix3Xd points;     ///< 3 x n_points [m]
  Eigen::Matrix3Xi triangles;  ///< 3 x n_triangles
};

/// Throws InputError: "triangle-mesh-open" naming an edge that does not have two triangles,
/// "triangle-mesh-inverted" where the enclosed volume is negative or neighbours disagree on the outside,
/// "triangle-mesh-degenerate" naming a triangle without area, "triangle-mesh-index".
void check(const TriangleMesh& mesh);

/// Where a point is closest, and on which side of the surface it is.
struct ClosestPoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  int triangle = -1;
  double signed_distance = 0.0;  ///< positive outside
};

/// A binary tree of axis-aligned boxes, split at the median of the longest side. Const, safe from several
/// threads.
class TriangleTree {
 public:
  /// Checks the mesh (see check).
  explicit TriangleTree(TriangleMesh mesh);

  /// The closest point of the surface. The side is told by the angle-weighted pseudonormal of the face, edge
  /// or vertex that holds it (Baerentzen & Aanaes 2005, doi:10.1109/TVCG.2005.49).
  ClosestPoint closest(const Eigen::Vector3d& x) const;

  const TriangleMesh& mesh() const { return mesh_; }
  Eigen::AlignedBox3d box() const { return nodes_.front().box; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int left = -1, right = -1;  ///< children; leaves have none
    int first = 0, count = 0;   ///< triangles of a leaf, in order_
  };
  TriangleMesh mesh_;
  std::vector<Node> nodes_;
  std::vector<int> order_;
  Eigen::Matrix3Xd vertex_normal_;
  Eigen::MatrixXd edge_normal_;  ///< 9 x n_triangles: of the edges 01, 12, 20

  int build(int first, int count, const Eigen::Matrix3Xd& centres);
};

}  // namespace brachium::fem
