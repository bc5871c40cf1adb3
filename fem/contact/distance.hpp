#pragma once
/// Rigid bodies as signed distances: value, gradient and Hessian at a point, outside positive.
///
/// Contact needs nothing else: with the gap g(x) = distance, the energy 1/2 eps <-g>^2 gives the force eps <-g> grad g
/// and the symmetric tangent eps grad g (x) grad g - eps <-g> Hess g, whatever the shape.
///
/// | symbol | identifier | unit | meaning                                                                          |
/// |--------|------------|------|----------------------------------------------------------------------------------|
/// | g      | value      | m    | signed distance, negative inside                                                 |
/// | n      | gradient   | 1    | outward normal of the closest point (of length 1 but for distance grids)         |
/// | dn/dx  | hessian    | 1/m  | on a surface of principal curvatures k_i: sum k_i/(1 + k_i g) t_i (x) t_i        |

#include <Eigen/Core>
#include <memory>
#include <string>
#include <variant>

namespace brachium::fem {

struct Distance {
  double value = 0.0;
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
};

/// Half space below the plane through `point_m`.
struct HalfSpace {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward; normalised on use
};

struct Sphere {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

/// Circular cylinder of infinite length.
struct Cylinder {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();
  double radius_m = 0.0;
};

/// Cylinder between two points with half spheres at its ends.
struct Capsule {
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d to_m = Eigen::Vector3d::UnitZ();
  double radius_m = 0.0;
};

/// Ellipsoid with its axes along the columns of `axes`.
struct Ellipsoid {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d semi_axes_m = Eigen::Vector3d::Ones();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
};

class DistanceGrid;

/// A closed triangle mesh by its distance field (fem/contact/distance_grid.hpp).
struct TriangleBody {
  std::shared_ptr<const DistanceGrid> grid;
};

using RigidShape = std::variant<HalfSpace, Sphere, Cylinder, Capsule, Ellipsoid, TriangleBody>;

/// The distance at x. Points at which the closest point is not unique (a sphere's centre, a cylinder's axis)
/// have none: the value is right, gradient and Hessian are zero. A distance grid is far from its body where x
/// is outside its box: then the distance to the box's nearest point is added, with zero Hessian.
Distance distance(const RigidShape& shape, const Eigen::Vector3d& x_m);

/// Throws InputError("contact-shape") naming `body`, parameter and value: radii and semi-axes not above 0,
/// zero axes, axes that are not orthonormal.
void check(const RigidShape& shape, const std::string& body);

/// A body that turns about an axis by an angle that a boundary condition's amplitude drives: its pose.
struct Pose {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();  ///< x = rotation X + translation
};

/// The same of a body that has been moved.
Distance distance(const RigidShape& shape, const Pose& pose, const Eigen::Vector3d& x_m);

}  // namespace brachium::fem
