#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/fem/quantities/affine.hpp"

namespace brachium::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using verification::box_mesh;

constexpr double mu = 3e4, kappa = 5e5;

Problem neo_hooke_box(Formulation formulation, VolumetricLaw law, double distortion = 0.15) {
  Problem problem;
  problem.mesh = box_mesh({.type = cell_type(formulation),
                           .cells = {2, 2, 1},
                           .size_m = Vector3d(0.2, 0.1, 0.1),
                           .distortion = distortion});
  problem.formulation = formulation;
  problem.materials = {{NeoHooke{mu}, {law, kappa}}};
  return problem;
}

/// σ = mu/J (B - 1) + U'(J)
Matrix3d neo_hooke_cauchy(const Matrix3d& F, VolumetricLaw law) {
  const double J = F.determinant();
  const double p = law == VolumetricLaw::quadratic ? kappa * (J - 1.0) : kappa * std::log(J) / J;
  return mu / J * (F * F.transpose() - Matrix3d::Identity()) + p * Matrix3d::Identity();
}

TEST(PointFields, OfAnAffineStateAreThoseOfTheClosedForm) {
  for (const Formulation formulation : {Formulation::q2_p1_discontinuous, Formulation::q1_p0,
                                        Formulation::p2b_p1_discontinuous, Formulation::q2_displacement}) {
    for (const VolumetricLaw law : {VolumetricLaw::quadratic, VolumetricLaw::logarithmic}) {
      const Problem problem = neo_hooke_box(formulation, law);
      const Discretisation d(problem.mesh, formulation);
      const Matrix3d s = neo_hooke_cauchy(affine::gradient(), law);
      const PointFields fields = point_fields(problem, d, affine::configuration(d, affine::gradient()));
      Eigen::Vector<double, 6> expected;
      expected << s(0, 0), s(1, 1), s(2, 2), s(0, 1), s(1, 2), s(0, 2);
      EXPECT_LT((fields.cauchy_pa.colwise() - expected).cwiseAbs().maxCoeff(), 1e-9 * s.norm())
          << to_string(formulation);
      EXPECT_LT((fields.pressure_pa.array() + s.trace() / 3.0).abs().maxCoeff(), 1e-9 * s.norm());
      const double mises = std::sqrt(1.5) * (s - s.trace() / 3.0 * Matrix3d::Identity()).norm();
      EXPECT_LT((fields.von_mises_pa.array() - mises).abs().maxCoeff(), 1e-9 * s.norm());
      EXPECT_LT((fields.jacobian.array() - affine::gradient().determinant()).abs().maxCoeff(), 1e-12);
    }
  }
}

TEST(StressWrench, OfAUniformStateIsStressTimesArea) {
  for (const Formulation formulation : {Formulation::q2_p1_discontinuous, Formulation::q1_p0,
                                        Formulation::p2b_p1_discontinuous, Formulation::q2_displacement}) {
    const Problem problem = neo_hooke_box(formulation, VolumetricLaw::quadratic);
    const Discretisation d(problem.mesh, formulation);
    const Matrix3d F = affine::gradient();
    const Configuration c = affine::configuration(d, F);
    const Matrix3d P =
        neo_hooke_cauchy(F, VolumetricLaw::quadratic) * F.determinant() * F.inverse().transpose();
    const Vector3d point(0.1, 0.0, 0.3), expected = -P * Vector3d::UnitX() * 0.01;
    const Wrench w = stress_wrench(problem, d, c, "x1", point);
    EXPECT_LT((w.force_n - expected).norm(), 1e-10 * expected.norm()) << to_string(formulation);
    const Vector3d moment = (F * Vector3d(0.2, 0.05, 0.05) - point).cross(expected);
    EXPECT_LT((w.moment_n_m - moment).norm(), 1e-10 * moment.norm()) << to_string(formulation);
  }
}

TEST(StressWrench, OfASectionIsThatOfTheEndInAUniformState) {
  for (const Formulation formulation :
       {Formulation::q2_p1_discontinuous, Formulation::p2b_p1_discontinuous}) {
    const Problem problem = neo_hooke_box(formulation, VolumetricLaw::quadratic, 0.0);
    const Discretisation d(problem.mesh, formulation);
    const Configuration c = affine::configuration(d, affine::gradient());
    const Vector3d point(0.1, 0.0, 0.3);
    const Wrench end = stress_wrench(problem, d, c, "x1", point);
    const double middle = d.mesh().points.row(0).maxCoeff() / 2.0;
    const Wrench w = section_stress_wrench(problem, d, c, {middle, 0.0, 0.0}, Vector3d::UnitX(), point);
    EXPECT_LT((w.force_n - end.force_n).norm(), 1e-10 * end.force_n.norm()) << to_string(formulation);
    // The same force acts at another place: half the body nearer.
    const Vector3d lever = affine::gradient() * Vector3d(middle, 0.0, 0.0);
    const Vector3d expected = end.moment_n_m - lever.cross(end.force_n);
    EXPECT_LT((w.moment_n_m - expected).norm(), 1e-10 * end.moment_n_m.norm()) << to_string(formulation);
    EXPECT_THROW(section_stress_wrench(problem, d, c, {0.9 * middle, 0.0, 0.0}, Vector3d::UnitX(), point),
                 data::InputError);
  }
}

TEST(PointFields, TellActiveFromTotalFibreStress) {
  MuscleTendon law;
  law.muscle = law.tendon = {.c1_pa = 3e4, .c2_pa = 4e3, .c3_pa = 10.0, .c4 = 12.0};
  law.max_stress_pa = 3e5;
  law.force_length = {.optimal_stretch = 1.4,
                      .ascending_width = 0.57,
                      .ascending_exponent = 4.0,
                      .descending_width = 0.14,
                      .descending_exponent = 3.0};
  Problem problem = neo_hooke_box(Formulation::q2_p1_discontinuous, VolumetricLaw::quadratic);
  problem.materials = {{law, {VolumetricLaw::quadratic, kappa}}};
  const Discretisation d(problem.mesh, problem.formulation);
  const Vector3d a0 = Vector3d(1.0, 0.3, -0.2).normalized();
  problem.tissue.fibre = a0.replicate(1, static_cast<Eigen::Index>(d.quadrature().size()) * d.cell_count());
  const Matrix3d F = affine::gradient();
  Configuration c = affine::configuration(d, F);
  const PointFields passive = point_fields(problem, d, c);
  c.activation[0] = 0.7;
  const PointFields active = point_fields(problem, d, c);
  const double stretch = (F * a0).norm();
  const double nominal = 0.7 * 3e5 * std::exp(-std::pow(std::abs(stretch / 1.4 - 1.0) / 0.57, 4.0));
  EXPECT_NEAR(active.fibre_stretch[0], stretch, 1e-13);
  EXPECT_LT((active.fibre.col(0) - F * a0 / stretch).norm(), 1e-13);
  EXPECT_NEAR(active.active_stress_pa[5], nominal * stretch / F.determinant(), 1e-9 * nominal);
  EXPECT_EQ(passive.active_stress_pa.cwiseAbs().maxCoeff(), 0.0);
  EXPECT_LT(
      (active.fibre_stress_pa - passive.fibre_stress_pa - active.active_stress_pa).cwiseAbs().maxCoeff(),
      1e-9 * nominal);
}

}  // namespace
}  // namespace brachium::fem
