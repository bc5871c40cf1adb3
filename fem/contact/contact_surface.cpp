#include "fem/contact/contact_surface.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "fem/element/quadrature.hpp"
#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

/// n x n Gauss points on quadrilaterals; on triangles n^2 congruent parts with a point in the middle of each.
Quadrature face_points(data::CellType type, int n) {
  Quadrature rule;
  if (type == data::CellType::tet4 || type == data::CellType::tet10) {
    rule.points.resize(2, n * n);
    rule.weights = Eigen::VectorXd::Constant(n * n, 0.5 / (n * n));
    int q = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n - i; ++j) {
        rule.points.col(q++) = Eigen::Vector2d(i + 1.0 / 3.0, j + 1.0 / 3.0) / n;
        if (j < n - i - 1) rule.points.col(q++) = Eigen::Vector2d(i + 2.0 / 3.0, j + 2.0 / 3.0) / n;
      }
    }
    return rule;
  }
  const Quadrature cube = gauss_hexahedron(n);  // x fastest: its first n^2 points are a plane
  rule.points = cube.points.topLeftCorner(2, n * n);
  rule.weights = cube.weights.head(n * n) / (cube.weights.head(n * n).sum() / 4.0);
  return rule;
}

}  // namespace

ContactSurface::ContactSurface(const Discretisation& discretisation, const std::string& surface,
                               RigidShape shape, ContactOptions options)
    : discretisation_(&discretisation), shape_(std::move(shape)), options_(options) {
  if (!(options.penalty_pa_per_m > 0.0) || !std::isfinite(options.penalty_pa_per_m)) {
    throw data::InputError("contact-option",
                           fmt::format("the contact penalty is {} Pa/m", options.penalty_pa_per_m),
                           "it must be above 0; (10 .. 100)(c1 + c2)/h is a start");
  }
  if (!(options.smoothing_m >= 0.0))
    throw data::InputError("contact-option",
                           fmt::format("the contact's smoothing width is {} m", options.smoothing_m),
                           "it must not be negative");
  if (options.points_per_direction < 1 || options.points_per_direction > 5) {
    throw data::InputError("contact-option",
                           fmt::format("{} contact points a direction", options.points_per_direction),
                           "choose 1 to 5");
  }
  check(shape_, surface);
  const data::Mesh& mesh = discretisation.mesh();
  const data::NamedSurface& named = mesh.surface(surface);
  const Quadrature rule = face_points(mesh.type, options.points_per_direction);
  std::vector<Eigen::MatrixXd> derivative;
  for (int q = 0; q < rule.size(); ++q) {
    const Shape s = face_shape(mesh.type, rule.points.col(q));
    value_.push_back(s.value);
    derivative.push_back(s.derivative);
  }
  const auto faces = static_cast<Eigen::Index>(named.faces.size());
  faces_.resize(value_.front().size(), faces);
  weight_.resize(faces * rule.size());
  for (Eigen::Index f = 0; f < faces; ++f) {
    const data::CellFace& face = named.faces[static_cast<std::size_t>(f)];
    const std::span<const int> local = data::face_nodes(mesh.type, face.face);
    for (std::size_t a = 0; a < local.size(); ++a)
      faces_(static_cast<Eigen::Index>(a), f) = mesh.cells(local[a], face.cell);
    for (int q = 0; q < rule.size(); ++q) {
      Eigen::Vector3d r = Eigen::Vector3d::Zero(), s = r;
      for (Eigen::Index a = 0; a < faces_.rows(); ++a) {
        r += derivative[static_cast<std::size_t>(q)](a, 0) * mesh.points.col(faces_(a, f));
        s += derivative[static_cast<std::size_t>(q)](a, 1) * mesh.points.col(faces_(a, f));
      }
      weight_[f * rule.size() + q] = rule.weights[q] * r.cross(s).norm();
    }
  }
}

ContactSurface::Pressure ContactSurface::pressure(double gap, double multiplier) const {
  const double eps = options_.penalty_pa_per_m, half = 0.5 * options_.smoothing_m;
  if (multiplier == 0.0 && gap < half && gap > -half) {  // eps (w/2 - g)^2 / (2 w)
    const double reach = half - gap, width = options_.smoothing_m;
    return {eps * reach * reach * reach / (6.0 * width), eps * reach * reach / (2.0 * width),
            -eps * reach / width};
  }
  const double t = multiplier - eps * gap;
  if (!(t > 0.0)) return {0.0, 0.0, 0.0};
  // The integral of the smoothed part up to -w/2 is that of the plain one plus eps w^2/24.
  const double offset = multiplier == 0.0 ? eps * options_.smoothing_m * options_.smoothing_m / 24.0 : 0.0;
  return {0.5 * t * t / eps + offset, t, -eps};
}

Eigen::Vector3d ContactSurface::position(int face, int q, const Eigen::VectorXd& dofs) const {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  const Eigen::VectorXd& N = value_[static_cast<std::size_t>(q)];
  for (Eigen::Index a = 0; a < faces_.rows(); ++a) {
    const int node = faces_(a, face);
    x += N[a] * (discretisation_->mesh().points.col(node) + dofs.segment<3>(3 * node));
  }
  return x;
}

ContactSums ContactSurface::add_force(const Eigen::VectorXd& dofs, const Pose& pose,
                                      const Eigen::VectorXd& multiplier_pa, Eigen::VectorXd& force) const {
  ContactSums sums;
  const int n_q = static_cast<int>(value_.size());
  for (int f = 0; f < faces_.cols(); ++f) {
    for (int q = 0; q < n_q; ++q) {
      const Eigen::Index point = static_cast<Eigen::Index>(f) * n_q + q;
      const Eigen::Vector3d x = position(f, q, dofs);
      const Distance d = distance(shape_, pose, x);
      const Pressure p = pressure(d.value, multiplier_pa.size() > 0 ? multiplier_pa[point] : 0.0);
      ++sums.points;
      sums.energy_j += weight_[point] * p.energy;
      if (!(p.pressure > 0.0)) continue;
      const Eigen::Vector3d push = weight_[point] * p.pressure * d.gradient;
      for (Eigen::Index a = 0; a < faces_.rows(); ++a)
        force.segment<3>(3 * faces_(a, f)) += value_[static_cast<std::size_t>(q)][a] * push;
      sums.force_n += push;
      sums.moment_n_m += x.cross(push);
      sums.greatest_penetration_m = std::max(sums.greatest_penetration_m, -d.value);
      sums.greatest_pressure_pa = std::max(sums.greatest_pressure_pa, p.pressure);
      sums.area_m2 += weight_[point];
      ++sums.active_points;
    }
  }
  return sums;
}

std::vector<FaceTangent> ContactSurface::tangent(const Eigen::VectorXd& dofs, const Pose& pose,
                                                 const Eigen::VectorXd& multiplier_pa) const {
  std::vector<FaceTangent> tangents;
  const int n_q = static_cast<int>(value_.size());
  const Eigen::Index nodes = faces_.rows();
  for (int f = 0; f < faces_.cols(); ++f) {
    FaceTangent face;
    for (int q = 0; q < n_q; ++q) {
      const Eigen::Index point = static_cast<Eigen::Index>(f) * n_q + q;
      const Distance d = distance(shape_, pose, position(f, q, dofs));
      const Pressure p = pressure(d.value, multiplier_pa.size() > 0 ? multiplier_pa[point] : 0.0);
      if (!(p.pressure > 0.0)) continue;
      if (face.nodes.empty()) {
        face.nodes.assign(faces_.col(f).begin(), faces_.col(f).end());
        face.values = Eigen::MatrixXd::Zero(3 * nodes, 3 * nodes);
      }
      const Eigen::Matrix3d k =
          weight_[point] * (p.slope * d.gradient * d.gradient.transpose() + p.pressure * d.hessian);
      const Eigen::VectorXd& N = value_[static_cast<std::size_t>(q)];
      for (Eigen::Index a = 0; a < nodes; ++a) {
        for (Eigen::Index b = 0; b < nodes; ++b) face.values.block<3, 3>(3 * a, 3 * b) += N[a] * N[b] * k;
      }
    }
    if (!face.nodes.empty()) tangents.push_back(std::move(face));
  }
  return tangents;
}

ContactPoints ContactSurface::points(const Eigen::VectorXd& dofs, const Pose& pose,
                                     const Eigen::VectorXd& multiplier_pa) const {
  const int n_q = static_cast<int>(value_.size()), count = point_count();
  ContactPoints result{Eigen::Matrix3Xd(3, count), Eigen::VectorXd(count), Eigen::VectorXd(count), weight_};
  for (int i = 0; i < count; ++i) {
    result.position_m.col(i) = position(i / n_q, i % n_q, dofs);
    result.gap_m[i] = distance(shape_, pose, result.position_m.col(i)).value;
    result.pressure_pa[i] =
        pressure(result.gap_m[i], multiplier_pa.size() > 0 ? multiplier_pa[i] : 0.0).pressure;
  }
  return result;
}

NodalPressure ContactSurface::at_mesh_points(const Eigen::VectorXd& dofs, const Pose& pose,
                                             const Eigen::VectorXd& multiplier_pa) const {
  const ContactPoints all = points(dofs, pose, multiplier_pa);
  const Eigen::Index count = discretisation_->mesh().points.cols();
  NodalPressure at{Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(count)};
  const int n_q = static_cast<int>(value_.size());
  for (int i = 0; i < point_count(); ++i) {
    const Eigen::VectorXd& N = value_[static_cast<std::size_t>(i % n_q)];
    for (Eigen::Index a = 0; a < faces_.rows(); ++a) {
      const double area = weight_[i] * N[a] * N[a] / N.squaredNorm();
      at.area_m2[faces_(a, i / n_q)] += area;
      at.pressure_pa[faces_(a, i / n_q)] += area * all.pressure_pa[i];
    }
  }
  for (Eigen::Index p = 0; p < count; ++p)
    if (at.area_m2[p] > 0.0) at.pressure_pa[p] /= at.area_m2[p];
  return at;
}

std::vector<char> ContactSurface::active_set(const Eigen::VectorXd& dofs, const Pose& pose,
                                             const Eigen::VectorXd& multiplier_pa) const {
  const ContactPoints all = points(dofs, pose, multiplier_pa);
  std::vector<char> active(static_cast<std::size_t>(point_count()));
  for (int i = 0; i < point_count(); ++i)
    active[static_cast<std::size_t>(i)] = all.pressure_pa[i] > 0.0 ? 1 : 0;
  return active;
}

double ContactSurface::least_gap_m(const Eigen::VectorXd& dofs, const Pose& pose) const {
  double least = std::numeric_limits<double>::infinity();
  const int n_q = static_cast<int>(value_.size());
  for (int i = 0; i < point_count(); ++i)
    least = std::min(least, distance(shape_, pose, position(i / n_q, i % n_q, dofs)).value);
  return least;
}

}  // namespace brachium::fem
