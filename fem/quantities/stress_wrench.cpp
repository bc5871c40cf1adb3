#include "fem/quantities/stress_wrench.hpp"

#include <Eigen/Geometry>

#include "fem/element/shape.hpp"
#include "fem/quantities/cell_state.hpp"

namespace brachium::fem {

Wrench stress_wrench(const Problem& problem, const Discretisation& discretisation,
                     const Configuration& configuration, const std::string& surface,
                     const Eigen::Vector3d& point_m) {
  const data::Mesh& mesh = discretisation.mesh();
  const CellStates states(problem, discretisation, configuration);
  const Quadrature& rule = face_quadrature(mesh.type);
  const Eigen::Matrix3Xd& corner = node_coordinates(mesh.type);
  Wrench sum;
  for (const data::CellFace& face : mesh.surface(surface).faces) {
    const auto nodes = data::face_nodes(mesh.type, face.face);
    for (int q = 0; q < rule.size(); ++q) {
      const Shape shape = face_shape(mesh.type, rule.points.col(q));
      Eigen::Vector3d xi = Eigen::Vector3d::Zero();
      Eigen::Matrix<double, 3, 2> tangents = Eigen::Matrix<double, 3, 2>::Zero();
      for (std::size_t a = 0; a < nodes.size(); ++a) {
        const auto row = static_cast<Eigen::Index>(a);
        xi += shape.value[row] * corner.col(nodes[a]);
        tangents += mesh.points.col(mesh.cells(nodes[a], face.cell)) * shape.derivative.row(row);
      }
      const Eigen::Vector3d N_dA = rule.weights[q] * tangents.col(0).cross(tangents.col(1));
      const CellState state = states.at(face.cell, xi);
      const Eigen::Vector3d f = -state.first_piola_pa * N_dA;
      sum.force_n += f;
      sum.moment_n_m += (state.point.position + state.point.displacement - point_m).cross(f);
    }
  }
  return sum;
}

}  // namespace brachium::fem
