#include "fem/limb/body_shape.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/assembly/discretisation.hpp"
#include "fem/limb/muscle_body.hpp"
#include "fem/quantities/wrench.hpp"

namespace brachium::fem {
namespace {

constexpr int stations = 5;                // of the profile
constexpr double beside_path_norm = 0.05;  // of the muscle's length

/// Radii at even places along z of circles with the body's cross-sections: volume by hats over the hats'
/// lengths.
std::vector<double> profile_of(const Discretisation& d, double from_m, double to_m) {
  std::vector<double> volume(stations, 0.0);
  Eigen::MatrixX3d gradient;
  for (int c = 0; c < d.cell_count(); ++c) {
    for (int q = 0; q < d.quadrature().size(); ++q) {
      double weight = 0.0;
      d.reference_gradients(c, q, gradient, weight);
      const double at =
          std::clamp((d.position(c, q).z() - from_m) / (to_m - from_m), 0.0, 1.0) * (stations - 1);
      const int k = std::min(static_cast<int>(at), stations - 2);
      volume[static_cast<std::size_t>(k)] += (k + 1 - at) * weight;
      volume[static_cast<std::size_t>(k) + 1] += (at - k) * weight;
    }
  }
  const double spacing = (to_m - from_m) / (stations - 1);
  std::vector<double> radius;
  for (int k = 0; k < stations; ++k) {
    const double length = k == 0 || k == stations - 1 ? 0.5 * spacing : spacing;
    radius.push_back(std::sqrt(volume[static_cast<std::size_t>(k)] / (length * std::numbers::pi)));
  }
  return radius;
}

double reach_of(const data::Mesh& mesh, const Eigen::Vector3d& end) {
  const Eigen::Vector3d along = end.normalized();
  double reach = 0.0;
  for (const auto& x : mesh.points.colwise()) reach = std::max(reach, x.cross(along).norm());
  return reach;
}

struct Ends {
  Eigen::Vector3d origin_m, insertion_m;  ///< centroids
};

Ends ends_of(const data::Mesh& mesh, Formulation formulation) {
  for (const char* name : {"origin", "insertion", "side"}) mesh.surface(name);  // throws where there is none
  const Discretisation d(std::make_shared<const data::Mesh>(mesh), formulation);
  Configuration at_rest;
  at_rest.dofs = Eigen::VectorXd::Zero(d.dof_count());
  return {barycentre(d, at_rest, "origin"), barycentre(d, at_rest, "insertion")};
}

/// Shape and the figures of the body that follow from it.
MuscleBody given(MuscleBody body, BodyShape shape, data::Mesh mesh, double length_m) {
  for (const std::string& region : shape.tendons) mesh.region(region);  // throws where there is none
  shape.mesh = std::make_shared<const data::Mesh>(std::move(mesh));
  shape.length_m = body.belly_length_m = length_m;
  body.tendon_origin_m = body.tendon_insertion_m = body.transition_m = 0.0;
  body.aponeurosis = {};
  body.flatness = 1.0;
  body.profile_m = profile_of({shape.mesh, body.formulation}, 0.0, shape.insertion_m.z());
  shape.greatest_radius_m = *std::max_element(body.profile_m.begin(), body.profile_m.end());
  shape.reach_m = reach_of(*shape.mesh, shape.insertion_m);
  // About as many cross-sections as the mesh has layers of cells.
  const double cell_m = std::cbrt(std::numbers::pi * shape.greatest_radius_m * shape.greatest_radius_m *
                                  length_m / shape.mesh->cell_count());
  body.belly_cells = std::clamp(static_cast<int>(std::lround(length_m / cell_m)), 2, 40);
  body.shape = std::make_shared<const BodyShape>(std::move(shape));
  return body;
}

/// Distance from the insertion, along the path, of its point nearest to x.
double nearest_on_path(const CablePath& path, const Eigen::Vector2d& x) {
  const auto off = [&](double s) { return (path.place(s).point_m - x).norm(); };
  constexpr int pieces = 200;
  int best = 0;
  for (int i = 1; i <= pieces; ++i) {
    if (off(path.length_m() * i / pieces) < off(path.length_m() * best / pieces)) best = i;
  }
  double low = path.length_m() * std::max(best - 1, 0) / pieces,
         high = path.length_m() * std::min(best + 1, pieces) / pieces;
  while (high - low > 1e-9 * path.length_m()) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (off(a) < off(b) ? high : low) = off(a) < off(b) ? b : a;
  }
  return 0.5 * (low + high);
}

}  // namespace

void move(data::Mesh& mesh, const Eigen::Matrix3d& A, const Eigen::Vector3d& b) {
  mesh.points = ((A * mesh.points).colwise() + b).eval();
  for (auto* fields : {&mesh.point_fields, &mesh.cell_fields}) {
    const auto fibre = fields->find("fibre");
    if (fibre == fields->end() || fibre->second.rows() != 3) continue;
    fibre->second = (A * fibre->second).eval();
    for (auto f : fibre->second.colwise()) f.normalize();
  }
}

MuscleBody with_stress_free_shape(MuscleBody body, data::Mesh mesh, std::vector<std::string> tendons) {
  const auto [origin, end] = ends_of(mesh, body.formulation);
  const Eigen::Vector3d line = end - origin;
  if (!(line.norm() > 0.0))
    throw data::InputError("limb-geometry",
                           body.name + ": origin and insertion of the mesh have one centroid",
                           "name the two ends");
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(line, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  move(mesh, turn, -turn * origin);
  BodyShape shape;
  shape.tendons = std::move(tendons);
  shape.insertion_m = line.norm() * Eigen::Vector3d::UnitZ();
  return given(std::move(body), std::move(shape), std::move(mesh), line.norm());
}

MuscleBody with_in_situ_guess(MuscleBody body, const data::Mesh& in_situ, std::vector<std::string> tendons) {
  const auto [origin, end] = ends_of(in_situ, body.formulation);
  body.cable.origin_m = origin.head<2>();
  const CablePath path(body.cable, body.reference_rad);
  const double from_insertion = nearest_on_path(path, end.head<2>()),
               along_path = path.length_m() - from_insertion;
  const CablePath::Place place = path.place(from_insertion);
  const double off = (place.point_m - end.head<2>()).norm();
  if (off > beside_path_norm * along_path)
    throw data::InputError("in-situ-shape",
                           fmt::format("{}: the distal end of the mesh, [{:.1f}, {:.1f}] mm in the plane of "
                                       "motion, lies {:.1f} mm beside "
                                       "the path at {:.4g} deg, whose nearest point is [{:.1f}, {:.1f}] mm",
                                       body.name, 1e3 * end.x(), 1e3 * end.y(), 1e3 * off,
                                       body.reference_rad * 180.0 / std::numbers::pi, 1e3 * place.point_m.x(),
                                       1e3 * place.point_m.y()),
                           "give the mesh at that angle in the arm's frame, or move insertion and obstacle");
  BodyShape shape;
  shape.tendons = std::move(tendons);
  shape.origin_across_m = origin.z();
  shape.beside_path_m << end.head<2>() - place.point_m, end.z();
  // Shrunk along the chord; towards the ends, which are held as they are, across as well as along.
  const Eigen::Vector3d chord = end - origin, along = chord.normalized();
  const double s = body.pre_stretch;
  data::Mesh mesh = in_situ;
  for (auto x : mesh.points.colwise()) {
    const double z = (x - origin).dot(along), part = std::clamp(z / chord.norm(), 0.0, 1.0);
    const Eigen::Vector3d across = x - origin - z * along;
    const double wider = 1.0 + (std::sqrt(s) - 1.0) * std::sin(std::numbers::pi * part);
    x = origin + (z - part * chord.norm() + part * chord.norm() / s) * along + wider * across;
  }
  for (const int p : in_situ.surface_points("origin")) mesh.points.col(p) = in_situ.points.col(p);
  for (const int p : in_situ.surface_points("insertion"))
    mesh.points.col(p) = in_situ.points.col(p) + (1.0 / s - 1.0) * chord;
  // `stress_free_axis` of the finished body turns back by the same frame.
  body.belly_length_m = along_path / s;
  body.tendon_origin_m = body.tendon_insertion_m = 0.0;
  body.shape = nullptr;
  const StressFreeAxis axis = stress_free_axis(body);
  move(mesh, axis.frame.transpose(), -axis.frame.transpose() * origin);
  shape.insertion_m = axis.frame.transpose() * chord / s;
  return given(std::move(body), std::move(shape), std::move(mesh), along_path / s);
}

}  // namespace brachium::fem
