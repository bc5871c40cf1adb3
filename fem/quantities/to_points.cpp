#include "fem/quantities/to_points.hpp"

#include <fmt/format.h>
#include <Eigen/QR>

#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

/// The polynomials' values at a local point.
Eigen::VectorXd basis(data::CellType type, const Eigen::Vector3d& xi) {
  const double x = xi[0], y = xi[1], z = xi[2];
  switch (type) {
    case data::CellType::tet4:
      return Eigen::Vector4d(1.0, x, y, z);
    case data::CellType::hex8:
      return Eigen::Vector<double, 8>{1.0, x, y, z, x * y, y * z, x * z, x * y * z};
    case data::CellType::tet10:
    case data::CellType::hex20:
    case data::CellType::hex27:
      break;
  }
  return Eigen::Vector<double, 10>{1.0, x, y, z, x * x, y * y, z * z, x * y, y * z, x * z};
}

/// Coefficients of the polynomials from values at the quadrature points: n_basis x n_q.
Eigen::MatrixXd fit(const Discretisation& discretisation) {
  const data::CellType type = discretisation.mesh().type;
  const Quadrature& rule = discretisation.quadrature();
  Eigen::MatrixXd V(rule.size(), basis(type, Eigen::Vector3d::Zero()).size());
  for (int q = 0; q < rule.size(); ++q) V.row(q) = basis(type, rule.points.col(q)).transpose();
  return V.colPivHouseholderQr().solve(Eigen::MatrixXd::Identity(rule.size(), rule.size()));
}

}  // namespace

Eigen::VectorXd extrapolation_weights(const Discretisation& discretisation, const Eigen::Vector3d& xi) {
  return fit(discretisation).transpose() * basis(discretisation.mesh().type, xi);
}

Eigen::MatrixXd to_points(const Discretisation& discretisation, const Eigen::MatrixXd& at_quadrature) {
  const data::Mesh& mesh = discretisation.mesh();
  const int n_q = discretisation.quadrature().size();
  if (at_quadrature.cols() != static_cast<Eigen::Index>(n_q) * mesh.cell_count()) {
    throw data::InputError("field-size",
                           fmt::format("a field of {} columns was given for {} quadrature points of {} cells",
                                       at_quadrature.cols(), n_q, mesh.cell_count()),
                           "one column per quadrature point: q + n_q cell");
  }
  const Eigen::Matrix3Xd& xi = node_coordinates(mesh.type);
  const Eigen::MatrixXd coefficients = fit(discretisation);
  Eigen::MatrixXd to_nodes(n_q, xi.cols());
  for (Eigen::Index a = 0; a < xi.cols(); ++a)
    to_nodes.col(a) = coefficients.transpose() * basis(mesh.type, xi.col(a));

  std::vector<int> region(static_cast<std::size_t>(mesh.point_count()),
                          static_cast<int>(mesh.regions.size()));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    for (const int point : mesh.cells.col(c)) {
      int& first = region[static_cast<std::size_t>(point)];
      first = std::min(first, mesh.region_of_cell[static_cast<std::size_t>(c)]);
    }
  }
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(at_quadrature.rows(), mesh.point_count());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(mesh.point_count());
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const Eigen::MatrixXd nodal =
        at_quadrature.middleCols(static_cast<Eigen::Index>(n_q) * c, n_q) * to_nodes;
    for (Eigen::Index a = 0; a < nodal.cols(); ++a) {
      const int point = mesh.cells(a, c);
      if (region[static_cast<std::size_t>(point)] != mesh.region_of_cell[static_cast<std::size_t>(c)])
        continue;
      sum.col(point) += nodal.col(a);
      count[point] += 1.0;
    }
  }
  for (Eigen::Index i = 0; i < sum.cols(); ++i) {
    if (count[i] > 0.0) sum.col(i) /= count[i];
  }
  return sum;
}

}  // namespace brachium::fem
