#pragma once
/// Deformed volumes: ∫ J dX.

#include <Eigen/Core>

#include "fem/assembly/assembly.hpp"

namespace brachium::fem {

/// Deformed volume of each region of the mesh [m3], in its order.
Eigen::VectorXd region_volumes(const Discretisation& discretisation, const Configuration& configuration);

}  // namespace brachium::fem
