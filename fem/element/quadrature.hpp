#pragma once
/// Quadrature rules by cell and face.
///   hexahedra: Gauss-Legendre tensor products, x fastest; 2^3 points for hex8, 3^3 for hex20 and hex27
///   tet4: 4 points (degree 2); tet10: 14 points (degree 5), 24 points (degree 6) with a bubble
///     (Walkington 2000 and Keast 1986, doi:10.1016/0045-7825(86)90059-9)
///   faces: 2^2 or 3^2 points on quadrilaterals, 3 (degree 2) or 6 (degree 4) points on triangles
///     (Dunavant 1985, doi:10.1002/nme.1620210612)

#include <Eigen/Core>

#include "fem/formulation.hpp"

namespace brachium::fem {

struct Quadrature {
  Eigen::MatrixXd points;   ///< local dimension x n_q
  Eigen::VectorXd weights;  ///< n_q, sum = local volume (8, 1/6; 4, 1/2)
  int size() const { return static_cast<int>(weights.size()); }
};

const Quadrature& cell_quadrature(Formulation formulation);
const Quadrature& face_quadrature(data::CellType type);
/// n points per direction, degree 2 n - 1, 1 <= n <= 5; for error norms and fine integrals.
Quadrature gauss_hexahedron(int n);

}  // namespace brachium::fem
