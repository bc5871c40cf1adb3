// Patch test: an affine displacement, and the uniform stress that belongs to it, is reproduced on distorted
// meshes. Displacements are prescribed on five sides; the sixth carries the dead traction P N of the closed
// form.
//
//   P = F S(F'F) + p J F^-T,   p = U'(J), or any constant where J = 1 and the body is incompressible

#include <Eigen/LU>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

const Vector3d fibre = Vector3d(0.8, 0.36, 0.48);
constexpr double bulk_modulus_pa = 2e5, activation = 0.3;

MuscleTendon tissue() {
  MuscleTendon law = block_muscle();
  law.muscle.c3_pa = 500.0;  // so that every part of the law bears at these stretches
  law.muscle.c4 = 12.0;
  law.max_stress_pa = 3e4;
  return law;
}

Matrix3d first_piola(const Matrix3d& F, double pressure) {
  const Matrix3d C = F.transpose() * F;
  MaterialPoint<double> point{};
  const double components[6] = {C(0, 0), C(1, 1), C(2, 2), C(0, 1), C(1, 2), C(0, 2)};
  std::copy(components, components + 6, point.C);
  for (int i = 0; i < 3; ++i) point.fibre[i] = fibre[i];
  point.activation = activation;
  point.muscle = 1.0;
  point.soft_tissue = 0.0;
  point.stretch_before = 1.0;
  MaterialResponse<double> response{};
  evaluate(tissue(), point, response);
  Matrix3d S;
  S << response.S[0], response.S[3], response.S[5], response.S[3], response.S[1], response.S[4],
      response.S[5], response.S[4], response.S[2];
  return F * S + pressure * F.determinant() * F.inverse().transpose();
}

Matrix3d affine(double volume_ratio) {
  Matrix3d F;
  F << 1.15, 0.10, -0.05, 0.04, 0.95, 0.12, -0.08, 0.03, 0.97;
  return F * std::cbrt(volume_ratio / F.determinant());
}

/// Largest error of a displacement [share of the size], of the stress [share of its norm].
struct Errors {
  double displacement = 0.0, stress = 0.0;
};

Errors solve_patch(Formulation formulation, double volume_ratio, double modulus_pa, double pressure_pa) {
  const double size_m = 0.02;
  const Matrix3d F = affine(volume_ratio), P = first_piola(F, pressure_pa);
  // Enough free nodes to follow boundaries that are not isochoric on the way: 36 displacements for 27
  // pressures.
  const std::array<int, 3> cells =
      cell_type(formulation) == data::CellType::hex8 ? std::array{3, 3, 3} : std::array{2, 2, 2};
  Problem problem;
  problem.mesh = box_mesh({.type = cell_type(formulation),
                           .cells = cells,
                           .size_m = Vector3d(1.0, 0.7, 0.8) * size_m,
                           .distortion = 0.2});
  problem.formulation = formulation;
  problem.materials = {{tissue(), {VolumetricLaw::quadratic, modulus_pa}}};
  problem.tissue = uniform_fibres(*problem.mesh, formulation, fibre);
  PrescribedField field;
  const std::vector<int> points = problem.mesh->surface_points("clamp");
  field.displacement_m.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    field.displacement_m.col(static_cast<Eigen::Index>(i)) =
        (F - Matrix3d::Identity()) * problem.mesh->points.col(points[i]);
  }
  DeadTraction traction;
  traction.traction_pa = P * Vector3d::UnitX();
  problem.conditions = {condition("walls", "clamp", field), condition("load", "x1", traction)};
  problem.programme = {phase("all", {{"walls", 1.0}, {"load", 1.0}}, {{"body", activation}}, 2)};
  const Solved solved = run(problem, tight(problem));
  Errors errors;
  if (!solved.summary.completed) return {1.0, 1.0};
  for (int i = 0; i < problem.mesh->point_count(); ++i) {
    const Vector3d u = solved.configuration.dofs.segment<3>(3 * i);
    errors.displacement = std::max(
        errors.displacement, (u - (F - Matrix3d::Identity()) * problem.mesh->points.col(i)).norm() / size_m);
  }
  const Matrix3d cauchy = P * F.transpose() / F.determinant();
  const PointFields fields = point_fields(problem, *solved.discretisation, solved.configuration);
  Eigen::Vector<double, 6> expected;
  expected << cauchy(0, 0), cauchy(1, 1), cauchy(2, 2), cauchy(0, 1), cauchy(1, 2), cauchy(0, 2);
  errors.stress = (fields.cauchy_pa.colwise() - expected).cwiseAbs().maxCoeff() / expected.norm();
  return errors;
}

class Patch : public testing::TestWithParam<Formulation> {};

TEST_P(Patch, CompressibleAffineStateIsReproduced) {
  const double volume_ratio = 1.05;
  const Errors errors =
      solve_patch(GetParam(), volume_ratio, bulk_modulus_pa, bulk_modulus_pa * (volume_ratio - 1.0));
  EXPECT_LT(errors.displacement, 1e-10);
  EXPECT_LT(errors.stress, 1e-8);
}

// The traction of another stress state must not give the affine field: the test can fail.
TEST_P(Patch, AnotherTractionIsNoticed) {
  const Errors errors = solve_patch(GetParam(), 1.05, bulk_modulus_pa, bulk_modulus_pa * 0.051);
  EXPECT_GT(errors.displacement, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Formulations, Patch, testing::ValuesIn(all_formulations()), named_by_formulation);

class IncompressiblePatch : public testing::TestWithParam<Formulation> {};

TEST_P(IncompressiblePatch, IsochoricAffineStateIsReproducedAtAnyPressure) {
  for (const double pressure : {0.0, 2e4, -5e4}) {
    const Errors errors = solve_patch(GetParam(), 1.0, incompressible, pressure);
    EXPECT_LT(errors.displacement, 1e-10) << pressure;
    EXPECT_LT(errors.stress, 1e-8) << pressure;
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, IncompressiblePatch, testing::ValuesIn(mixed_formulations()),
                         named_by_formulation);

}  // namespace
}  // namespace brachium::fem::verification
