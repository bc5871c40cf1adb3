#pragma once
/// Stress and fibre state at any point of any cell, from the displacements and pressures of a solved
/// configuration.
///
///   P = F S + p cof F,   σ = P F' / J,   S = 2 dW/dC (+ η (C - C_n)/dt with viscosity)
///
/// | symbol | identifier     | unit | meaning                            |
/// |--------|----------------|------|------------------------------------|
/// | p      | pressure_pa    | Pa   | volumetric part, tension positive  |
/// | σ      | cauchy_pa      | Pa   | Cauchy stress                      |
/// | P      | first_piola_pa | Pa   | first Piola-Kirchhoff stress       |
/// | λ      | fibre_stretch  | 1    | |F a0|                             |
/// | a      | fibre_now      | 1    | F a0 / λ                           |
///
/// p is the continuous unknown, the projected U'(θ) plus multiplier, or U'(J) without pressure unknowns.
/// Where a bulk modulus is infinite, p of the condensed formulations is the multiplier that the augmented
/// Lagrange iteration ended with; it differs from the pressure in the last residual by less than penalty
/// times volume tolerance.
///
/// Fibres and shares of tissue are given at quadrature points; elsewhere they are extrapolated within the
/// cell (fem/quantities/to_points.hpp), fibres brought to unit length, shares kept within the range found in
/// the cell.

#include <Eigen/Core>

#include "fem/quantities/cell_point.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

double pressure_of(const Eigen::Matrix3d& cauchy_pa);   ///< -tr σ / 3 [Pa], compression positive
double von_mises_of(const Eigen::Matrix3d& cauchy_pa);  ///< sqrt(3/2 |dev σ|²) [Pa]

struct CellState {
  CellPoint point;
  double jacobian = 1.0;
  double pressure_pa = 0.0;
  Eigen::Matrix3d first_piola_pa = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d cauchy_pa = Eigen::Matrix3d::Zero();
  bool has_fibre = false;
  double fibre_stretch = 1.0;  ///< 1 without fibres
  Eigen::Vector3d fibre_now = Eigen::Vector3d::Zero();
  double fibre_stress_pa = 0.0;   ///< a · σ a
  double active_stress_pa = 0.0;  ///< the part of it that vanishes with the activation
};

class CellStates {
 public:
  /// Keeps references to all three. Throws InputError("field-size") when the configuration does not fit.
  CellStates(const Problem& problem, const Discretisation& discretisation,
             const Configuration& configuration);

  CellState at(int cell, const Eigen::Vector3d& xi) const;
  CellState at_quadrature(int cell, int q) const;

 private:
  struct Tissue {
    Eigen::Vector3d fibre = Eigen::Vector3d::Zero();
    double muscle = 1.0, soft_tissue = 0.0;
  };
  Tissue tissue_at_quadrature(int cell, int q) const;
  Tissue tissue_at(int cell, const Eigen::Vector3d& xi) const;
  Eigen::VectorXd pressure_functions(int cell, const Eigen::Vector3d& xi,
                                     const Eigen::Vector3d& position) const;
  void find_pressures(int cell);
  CellState evaluate_at(int cell, const Eigen::Vector3d& xi, const Tissue& tissue) const;

  const Problem& problem_;
  const Discretisation& discretisation_;
  const Configuration& configuration_;
  Eigen::MatrixXd pressures_;  ///< coefficients by cell, condensed formulations
};

}  // namespace brachium::fem
