// FEBio's test of its muscle material (Blemker, Pinsky & Delp 2005): a unit hexahedron stretched by 1.2 along
// its fibres, sides free, and the same state in closed form.

#include <cmath>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

class FebioGold : public testing::TestWithParam<Formulation> {};

TEST_P(FebioGold, UnitHexahedronAgrees) {
  Problem problem;
  problem.mesh = box_mesh({.type = cell_type(GetParam())});
  problem.formulation = GetParam();
  BlemkerMuscle muscle;
  muscle.along_fibre_shear_pa = muscle.cross_fibre_shear_pa = 500.0;
  muscle.passive_coefficient = 0.05;
  muscle.passive_exponent = 6.6;
  muscle.optimal_stretch = 1.0;
  muscle.max_stress_pa = 3e5;
  muscle.straightening_stretch = 1.4;
  problem.materials = {{muscle, {VolumetricLaw::logarithmic, 1e7}}};
  problem.tissue = uniform_fibres(*problem.mesh, GetParam(), Eigen::Vector3d::UnitX());
  PrescribedDisplacement pull;
  pull.displacement_m[0] = 0.2;
  problem.conditions = {condition("x", "x0", SymmetryPlane{}), condition("y", "y0", SymmetryPlane{}),
                        condition("z", "z0", SymmetryPlane{}), condition("pull", "x1", pull)};
  problem.programme = {phase("stretch", {{"pull", 1.0}}, {}, 2)};
  const Solved solved = run(problem, tight(problem));
  ASSERT_TRUE(solved.summary.completed);
  const Eigen::Vector3d corner =
      displacement_at(*solved.discretisation, solved.configuration, Eigen::Vector3d::Ones());
  EXPECT_NEAR(1.0 + corner[1], 0.9136177286, 1e-9);
  EXPECT_NEAR(1.0 + corner[2], 0.9136177286, 1e-9);
  EXPECT_NEAR(point_fields(problem, *solved.discretisation, solved.configuration).cauchy_pa(0, 0), 48984.424,
              1e-3);
  double free = 0.0;  // free degrees of freedom of the eight corners
  for (int n = 0; n < problem.mesh->point_count(); ++n) {
    const Eigen::Vector3d x = problem.mesh->points.col(n);
    if ((x.array() * (1.0 - x.array())).abs().maxCoeff() < 1e-12)
      free += solved.configuration.dofs.segment<2>(3 * n + 1).squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(free), 0.244325959214, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Formulations, FebioGold,
                         testing::Values(Formulation::q1_p0, Formulation::q2_p1_discontinuous,
                                         Formulation::p2b_p1_discontinuous, Formulation::q1_displacement,
                                         Formulation::q2_displacement),
                         named_by_formulation);

}  // namespace
}  // namespace brachium::fem::verification
