// Problem 1 of the verification benchmark of cardiac mechanics (Land et al. 2015,
// doi:10.1098/rspa.2015.0641): a beam bent by a pressure that follows its lower side, incompressible
// exponential material with fibres along the beam. The point (10, 0.5, 1) mm ends at a height of about 4.17
// mm in the participants' finest solutions.

#include <cmath>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

double tip_height_mm(Formulation formulation, std::array<int, 3> cells) {
  constexpr double mm = 1e-3;
  Problem problem;
  problem.mesh = box_mesh(
      {.type = cell_type(formulation), .cells = cells, .size_m = Eigen::Vector3d(10.0, 1.0, 1.0) * mm});
  problem.formulation = formulation;
  problem.materials = {{FungGuccione{2000.0, 8.0, 2.0, 4.0}, {VolumetricLaw::quadratic, incompressible}}};
  problem.tissue = uniform_fibres(*problem.mesh, formulation, Eigen::Vector3d::UnitX());
  problem.conditions = {condition("clamp", "x0", Fixed{}),
                        condition("pressure", "z0", FollowerPressure{4.0})};
  problem.programme = {phase("load", {{"pressure", 1.0}}, {}, 4)};
  SolveOptions options = tight(problem);
  options.relative_residual = 1e-8;
  options.volume_tolerance = 1e-6;
  options.stability = "off";
  const Solved solved = run(problem, options);
  if (!solved.summary.completed) return 0.0;
  const Eigen::Vector3d tip = Eigen::Vector3d(10.0, 0.5, 1.0) * mm;
  return (tip + displacement_at(*solved.discretisation, solved.configuration, tip))[2] / mm;
}

// The same mesh by an independent code: tests/fem/reference/land_beam.py.
TEST(LandBeam, TaylorHoodAgreesWithAnIndependentCodeOnTheSameMesh) {
  EXPECT_NEAR(tip_height_mm(Formulation::q2_q1_taylor_hood, {10, 2, 2}), 4.1691155, 2e-6);
}

// From below, with the mesh: 4.1712 mm is the independent code's value on 30 x 6 x 6 cells.
void expect_approach(Formulation formulation, std::array<int, 3> coarse, std::array<int, 3> fine) {
  const double converged = 4.1712;
  const double first = converged - tip_height_mm(formulation, coarse);
  const double second = converged - tip_height_mm(formulation, fine);
  EXPECT_LT(std::abs(second), 0.5 * std::abs(first));
  EXPECT_LT(std::abs(second), 0.01 * converged);
}

TEST(LandBeam, CondensedQuadraticCellsApproachIt) {
  expect_approach(Formulation::q2_p1_discontinuous, {10, 2, 2}, {20, 2, 2});
}

TEST(LandBeam, TetrahedraApproachIt) {
  expect_approach(Formulation::p2_p1_taylor_hood, {10, 1, 1}, {16, 2, 2});
}

}  // namespace
}  // namespace brachium::fem::verification
