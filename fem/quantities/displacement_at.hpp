#pragma once
/// Values at a material point that need not be a node.

#include <Eigen/Core>

#include "fem/assembly/assembly.hpp"

namespace brachium::fem {

/// A material point: its cell and local coordinates there.
struct Located {
  int cell = -1;
  Eigen::Vector3d xi = Eigen::Vector3d::Zero();
};

/// The cell that holds a reference position, by Newton's method on X(xi) = X in every cell whose box is near;
/// on a common face, the cell of lowest index. Throws InputError("point-outside") with the nearest cell.
Located locate(const Discretisation& discretisation, const Eigen::Vector3d& reference_m);

/// Displacement [m] at a reference position. Throws InputError("point-outside").
Eigen::Vector3d displacement_at(const Discretisation& discretisation, const Configuration& configuration,
                                const Eigen::Vector3d& reference_m);

}  // namespace brachium::fem
