#include "fem/quantities/volumes.hpp"

#include <Eigen/LU>

#include "fem/quantities/cell_point.hpp"

namespace brachium::fem {

Eigen::VectorXd region_volumes(const Discretisation& discretisation, const Configuration& configuration) {
  const data::Mesh& mesh = discretisation.mesh();
  Eigen::VectorXd volume = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(mesh.regions.size()));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    double& sum = volume[mesh.region_of_cell[static_cast<std::size_t>(c)]];
    for (int q = 0; q < discretisation.quadrature().size(); ++q) {
      double weight = 0.0;
      sum += deformation_gradient(discretisation, configuration.dofs, c, q, weight).determinant() * weight;
    }
  }
  return volume;
}

}  // namespace brachium::fem
