#pragma once
/// Fields at quadrature points, for output and statistics.

#include <Eigen/Core>

#include "fem/assembly/assembly.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

/// Columns q + n_q c. | σ Cauchy stress, a fibre direction now, p hydrostatic
struct PointFields {
  Eigen::VectorXd fibre_stretch;     ///< |F a0|; 1 where a region has no fibres
  Eigen::VectorXd jacobian;          ///< det F
  Eigen::VectorXd pressure_pa;       ///< -tr σ / 3, compression positive
  Eigen::VectorXd fibre_stress_pa;   ///< a · σ a; 0 where a region has no fibres
  Eigen::VectorXd active_stress_pa;  ///< the part of it that vanishes with the activation
  Eigen::VectorXd von_mises_pa;      ///< sqrt(3/2 |dev σ|²)
  Eigen::MatrixXd cauchy_pa;         ///< 6 x n: 11 22 33 12 23 13
  Eigen::Matrix3Xd fibre;            ///< a, deformed; zero where a region has no fibres
};

PointFields point_fields(const Problem& problem, const Discretisation& discretisation,
                         const Configuration& configuration);

}  // namespace brachium::fem
