#include "fem/quantities/cell_state.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "fem/element/shape.hpp"
#include "fem/quantities/to_points.hpp"

namespace brachium::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// U'(J) of a finite bulk modulus.
double volumetric_pressure(const Volumetric& v, double J) {
  return v.law == VolumetricLaw::quadratic ? v.bulk_modulus_pa * (J - 1.0)
                                           : v.bulk_modulus_pa * std::log(J) / J;
}

std::array<double, 6> six(const Matrix3d& m) {
  return {m(0, 0), m(1, 1), m(2, 2), m(0, 1), m(1, 2), m(0, 2)};
}

Matrix3d matrix(const double (&s)[6]) {
  Matrix3d m;
  m << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  return m;
}

/// dJ/dF = J F^-T.
Matrix3d cofactor(const Matrix3d& F) {
  Matrix3d cof;
  cof.col(0) = F.col(1).cross(F.col(2));
  cof.col(1) = F.col(2).cross(F.col(0));
  cof.col(2) = F.col(0).cross(F.col(1));
  return cof;
}

}  // namespace

double pressure_of(const Matrix3d& cauchy_pa) {
  return -cauchy_pa.trace() / 3.0;
}

double von_mises_of(const Matrix3d& cauchy_pa) {
  return std::sqrt(1.5) * (cauchy_pa + pressure_of(cauchy_pa) * Matrix3d::Identity()).norm();
}

CellStates::CellStates(const Problem& problem, const Discretisation& discretisation,
                       const Configuration& configuration)
    : problem_(problem), discretisation_(discretisation), configuration_(configuration) {
  if (configuration.dofs.size() != discretisation.dof_count()) {
    throw data::InputError("field-size",
                           fmt::format("a configuration of {} values was given for {} degrees of freedom",
                                       configuration.dofs.size(), discretisation.dof_count()),
                           "it must come from the same mesh and element");
  }
  const PressureSpace space = pressure_space(problem.formulation);
  if (space == PressureSpace::none || space == PressureSpace::continuous) return;
  pressures_.setZero(discretisation.pressures_per_cell(), discretisation.cell_count());
  for (int c = 0; c < discretisation.cell_count(); ++c) find_pressures(c);
}

/// p = Π U'(θ) + multiplier, θ = Π J, Π the L2 projection on the pressure functions.
void CellStates::find_pressures(int cell) {
  const Discretisation& d = discretisation_;
  const Volumetric& v =
      problem_.materials[static_cast<std::size_t>(d.mesh().region_of_cell[static_cast<std::size_t>(cell)])]
          .volumetric;
  if (configuration_.multiplier.size() > 0) pressures_.col(cell) = configuration_.multiplier.col(cell);
  if (!std::isfinite(v.bulk_modulus_pa)) return;
  const int n_q = d.quadrature().size(), n_p = d.pressures_per_cell();
  Eigen::MatrixXd phi(n_p, n_q);
  Eigen::VectorXd weights(n_q), jacobians(n_q);
  for (int q = 0; q < n_q; ++q) {
    phi.col(q) = pressure_functions(cell, d.quadrature().points.col(q), d.position(cell, q));
    jacobians[q] = deformation_gradient(d, configuration_.dofs, cell, q, weights[q]).determinant();
  }
  const auto mass = (phi * weights.asDiagonal() * phi.transpose()).llt();
  const Eigen::VectorXd theta = phi.transpose() * mass.solve(phi * weights.cwiseProduct(jacobians));
  Eigen::VectorXd slope(n_q);
  for (int q = 0; q < n_q; ++q) slope[q] = volumetric_pressure(v, theta[q]);
  pressures_.col(cell) += mass.solve(phi * weights.cwiseProduct(slope));
}

Eigen::VectorXd CellStates::pressure_functions(int cell, const Vector3d& xi, const Vector3d& position) const {
  const Discretisation& d = discretisation_;
  switch (pressure_space(problem_.formulation)) {
    case PressureSpace::none:
      return {};
    case PressureSpace::constant:
      return Eigen::VectorXd::Ones(1);
    case PressureSpace::continuous:
      return cell_shape(d.pressures_per_cell() == 8 ? data::CellType::hex8 : data::CellType::tet4, xi).value;
    case PressureSpace::linear_discontinuous:
      break;
  }
  // 1, (X - X_c)/h as the assembly has them.
  Eigen::Matrix3Xd x(3, d.quadrature().size());
  for (int q = 0; q < d.quadrature().size(); ++q) x.col(q) = d.position(cell, q);
  const Vector3d centre = x.rowwise().mean();
  x.colwise() -= centre;
  Eigen::VectorXd phi(4);
  phi << 1.0, (position - centre) / x.cwiseAbs().maxCoeff();
  return phi;
}

CellStates::Tissue CellStates::tissue_at_quadrature(int cell, int q) const {
  const TissueField& field = problem_.tissue;
  const Eigen::Index column = q + static_cast<Eigen::Index>(discretisation_.quadrature().size()) * cell;
  Tissue tissue;
  if (field.fibre.cols() > 0) tissue.fibre = field.fibre.col(column);
  if (field.muscle.size() > 0) tissue.muscle = field.muscle[column];
  if (field.soft_tissue.size() > 0) tissue.soft_tissue = field.soft_tissue[column];
  return tissue;
}

CellStates::Tissue CellStates::tissue_at(int cell, const Vector3d& xi) const {
  const TissueField& field = problem_.tissue;
  const int n_q = discretisation_.quadrature().size();
  const Eigen::Index first = static_cast<Eigen::Index>(n_q) * cell;
  const Eigen::VectorXd weights = extrapolation_weights(discretisation_, xi);
  Tissue tissue;
  if (field.fibre.cols() > 0) {
    const auto fibres = field.fibre.middleCols(first, n_q);
    tissue.fibre = (fibres * weights).normalized();
  }
  const auto share = [&](const Eigen::VectorXd& values, double& result) {
    if (values.size() == 0) return;
    const auto here = values.segment(first, n_q);
    result = std::clamp(here.dot(weights), here.minCoeff(), here.maxCoeff());
  };
  share(field.muscle, tissue.muscle);
  share(field.soft_tissue, tissue.soft_tissue);
  return tissue;
}

CellState CellStates::at_quadrature(int cell, int q) const {
  return evaluate_at(cell, discretisation_.quadrature().points.col(q), tissue_at_quadrature(cell, q));
}

CellState CellStates::at(int cell, const Vector3d& xi) const {
  return evaluate_at(cell, xi, tissue_at(cell, xi));
}

CellState CellStates::evaluate_at(int cell, const Vector3d& xi, const Tissue& tissue) const {
  const Discretisation& d = discretisation_;
  const auto region = static_cast<std::size_t>(d.mesh().region_of_cell[static_cast<std::size_t>(cell)]);
  const RegionMaterial& material = problem_.materials[region];
  CellState state;
  state.point = cell_point(d, configuration_.dofs, cell, xi);
  const Matrix3d& F = state.point.F;
  const Matrix3d C = F.transpose() * F;
  state.jacobian = F.determinant();

  const Eigen::VectorXd phi = pressure_functions(cell, xi, state.point.position);
  switch (pressure_space(problem_.formulation)) {
    case PressureSpace::none:
      state.pressure_pa = volumetric_pressure(material.volumetric, state.jacobian);
      break;
    case PressureSpace::continuous:
      for (Eigen::Index m = 0; m < phi.size(); ++m) {
        state.pressure_pa +=
            phi[m] * configuration_.dofs[3 * d.node_count() + d.pressure_nodes_of_cell()(m, cell)];
      }
      break;
    default:
      state.pressure_pa = phi.dot(pressures_.col(cell));
  }

  state.has_fibre = needs_fibres(material.material) && tissue.fibre.squaredNorm() > 0.0;
  MaterialPoint<double> at{};
  const std::array<double, 6> components = six(C);
  std::copy(components.begin(), components.end(), at.C);
  const Vector3d direction = state.has_fibre ? tissue.fibre : Vector3d::UnitX();
  for (int i = 0; i < 3; ++i) at.fibre[i] = direction[i];
  at.activation = configuration_.activation.size() > 0
                      ? configuration_.activation[static_cast<Eigen::Index>(region)]
                      : 0.0;
  at.muscle = tissue.muscle;
  at.soft_tissue = tissue.soft_tissue;
  at.stretch_before = 1.0;
  Matrix3d C_before = C;
  if (configuration_.dofs_before.size() > 0) {
    const Matrix3d before = cell_point(d, configuration_.dofs_before, cell, xi).F;
    C_before = before.transpose() * before;
    at.stretch_before = (before * direction).norm();
    at.inverse_dt = configuration_.inverse_dt;
  }
  MaterialResponse<double> response{};
  evaluate(material.material, at, response);
  Matrix3d S = matrix(response.S);
  if (configuration_.dofs_before.size() > 0)
    S += configuration_.viscosity_pa_s * configuration_.inverse_dt * (C - C_before);
  state.first_piola_pa = F * S + state.pressure_pa * cofactor(F);
  state.cauchy_pa = state.first_piola_pa * F.transpose() / state.jacobian;
  if (!state.has_fibre) return state;

  const Vector3d now = F * direction;
  state.fibre_stretch = now.norm();
  state.fibre_now = now / state.fibre_stretch;
  state.fibre_stress_pa = state.fibre_now.dot(state.cauchy_pa * state.fibre_now);
  if (at.activation > 0.0) {
    at.activation = 0.0;
    MaterialResponse<double> passive{};
    evaluate(material.material, at, passive);
    const Matrix3d active = F * (matrix(response.S) - matrix(passive.S)) * F.transpose() / state.jacobian;
    state.active_stress_pa = state.fibre_now.dot(active * state.fibre_now);
  }
  return state;
}

}  // namespace brachium::fem
