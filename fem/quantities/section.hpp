#pragma once
/// Cross-section of the body by a plane that moves with the material.
///
/// The plane cuts the boundary faces of the reference mesh in curves. Each face is divided into triangles in
/// which the curve is a quadratic arc y(t) (two ends and a middle on the plane), carried to the deformed
/// placement:
///   A n = ½ Σ ∫ y × y' dt,   y_c = 1/(3 A) Σ ∫ y (y × y') · n dt,   mean radius = Σ ∫ |y - y_c| |y'| dt / Σ
///   ∫ |y'| dt
/// The arcs are oriented by the outward normal, so that several loops and holes add up with their signs.

#include <Eigen/Core>

#include "fem/assembly/assembly.hpp"

namespace brachium::fem {

struct SectionFigures {
  double area_m2 = 0.0;        ///< deformed
  double mean_radius_m = 0.0;  ///< mean over the rim's length of the distance from the centroid
  double least_radius_m = 0.0, greatest_radius_m = 0.0;
  double perimeter_m = 0.0;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< mean, deformed
};

/// `point_m`, `normal`: the plane in the reference placement. Throws InputError("plane-misses-body") and
/// InputError("zero-direction").
SectionFigures section(const Discretisation& discretisation, const Configuration& configuration,
                       const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal);

/// Extent of the deformed section along a direction [m]. Throws as `section`.
double section_thickness(const Discretisation& discretisation, const Configuration& configuration,
                         const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal,
                         const Eigen::Vector3d& direction);

}  // namespace brachium::fem
