#include "fem/contact/triangle_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;

Vector3d corner(const TriangleMesh& mesh, int t, int k) {
  return mesh.points.col(mesh.triangles(k, t));
}

Vector3d area_vector(const TriangleMesh& mesh, int t) {
  return 0.5 * (corner(mesh, t, 1) - corner(mesh, t, 0)).cross(corner(mesh, t, 2) - corner(mesh, t, 0));
}

/// Which part of a triangle a closest point lies on: its inside, an edge 0 (01), 1 (12), 2 (20), or a vertex.
struct OnTriangle {
  Vector3d point;
  int edge = -1, vertex = -1;
};

/// Closest point of a triangle by its Voronoi regions (Ericson 2005, "Real-Time Collision Detection",
/// section 5.1.5).
OnTriangle closest_on(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& x) {
  const Vector3d ab = b - a, ac = c - a, ax = x - a;
  const double d1 = ab.dot(ax), d2 = ac.dot(ax);
  if (d1 <= 0.0 && d2 <= 0.0) return {a, -1, 0};
  const Vector3d bx = x - b;
  const double d3 = ab.dot(bx), d4 = ac.dot(bx);
  if (d3 >= 0.0 && d4 <= d3) return {b, -1, 1};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return {a + d1 / (d1 - d3) * ab, 0, -1};
  const Vector3d cx = x - c;
  const double d5 = ab.dot(cx), d6 = ac.dot(cx);
  if (d6 >= 0.0 && d5 <= d6) return {c, -1, 2};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return {a + d2 / (d2 - d6) * ac, 2, -1};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0)
    return {b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b), 1, -1};
  const double scale = 1.0 / (va + vb + vc);
  return {a + vb * scale * ab + vc * scale * ac, -1, -1};
}

std::map<std::pair<int, int>, std::vector<int>> edges_of(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, std::vector<int>> edges;  // directed edge -> triangles
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) edges[{mesh.triangles(k, t), mesh.triangles((k + 1) % 3, t)}].push_back(t);
  }
  return edges;
}

}  // namespace

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.cols() == 0)
    throw data::InputError("triangle-mesh-open", "a triangle mesh without triangles encloses nothing");
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int p = mesh.triangles(k, t);
      if (p >= 0 && p < mesh.points.cols()) continue;
      throw data::InputError("triangle-mesh-index",
                             fmt::format("triangle {} names point {} of {}", t, p, mesh.points.cols()));
    }
    const double longest = std::max({(corner(mesh, t, 1) - corner(mesh, t, 0)).norm(),
                                     (corner(mesh, t, 2) - corner(mesh, t, 1)).norm(),
                                     (corner(mesh, t, 0) - corner(mesh, t, 2)).norm()});
    if (!(area_vector(mesh, t).norm() > 1e-12 * longest * longest)) {
      throw data::InputError("triangle-mesh-degenerate", fmt::format("triangle {} has no area", t),
                             "remove it, or merge its points");
    }
  }
  const auto edges = edges_of(mesh);
  for (const auto& [edge, triangles] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (triangles.size() > 1) {
      throw data::InputError("triangle-mesh-inverted",
                             fmt::format("triangles {} and {} run along edge {}-{} in the same direction: "
                                         "they do not agree on the outside",
                                         triangles[0], triangles[1], edge.first, edge.second),
                             "turn one of them round");
    }
    if (back == edges.end()) {
      throw data::InputError("triangle-mesh-open",
                             fmt::format("edge {}-{} belongs to triangle {} only: the surface is not closed",
                                         edge.first, edge.second, triangles[0]),
                             "close the hole");
    }
  }
  double volume = 0.0;
  for (int t = 0; t < mesh.triangles.cols(); ++t)
    volume += area_vector(mesh, t).dot(corner(mesh, t, 0)) / 3.0;
  if (!(volume > 0.0))
    throw data::InputError("triangle-mesh-inverted",
                           "the triangles face inward: the volume they enclose is negative",
                           "turn all of them round");
}

TriangleTree::TriangleTree(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  check(mesh_);
  const auto count = mesh_.triangles.cols();
  vertex_normal_ = Eigen::Matrix3Xd::Zero(3, mesh_.points.cols());
  edge_normal_ = Eigen::MatrixXd::Zero(9, count);
  const auto edges = edges_of(mesh_);
  for (int t = 0; t < count; ++t) {
    const Vector3d n = area_vector(mesh_, t).normalized();
    for (int k = 0; k < 3; ++k) {
      const Vector3d to_next = (corner(mesh_, t, (k + 1) % 3) - corner(mesh_, t, k)).normalized();
      const Vector3d to_last = (corner(mesh_, t, (k + 2) % 3) - corner(mesh_, t, k)).normalized();
      vertex_normal_.col(mesh_.triangles(k, t)) += std::acos(std::clamp(to_next.dot(to_last), -1.0, 1.0)) * n;
      const int other = edges.at({mesh_.triangles((k + 1) % 3, t), mesh_.triangles(k, t)}).front();
      edge_normal_.block<3, 1>(3 * k, t) = n + area_vector(mesh_, other).normalized();
    }
  }
  Eigen::Matrix3Xd centres(3, count);
  for (int t = 0; t < count; ++t)
    centres.col(t) = (corner(mesh_, t, 0) + corner(mesh_, t, 1) + corner(mesh_, t, 2)) / 3.0;
  order_.resize(static_cast<std::size_t>(count));
  std::iota(order_.begin(), order_.end(), 0);
  build(0, static_cast<int>(count), centres);
}

int TriangleTree::build(int first, int count, const Eigen::Matrix3Xd& centres) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box;
  for (int i = first; i < first + count; ++i) {
    for (int k = 0; k < 3; ++k) box.extend(corner(mesh_, order_[static_cast<std::size_t>(i)], k));
  }
  nodes_[static_cast<std::size_t>(index)].box = box;
  constexpr int leaf = 4;
  if (count <= leaf) {
    nodes_[static_cast<std::size_t>(index)].first = first;
    nodes_[static_cast<std::size_t>(index)].count = count;
    return index;
  }
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const auto begin = order_.begin() + first;
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](int a, int b) { return centres(axis, a) < centres(axis, b); });
  const int left = build(first, count / 2, centres),
            right = build(first + count / 2, count - count / 2, centres);
  nodes_[static_cast<std::size_t>(index)].left = left;
  nodes_[static_cast<std::size_t>(index)].right = right;
  return index;
}

ClosestPoint TriangleTree::closest(const Vector3d& x) const {
  double best = std::numeric_limits<double>::infinity();
  OnTriangle where{Vector3d::Zero()};
  int triangle = -1;
  std::vector<std::pair<double, int>> stack{{nodes_[0].box.squaredExteriorDistance(x), 0}};
  while (!stack.empty()) {
    const auto [bound, index] = stack.back();
    stack.pop_back();
    if (bound >= best) continue;
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    if (node.left < 0) {
      for (int i = node.first; i < node.first + node.count; ++i) {
        const int t = order_[static_cast<std::size_t>(i)];
        const OnTriangle candidate =
            closest_on(corner(mesh_, t, 0), corner(mesh_, t, 1), corner(mesh_, t, 2), x);
        const double squared = (x - candidate.point).squaredNorm();
        if (squared < best) {
          best = squared;
          where = candidate;
          triangle = t;
        }
      }
      continue;
    }
    const double left = nodes_[static_cast<std::size_t>(node.left)].box.squaredExteriorDistance(x);
    const double right = nodes_[static_cast<std::size_t>(node.right)].box.squaredExteriorDistance(x);
    // The nearer child is looked at first: it is pushed last.
    if (left < right) {
      stack.emplace_back(right, node.right);
      stack.emplace_back(left, node.left);
    } else {
      stack.emplace_back(left, node.left);
      stack.emplace_back(right, node.right);
    }
  }
  Vector3d normal = area_vector(mesh_, triangle);
  if (where.vertex >= 0) normal = vertex_normal_.col(mesh_.triangles(where.vertex, triangle));
  if (where.edge >= 0) normal = edge_normal_.block<3, 1>(3 * where.edge, triangle);
  const double side = normal.dot(x - where.point) >= 0.0 ? 1.0 : -1.0;
  return {where.point, triangle, side * std::sqrt(best)};
}

}  // namespace brachium::fem
