#pragma once
/// What is read off a solved state: reactions, volumes, stretches, stresses, sections, values at points.

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/assembly/assembly.hpp"
#include "fem/solve/problem.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::fem {

/// Force [N] and moment about a point [N m] that a surface's nodes exert on the body's surroundings: sum of the
/// consistent nodal forces f_i (the reactions' opposite) and of (x_i - point) x f_i at deformed positions x_i.
struct Wrench {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_n_m = Eigen::Vector3d::Zero();
};
Wrench wrench(const Discretisation& discretisation, const Configuration& configuration,
              const Eigen::VectorXd& internal_force, const Eigen::VectorXd& external_force, const std::string& surface,
              const Eigen::Vector3d& point_m);

/// The same from Cauchy stress integrated over the deformed surface: the difference to the reactions measures the mesh.
Wrench stress_wrench(const Problem& problem, const Discretisation& discretisation, const Configuration& configuration,
                     const std::string& surface, const Eigen::Vector3d& point_m);

/// Fields at quadrature points (columns q + n_q c): fibre stretch, J, Cauchy stress (6: 11 22 33 12 23 13), pressure
/// (hydrostatic, compression positive), stress along the fibre (total, active, passive).
struct PointFields {
  Eigen::VectorXd fibre_stretch, jacobian, pressure_pa, fibre_stress_pa, active_stress_pa, von_mises_pa;
  Eigen::MatrixXd cauchy_pa;
};
PointFields point_fields(const Problem& problem, const Discretisation& discretisation, const Configuration& configuration);

/// Values at quadrature points brought to the mesh's points: least squares within each cell, averaged over the cells
/// of a point within one region (values x n_points).
Eigen::MatrixXd to_points(const Discretisation& discretisation, const Eigen::MatrixXd& at_quadrature);

/// Deformed volume of each region [m3].
Eigen::VectorXd region_volumes(const Discretisation& discretisation, const Configuration& configuration);

/// Cross-section of the deformed boundary by a plane that moves with the material (reference plane point + normal):
/// area, mean and extreme distance from its centroid ("radius"), thickness along a direction.
struct SectionFigures {
  double area_m2 = 0.0, mean_radius_m = 0.0, least_radius_m = 0.0, greatest_radius_m = 0.0;
  Eigen::Vector3d centroid_m = Eigen::Vector3d::Zero();
};
SectionFigures section(const Discretisation& discretisation, const Configuration& configuration,
                       const Eigen::Vector3d& point_m, const Eigen::Vector3d& normal);

/// Displacement at a material point (reference position); throws InputError("point-outside") with the nearest cell.
Eigen::Vector3d displacement_at(const Discretisation& discretisation, const Configuration& configuration,
                                const Eigen::Vector3d& reference_m);

}  // namespace brachium::fem
