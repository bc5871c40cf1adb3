// Incompressible uniaxial stretch along the fibre has a closed form: stretch and activation prescribed, sides
// free.
//
//   u = ((l - 1) X, (l^-1/2 - 1) Y, (l^-1/2 - 1) Z),   P(l, alpha) in study.hpp
//
// Every formulation holds this state exactly, on distorted cells too, so that only the solver's tolerances
// are left.

#include <cmath>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

constexpr double side_m = 0.01;

Problem cube(Formulation formulation, const MuscleTendon& law, double stretch, double activation) {
  Box box{.type = cell_type(formulation),
          .cells = {2, 1, 1},
          .size_m = Eigen::Vector3d::Constant(side_m),
          .distortion = 0.15};
  Problem problem;
  problem.mesh = box_mesh(box);
  problem.formulation = formulation;
  problem.materials = {{law, {VolumetricLaw::quadratic, incompressible}}};
  problem.tissue = uniform_fibres(*problem.mesh, formulation, Eigen::Vector3d::UnitX());
  problem.conditions = {condition("x", "x0", SymmetryPlane{}), condition("y", "y0", SymmetryPlane{}),
                        condition("z", "z0", SymmetryPlane{})};
  PrescribedDisplacement pull;
  pull.displacement_m[0] = (stretch - 1.0) * side_m;
  problem.conditions.push_back(condition("pull", "x1", pull));
  problem.programme = {phase("stretch", {{"pull", 1.0}}, {}, 2)};
  if (activation > 0.0) problem.programme.push_back(phase("activate", {}, {{"body", activation}}, 2));
  return problem;
}

class HomogeneousCube : public testing::TestWithParam<Formulation> {};

TEST_P(HomogeneousCube, ForceAgreesWithTheClosedForm) {
  const MuscleTendon law = thesis_muscle_tendon();
  for (const double stretch : {0.8, 0.9, 1.0, 1.1, 1.2, 1.3, 1.4, 1.5, 1.6}) {
    for (const double activation : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const Problem problem = cube(GetParam(), law, stretch, activation);
      const Solved solved = run(problem, tight(problem));
      if (!solved.summary.completed) continue;
      const double area = side_m * side_m, expected = uniaxial_stress(law, stretch, activation);
      const Eigen::Vector3d reaction = solved.reaction("x1") / area;
      const double scale = std::max(std::abs(expected), 2.0 * (law.muscle.c1_pa + law.muscle.c2_pa));
      EXPECT_NEAR(reaction[0], expected, 1e-9 * scale)
          << "stretch " << stretch << ", activation " << activation;
      EXPECT_NEAR(reaction.tail<2>().norm(), 0.0, 1e-9 * scale);
      EXPECT_NEAR(solved.summary.steps.back().volume / std::pow(side_m, 3), 1.0, 1e-10);
      const Eigen::Vector3d corner =
          displacement_at(*solved.discretisation, solved.configuration, Eigen::Vector3d::Constant(side_m));
      EXPECT_NEAR(corner[1] / side_m, 1.0 / std::sqrt(stretch) - 1.0, 1e-9);
      EXPECT_NEAR(corner[2] / side_m, 1.0 / std::sqrt(stretch) - 1.0, 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formulations, HomogeneousCube, testing::ValuesIn(mixed_formulations()),
                         named_by_formulation);

// Check values of the thesis' muscle: isotropic and passive parts, kPa.
TEST(HomogeneousCubeClosedForm, HasTheKnownStresses) {
  MuscleTendon law = thesis_muscle_tendon();
  const MuscleTendon full = law;
  law.muscle.c3_pa = 0.0;
  const double iso[] = {21.422, 39.295, 54.701, 68.342, 80.685},
               passive[] = {2e-5, 0.00141, 0.0573, 1.766, 42.994};
  for (int k = 0; k < 5; ++k) {
    const double stretch = 1.1 + 0.1 * k;
    EXPECT_NEAR(uniaxial_stress(law, stretch, 0.0) * 1e-3, iso[k], 6e-4);
    EXPECT_NEAR((uniaxial_stress(full, stretch, 0.0) - uniaxial_stress(law, stretch, 0.0)) * 1e-3, passive[k],
                k == 0 ? 6e-6 : 6e-4);
  }
}

}  // namespace
}  // namespace brachium::fem::verification
