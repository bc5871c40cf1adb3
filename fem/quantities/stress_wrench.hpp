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

/// Faces between cells that lie in the plane; or, of meshes without such, those that part cells whose middles
/// lie on different sides of it.
enum class SectionFaces { in_plane, parting };

/// What the part of the body before a plane exerts on the part that `normal` points to: the mean of the
/// stresses on both sides of the faces between cells that lie in it (reference placement). Away from clamped
/// edges, where stress is singular, it converges quickly. Throws InputError("plane-misses-body") where no
/// such faces are.
Wrench section_stress_wrench(const Problem& problem, const Discretisation& discretisation,
                             const Configuration& configuration, const Eigen::Vector3d& plane_point_m,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& point_m,
                             SectionFaces which = SectionFaces::in_plane);

}  // namespace brachium::fem
