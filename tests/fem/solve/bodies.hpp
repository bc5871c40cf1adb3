#pragma once
/// Small bodies and helpers that the tests of the solver share.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>

#include "fem/element/quadrature.hpp"
#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"
#include "fem/solve/log.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::fem::tests {

constexpr double infinite = std::numeric_limits<double>::infinity();

inline RegionMaterial soft(double bulk_pa = 1e6) {
  return {NeoHooke{5e3, false}, {VolumetricLaw::quadratic, bulk_pa}};
}

/// The muscle of the clamped block problem.
inline MuscleTendon block_muscle() {
  MuscleTendon m;
  m.muscle = {.c1_pa = 3560.0, .c2_pa = 3860.0, .c3_pa = 0.0357, .c4 = 42.6};
  m.tendon = m.muscle;
  m.max_stress_pa = 0.3e6;
  m.force_length = {.optimal_stretch = 1.2,
                    .ascending_width = 0.25,
                    .ascending_exponent = 3.0,
                    .descending_width = 0.15,
                    .descending_exponent = 4.0};
  return m;
}

/// A block of one region, fibres along x, no conditions yet. `bend` moves inner points (distorted cells).
inline Problem body(Formulation formulation, const Eigen::Vector3d& size, int nx, int ny, int nz,
                    RegionMaterial material, double bend = 0.0) {
  Problem p;
  p.formulation = formulation;
  auto mesh = std::make_shared<data::Mesh>(as_type(block(size, nx, ny, nz), cell_type(formulation)));
  if (bend > 0.0) {
    for (int n = 0; n < mesh->point_count(); ++n) {
      const Eigen::Vector3d s = mesh->points.col(n).cwiseQuotient(size);
      const double inner = std::sin(M_PI * s[0]) * std::sin(M_PI * s[1]) * std::sin(M_PI * s[2]);
      mesh->points.col(n) += bend * inner * Eigen::Vector3d(1.0, -0.7, 0.5).cwiseProduct(size);
    }
  }
  p.mesh = mesh;
  p.materials = {std::move(material)};
  p.tissue.fibre = Eigen::Vector3d::UnitX().replicate(
      1, static_cast<Eigen::Index>(cell_quadrature(formulation).size()) * mesh->cell_count());
  return p;
}

/// Turned rigidly about the origin.
inline void turn(Problem& problem, const Eigen::Matrix3d& R) {
  auto mesh = std::make_shared<data::Mesh>(*problem.mesh);
  mesh->points = R * mesh->points;
  problem.mesh = mesh;
  problem.tissue.fibre = R * problem.tissue.fibre;
}

inline SolveOptions quick_options() {
  SolveOptions o;
  o.threads = 1;
  return o;
}

/// Sum of the reactions of a surface's points [N].
inline Eigen::Vector3d reaction(const Problem& problem, const AcceptedState& state,
                                const std::string& surface) {
  Eigen::Vector3d f = Eigen::Vector3d::Zero();
  for (const int n : problem.mesh->surface_points(surface)) {
    f += state.internal_force.segment<3>(3 * n) - state.external_force.segment<3>(3 * n);
  }
  return f;
}

/// Largest difference of the points' displacements to X -> u(X) [m].
template <class Field>
double largest_difference(const Problem& problem, const Eigen::VectorXd& dofs, Field&& field) {
  double worst = 0.0;
  for (int n = 0; n < problem.mesh->point_count(); ++n) {
    worst = std::max(worst,
                     (dofs.segment<3>(3 * n) - field(Eigen::Vector3d(problem.mesh->points.col(n)))).norm());
  }
  return worst;
}

inline std::vector<std::string> codes(const std::vector<data::Diagnostic>& list) {
  std::vector<std::string> names;
  for (const auto& d : list) names.push_back(d.code);
  return names;
}

inline std::string messages(const std::vector<data::Diagnostic>& list) {
  std::string text;
  for (const auto& d : list) text += d.message + "\n";
  return text;
}

}  // namespace brachium::fem::tests
