// Cook's membrane in plane strain, nearly incompressible neo-Hooke
//   W = K/2 (J - 1)² + G/2 (J^-2/3 tr C - 3)
// corners (0,0), (48,44), (48,60), (0,44) mm, left side clamped, 100 N a millimetre of thickness on the right
// side; after de Souza Neto et al. 1996, doi:10.1016/0020-7683(95)00259-6: K = 400942, G = 80.1938 MPa.
// OpenGeoSys' published displacements (F-bar and plain quadrilaterals) were computed with E = 240.565 MPa, nu
// = 0.499, which is K = 40094.2, G = 80.2418 MPa, although its text states the former.

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

constexpr double mm = 1e-3, MPa = 1e6;

struct Moduli {
  double bulk_pa, shear_pa;
};
constexpr Moduli original{400942.0 * MPa, 80.1938 * MPa};
constexpr Moduli from_young{240.565 * MPa / (3.0 * (1.0 - 2.0 * 0.499)), 240.565 * MPa / (2.0 * 1.499)};

double tip_displacement_mm(Formulation formulation, int n, const Moduli& moduli) {
  Problem problem;
  problem.mesh =
      box_mesh({.type = cell_type(formulation),
                .cells = {n, n, 1},
                .map = [](const Eigen::Vector3d& s) -> Eigen::Vector3d {
                  return Eigen::Vector3d(48.0 * s[0], 44.0 * s[0] + s[1] * (44.0 - 28.0 * s[0]), s[2]) * mm;
                }});
  problem.formulation = formulation;
  problem.materials = {{NeoHooke{moduli.shear_pa, true}, {VolumetricLaw::quadratic, moduli.bulk_pa}}};
  problem.conditions = {condition("left", "x0", Fixed{}), condition("front", "z0", SymmetryPlane{}),
                        condition("back", "z1", SymmetryPlane{}),
                        condition("shear", "x1", DeadTraction{Eigen::Vector3d(0.0, 100.0, 0.0), true})};
  problem.programme = {phase("load", {{"shear", 1.0}}, {}, 2)};
  SolveOptions options = tight(problem);
  options.relative_residual = 1e-9;
  options.stability = "off";
  const Solved solved = run(problem, options);
  if (!solved.summary.completed) return 0.0;
  return displacement_at(*solved.discretisation, solved.configuration,
                         Eigen::Vector3d(48.0, 60.0, 0.5) * mm)[1] /
         mm;
}

TEST(CooksMembrane, PlainTrilinearCellsLockAsPublished) {
  EXPECT_NEAR(tip_displacement_mm(Formulation::q1_displacement, 4, from_young), 2.2867221, 1e-3);
  EXPECT_NEAR(tip_displacement_mm(Formulation::q1_displacement, 10, from_young), 2.8406922, 1e-3);
}

TEST(CooksMembrane, ConstantPressureCellsFollowFBar) {
  EXPECT_NEAR(tip_displacement_mm(Formulation::q1_p0, 10, from_young), 6.7463, 0.01 * 6.7463);
  EXPECT_NEAR(tip_displacement_mm(Formulation::q1_p0, 20, from_young), 6.8589, 0.005 * 6.8589);
}

// The same elements in two dimensions by an independent code: tests/fem/reference/cook_membrane.py.
TEST(CooksMembrane, TaylorHoodAgreesWithAnIndependentCodeOnTheSameMesh) {
  EXPECT_NEAR(tip_displacement_mm(Formulation::q2_q1_taylor_hood, 4, original), 6.9092660, 2e-7);
  EXPECT_NEAR(tip_displacement_mm(Formulation::q2_q1_taylor_hood, 8, original), 6.9273501, 2e-7);
}

class Cook : public testing::TestWithParam<Formulation> {};

TEST_P(Cook, QuadraticCellsDoNotLockOnACoarseMesh) {
  const double converged = 6.9325;  // the same code, 64 cells a side
  EXPECT_NEAR(tip_displacement_mm(GetParam(), 4, original), converged, 0.01 * converged);
}

// Six tetrahedra a cell of the mesh above. Cells that lock stay away from the converged displacement however
// they are refined (plain trilinear ones: 2.29, 2.84); these come nearer by a factor at each halving.
class CookTetrahedra : public testing::TestWithParam<Formulation> {};

TEST_P(CookTetrahedra, ComeToTheConvergedDisplacement) {
  const double converged = 6.9325;
  double before = converged - tip_displacement_mm(GetParam(), 4, original);
  for (const int n : {8, 16}) {
    const double error = converged - tip_displacement_mm(GetParam(), n, original);
    EXPECT_GT(before / error, 2.0) << n;
    before = error;
  }
  EXPECT_LT(before, 0.02 * converged);
}
INSTANTIATE_TEST_SUITE_P(Formulations, CookTetrahedra,
                         testing::Values(Formulation::p2_p1_taylor_hood, Formulation::p2b_p1_discontinuous),
                         named_by_formulation);

INSTANTIATE_TEST_SUITE_P(Formulations, Cook,
                         testing::Values(Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood),
                         named_by_formulation);

}  // namespace
}  // namespace brachium::fem::verification
