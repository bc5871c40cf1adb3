#include "fem/quantities/wrench.hpp"

#include <Eigen/Geometry>

#include "fem/element/shape.hpp"
#include "fem/quantities/surface_nodes.hpp"

namespace brachium::fem {

std::vector<int> surface_nodes(const data::Mesh& mesh, const std::string& name) {
  const auto set = mesh.node_sets.find(name);
  if (set != mesh.node_sets.end()) return set->second;
  return mesh.surface_points(name);
}

Wrench wrench(const Discretisation& discretisation, const Configuration& configuration,
              const Eigen::VectorXd& internal_force, const Eigen::VectorXd& external_force,
              const std::string& surface, const Eigen::Vector3d& point_m) {
  const data::Mesh& mesh = discretisation.mesh();
  Wrench sum;
  for (const int i : surface_nodes(mesh, surface)) {
    const Eigen::Vector3d x = mesh.points.col(i) + configuration.dofs.segment<3>(3 * i);
    Eigen::Vector3d f = -internal_force.segment<3>(3 * i);
    if (external_force.size() > 0) f += external_force.segment<3>(3 * i);
    sum.force_n += f;
    sum.moment_n_m += (x - point_m).cross(f);
  }
  return sum;
}

Wrench moved(const Wrench& wrench, const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) {
  return {wrench.force_n, wrench.moment_n_m + (from_m - to_m).cross(wrench.force_n)};
}

LineOfAction line_of_action(const Wrench& wrench, const Eigen::Vector3d& point_m) {
  const Eigen::Vector3d& R = wrench.force_n;
  const Eigen::Vector3d& M = wrench.moment_n_m;
  const double square = R.squaredNorm();
  if (!(square > 0.0)) {
    throw data::InputError("no-line-of-action", "a wrench without resulting force has no line of action",
                           "take its moment about a point instead");
  }
  return {point_m + R.cross(M) / square, M.dot(R) / square * R};
}

Eigen::Vector3d barycentre(const Discretisation& discretisation, const Configuration& configuration,
                           const std::string& surface) {
  const data::Mesh& mesh = discretisation.mesh();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const auto set = mesh.node_sets.find(surface);
  if (set != mesh.node_sets.end()) {
    for (const int i : set->second) sum += mesh.points.col(i) + configuration.dofs.segment<3>(3 * i);
    return sum / static_cast<double>(set->second.size());
  }
  const Quadrature& rule = face_quadrature(mesh.type);
  double area = 0.0;
  for (const data::CellFace& face : mesh.surface(surface).faces) {
    const auto nodes = data::face_nodes(mesh.type, face.face);
    for (int q = 0; q < rule.size(); ++q) {
      const Shape shape = face_shape(mesh.type, rule.points.col(q));
      Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const int node = mesh.cells(nodes[a], face.cell);
        const auto row = static_cast<Eigen::Index>(a);
        tangents += mesh.points.col(node) * shape.derivative.row(row);
        x += shape.value[row] * (mesh.points.col(node) + configuration.dofs.segment<3>(3 * node));
      }
      const double weight = rule.weights[q] * tangents.col(0).cross(tangents.col(1)).norm();
      area += weight;
      sum += weight * x;
    }
  }
  return sum / area;
}

}  // namespace brachium::fem
