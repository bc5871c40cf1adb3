#include "fem/solve/holds.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "fem/solve/guided_motion.hpp"

namespace brachium::fem {
namespace {

template <class... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <class... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

std::vector<std::string> surface_names(const data::Mesh& mesh, bool with_node_sets) {
  std::vector<std::string> names;
  for (const data::NamedSurface& s : mesh.surfaces) names.push_back(s.name);
  if (with_node_sets) {
    for (const auto& [name, nodes] : mesh.node_sets) names.push_back(name);
  }
  return names;
}

bool is_surface(const data::Mesh& mesh, const std::string& name) {
  for (const data::NamedSurface& s : mesh.surfaces) {
    if (s.name == name) return true;
  }
  return false;
}

}  // namespace

bool moves_bodies_only(const BoundaryCondition& condition) {
  return condition.surface.empty() && std::holds_alternative<RigidMotion>(condition.kind);
}

bool is_constraint(const BoundaryCondition& condition) {
  return !moves_bodies_only(condition) &&
         std::visit(Overloaded{[](const DeadTraction&) { return false; },
                               [](const FollowerPressure&) { return false; },
                               [](const BodyForce&) { return false; }, [](const auto&) { return true; }},
                    condition.kind);
}

bool has_amplitude(const BoundaryCondition& condition) {
  return std::visit(Overloaded{[](const Fixed&) { return false; }, [](const SymmetryPlane&) { return false; },
                               [](const auto&) { return true; }},
                    condition.kind);
}

std::vector<int> condition_points(const data::Mesh& mesh, const std::string& surface) {
  if (is_surface(mesh, surface)) return mesh.surface_points(surface);
  if (const auto found = mesh.node_sets.find(surface); found != mesh.node_sets.end()) return found->second;
  throw data::InputError("missing-surface",
                         fmt::format("the mesh has no surface or node set named `{}`", surface),
                         data::suggest(surface, surface_names(mesh, true)));
}

void check_has_faces(const data::Mesh& mesh, const std::string& surface) {
  if (is_surface(mesh, surface)) return;
  if (mesh.node_sets.contains(surface)) {
    throw data::InputError("missing-surface",
                           fmt::format("`{}` is a set of nodes, and a load needs faces", surface),
                           data::suggest(surface, surface_names(mesh, false)));
  }
  throw data::InputError("missing-surface", fmt::format("the mesh has no surface named `{}`", surface),
                         data::suggest(surface, surface_names(mesh, false)));
}

Eigen::Vector3d plane_normal(const data::Mesh& mesh, const std::string& surface) {
  const std::vector<int> nodes = condition_points(mesh, surface);
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const int n : nodes) centre += mesh.points.col(n);
  centre /= static_cast<double>(nodes.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const int n : nodes) {
    const Eigen::Vector3d d = mesh.points.col(n) - centre;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
  const double extent = std::sqrt(axes.eigenvalues()[2]);
  if (!(axes.eigenvalues()[1] > 1e-12 * axes.eigenvalues()[2])) {
    throw data::InputError("surface-not-plane",
                           fmt::format("the points of `{}` lie on a line and span no plane", surface),
                           "a symmetry plane needs a surface");
  }
  Eigen::Vector3d normal = axes.eigenvectors().col(0);
  double off = 0.0, reach = 0.0;
  for (const int n : nodes) {
    off = std::max(off, std::abs(normal.dot(mesh.points.col(n) - centre)));
    reach = std::max(reach, (mesh.points.col(n) - centre).norm());
  }
  if (off > 1e-5 * reach) {
    throw data::InputError(
        "surface-not-plane",
        fmt::format("`{}` is not plane: a point lies {:.3g} m off, of {:.3g} m extent", surface, off, extent),
        "a symmetry plane must be plane; split the surface into its plane parts");
  }
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
    if (std::abs(std::abs(normal[i]) - 1.0) < 1e-9 && normal.cross(axis).norm() < 1e-9) normal = axis;
  }
  if (normal.sum() < 0.0) normal = -normal;
  return normal;
}

std::vector<Hold> holds_of(const Problem& problem, int condition) {
  const BoundaryCondition& c = problem.conditions[static_cast<std::size_t>(condition)];
  std::vector<Hold> holds;
  if (!is_constraint(c)) return holds;
  const std::vector<int> nodes = condition_points(*problem.mesh, c.surface);
  const auto hold = [&](std::size_t column, const Eigen::Vector3d& direction) {
    holds.push_back({condition, nodes[column], static_cast<int>(column), direction});
  };
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      const bool held = std::visit(
          Overloaded{[i](const Fixed& x) { return x.components[static_cast<std::size_t>(i)]; },
                     [i](const PrescribedDisplacement& x) { return !std::isnan(x.displacement_m[i]); },
                     [i, k](const PrescribedField& x) {
                       const auto column = static_cast<Eigen::Index>(k);
                       return column < x.displacement_m.cols() && !std::isnan(x.displacement_m(i, column));
                     },
                     [](const RigidMotion&) { return true; }, [](const GuidedMotion&) { return true; },
                     [](const auto&) { return false; }},
          c.kind);
      if (held) hold(k, Eigen::Vector3d::Unit(i));
    }
  }
  if (std::holds_alternative<SymmetryPlane>(c.kind)) {
    const Eigen::Vector3d normal = plane_normal(*problem.mesh, c.surface);
    for (std::size_t k = 0; k < nodes.size(); ++k) hold(k, normal);
  }
  return holds;
}

double held_value(const Problem& problem, const Hold& hold, double amplitude) {
  const BoundaryCondition& c = problem.conditions[static_cast<std::size_t>(hold.condition)];
  Eigen::Index axis = 0;
  hold.direction.cwiseAbs().maxCoeff(&axis);
  return std::visit(
      Overloaded{[&](const PrescribedDisplacement& x) { return amplitude * x.displacement_m[axis]; },
                 [&](const PrescribedField& x) { return amplitude * x.displacement_m(axis, hold.column); },
                 [&](const RigidMotion& x) {
                   const Eigen::Vector3d arm = problem.mesh->points.col(hold.node) - x.centre_m;
                   const Eigen::AngleAxisd turn(amplitude * x.angle_rad, x.axis.normalized());
                   return hold.direction.dot(turn * arm - arm + amplitude * x.translation_m);
                 },
                 [&](const GuidedMotion& x) {
                   const GuidedPlace now = guided_place(x, amplitude);
                   const Eigen::Vector3d arm = problem.mesh->points.col(hold.node) - x.centre_m;
                   const Eigen::AngleAxisd turn(now.angle_rad, x.axis.normalized());
                   return hold.direction.dot(turn * arm - arm + now.place_m - x.centre_m);
                 },
                 [](const auto&) { return 0.0; }},
      c.kind);
}

}  // namespace brachium::fem
