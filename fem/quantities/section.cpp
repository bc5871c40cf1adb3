#include "fem/quantities/section.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int divisions = 4;  // of a face along each side

/// A quadratic arc of the rim in the deformed placement.
struct Arc {
  Vector3d first, middle, last;
  Vector3d at(double t) const {
    return (1 - t) * (1 - 2 * t) * first + 4 * t * (1 - t) * middle + t * (2 * t - 1) * last;
  }
  Vector3d slope(double t) const { return (4 * t - 3) * first + (4 - 8 * t) * middle + (4 * t - 1) * last; }
  /// Least and greatest value of `along` . x: at the ends, or where the parabola turns.
  std::array<double, 2> range(const Vector3d& along) const {
    const double a = along.dot(first), b = along.dot(last);
    std::array<double, 2> out{std::min(a, b), std::max(a, b)};
    const double from = along.dot(slope(0.0)), to = along.dot(slope(1.0));
    if (from * to < 0.0) {
      const double turn = along.dot(at(from / (from - to)));
      out = {std::min(out[0], turn), std::max(out[1], turn)};
    }
    return out;
  }
};

/// Gauss-Legendre rule on [0, 1], exact to degree 7.
struct LinePoint {
  double t, weight;
};
const std::array<LinePoint, 4>& line_rule() {
  static const std::array<LinePoint, 4> rule = [] {
    const double inner = std::sqrt(3.0 / 7.0 - 2.0 / 7.0 * std::sqrt(1.2)),
                 outer = std::sqrt(3.0 / 7.0 + 2.0 / 7.0 * std::sqrt(1.2));
    const double heavy = (18.0 + std::sqrt(30.0)) / 72.0, light = (18.0 - std::sqrt(30.0)) / 72.0;
    return std::array<LinePoint, 4>{{{0.5 - 0.5 * outer, light},
                                     {0.5 - 0.5 * inner, heavy},
                                     {0.5 + 0.5 * inner, heavy},
                                     {0.5 + 0.5 * outer, light}}};
  }();
  return rule;
}

/// One boundary face: its nodes in both placements, and the plane's signed distance.
class Face {
 public:
  Face(const Discretisation& discretisation, const Configuration& configuration, const data::CellFace& face,
       const Vector3d& point, const Vector3d& normal, double length)
      : type_(discretisation.mesh().type), snap_(1e-10 * length), normal_(normal) {
    const data::Mesh& mesh = discretisation.mesh();
    const auto nodes = data::face_nodes(type_, face.face);
    reference_.resize(3, static_cast<Eigen::Index>(nodes.size()));
    deformed_.resizeLike(reference_);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      const int node = mesh.cells(nodes[a], face.cell);
      const auto column = static_cast<Eigen::Index>(a);
      reference_.col(column) = mesh.points.col(node) - point;
      deformed_.col(column) = mesh.points.col(node) + configuration.dofs.segment<3>(3 * node);
    }
  }

  bool far() const {
    const Eigen::RowVectorXd distance = normal_.transpose() * reference_;
    const double reach =
        distance.maxCoeff() - distance.minCoeff();  // a curved face leaves its nodes' range by less
    return distance.minCoeff() > reach || distance.maxCoeff() < -reach;
  }

  /// Signed distance to the plane; rounding is brought to 0, so that neighbours agree on which side a point
  /// lies.
  double distance(const Vector2d& rs) const {
    const double d = normal_.dot(reference_ * face_shape(type_, rs).value);
    return std::abs(d) < snap_ ? 0.0 : d;
  }

  Vector3d deformed(const Vector2d& rs) const { return deformed_ * face_shape(type_, rs).value; }

  /// Where the plane cuts a straight line of local coordinates whose ends lie on either side.
  Vector2d cut(Vector2d below, Vector2d above) const {
    double f_below = distance(below), f_above = distance(above);
    for (int iteration = 0; iteration < 60; ++iteration) {  // regula falsi, Illinois variant
      const Vector2d middle = below + f_below / (f_below - f_above) * (above - below);
      const double f = normal_.dot(reference_ * face_shape(type_, middle).value);
      if (std::abs(f) <= 1e-4 * snap_ || (above - below).norm() < 1e-15) return middle;
      if (f < 0.0) {
        below = middle;
        f_below = f;
        f_above *= 0.5;
      } else {
        above = middle;
        f_above = f;
        f_below *= 0.5;
      }
    }
    return below + f_below / (f_below - f_above) * (above - below);
  }

  /// The plane's curve through a local triangle, oriented by plane normal x outward normal.
  std::optional<Arc> arc(const std::array<Vector2d, 3>& corner) const {
    std::array<double, 3> d{};
    for (std::size_t k = 0; k < 3; ++k) d[k] = distance(corner[k]);
    std::vector<Vector2d> ends;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t n = (k + 1) % 3;
      if ((d[k] >= 0.0) == (d[n] >= 0.0)) continue;
      ends.push_back(d[k] < 0.0 ? cut(corner[k], corner[n]) : cut(corner[n], corner[k]));
    }
    if (ends.size() != 2) return std::nullopt;
    const Vector2d middle = onto_plane(0.5 * (ends[0] + ends[1]));
    // Outward normal in the reference placement, n_out = dX/dr x dX/ds.
    const Shape shape = face_shape(type_, middle);
    const Eigen::Matrix<double, 3, 2> tangents = reference_ * shape.derivative;
    const Vector3d direction = normal_.cross(tangents.col(0).cross(tangents.col(1)));
    if (direction.dot(tangents * (ends[1] - ends[0])) < 0.0) std::swap(ends[0], ends[1]);
    return Arc{deformed(ends[0]), deformed(middle), deformed(ends[1])};
  }

  /// All arcs of the face.
  void collect(std::vector<Arc>& arcs) const {
    const bool triangle = data::corners_per_cell(type_) == 4;
    const auto local = [&](int i, int j) {
      const double r = static_cast<double>(i) / divisions, s = static_cast<double>(j) / divisions;
      return triangle ? Vector2d(r, s) : Vector2d(2.0 * r - 1.0, 2.0 * s - 1.0);
    };
    for (int j = 0; j < divisions; ++j) {
      for (int i = 0; i < divisions; ++i) {
        if (triangle && i + j >= divisions) continue;
        if (const auto a = arc({local(i, j), local(i + 1, j), local(i, j + 1)})) arcs.push_back(*a);
        if (triangle && i + j + 1 >= divisions) continue;
        if (const auto a = arc({local(i + 1, j), local(i + 1, j + 1), local(i, j + 1)})) arcs.push_back(*a);
      }
    }
  }

 private:
  /// Newton's method along the gradient of the distance in local coordinates.
  Vector2d onto_plane(Vector2d rs) const {
    for (int iteration = 0; iteration < 8; ++iteration) {
      const Shape shape = face_shape(type_, rs);
      const double d = normal_.dot(reference_ * shape.value);
      const Vector2d gradient = (normal_.transpose() * reference_ * shape.derivative).transpose();
      if (std::abs(d) <= 1e-4 * snap_ || !(gradient.squaredNorm() > 0.0)) break;
      rs -= d / gradient.squaredNorm() * gradient;
    }
    return rs;
  }

  data::CellType type_;
  double snap_;
  Vector3d normal_;
  Eigen::Matrix3Xd reference_, deformed_;
};

std::vector<Arc> rim(const Discretisation& discretisation, const Configuration& configuration,
                     const Vector3d& point, const Vector3d& normal) {
  if (!(normal.norm() > 0.0)) {
    throw data::InputError("zero-direction", "the normal of a section's plane has no length",
                           "give a direction, any length");
  }
  const data::Mesh& mesh = discretisation.mesh();
  const double length = (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff()).norm();
  std::vector<Arc> arcs;
  for (const data::CellFace& boundary : data::boundary_faces(mesh)) {
    const Face face(discretisation, configuration, boundary, point, normal.normalized(), length);
    if (!face.far()) face.collect(arcs);
  }
  if (arcs.empty()) {
    throw data::InputError("plane-misses-body",
                           fmt::format("the plane through ({:.6g}, {:.6g}, {:.6g}) m does not cut the body",
                                       point[0], point[1], point[2]),
                           "a section needs body on both sides of its plane");
  }
  return arcs;
}

}  // namespace

SectionFigures section(const Discretisation& discretisation, const Configuration& configuration,
                       const Vector3d& point_m, const Vector3d& normal) {
  const std::vector<Arc> arcs = rim(discretisation, configuration, point_m, normal);
  const Vector3d origin = arcs.front().first;  // near the section: no cancellation
  SectionFigures figures;
  Vector3d area = Vector3d::Zero();
  for (const Arc& arc : arcs) {
    for (const auto& [t, weight] : line_rule()) {
      area += 0.5 * weight * (arc.at(t) - origin).cross(arc.slope(t));
    }
  }
  figures.area_m2 = area.norm();
  figures.normal = area / figures.area_m2;
  Vector3d first_moment = Vector3d::Zero();
  for (const Arc& arc : arcs) {
    for (const auto& [t, weight] : line_rule()) {
      const Vector3d y = arc.at(t) - origin;
      first_moment += weight / 3.0 * y.cross(arc.slope(t)).dot(figures.normal) * y;
    }
  }
  figures.centroid_m = origin + first_moment / figures.area_m2;
  figures.least_radius_m = std::numeric_limits<double>::infinity();
  double weighted = 0.0;
  for (const Arc& arc : arcs) {
    for (const auto& [t, weight] : line_rule()) {
      const double ds = weight * arc.slope(t).norm();
      figures.perimeter_m += ds;
      weighted += ds * (arc.at(t) - figures.centroid_m).norm();
    }
    for (const Vector3d& x : {arc.first, arc.middle, arc.last}) {
      const double radius = (x - figures.centroid_m).norm();
      figures.least_radius_m = std::min(figures.least_radius_m, radius);
      figures.greatest_radius_m = std::max(figures.greatest_radius_m, radius);
    }
  }
  figures.mean_radius_m = weighted / figures.perimeter_m;
  return figures;
}

double section_thickness(const Discretisation& discretisation, const Configuration& configuration,
                         const Vector3d& point_m, const Vector3d& normal, const Vector3d& direction) {
  if (!(direction.norm() > 0.0)) {
    throw data::InputError("zero-direction", "the direction of a thickness has no length",
                           "give a direction, any length");
  }
  const Vector3d along = direction.normalized();
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Arc& arc : rim(discretisation, configuration, point_m, normal)) {
    const auto [least, greatest] = arc.range(along);
    low = std::min(low, least);
    high = std::max(high, greatest);
  }
  return high - low;
}

}  // namespace brachium::fem
