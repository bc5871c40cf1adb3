#pragma once
/// Force and moment of a surface from the stress in the cells behind it:
///   R = -∫ P N dA,   M = -∫ (x - x_p) × P N dA        (= -∫ σ n da over the deformed surface)
/// Its difference to the wrench of the nodal reactions (fem/quantities/wrench.hpp) measures the mesh.

#include "fem/quantities/wrench.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

/// What the body exerts on its surroundings through `surface` (faces, not a node set), N and N m about
/// `point_m`.
Wrench stress_wrench(const Problem& problem, const Discretisation& discretisation,
                     const Configuration& configuration, const std::string& surface,
                     const Eigen::Vector3d& point_m);

}  // namespace brachium::fem
