// Pennate active block, 20 x 10 x 10 mm, fibres at 20 degrees to x in the x-y plane, the thesis' muscle; both
// ends held, right end moved to stretch 1.05, then alpha 0.3 and 0.6. Half model (z >= 5 mm) or whole. Forces
// and the moment about the deformed centre of the right end by an independent code:
// tests/fem/reference/pennate_block.py.

#include <array>
#include <cmath>
#include <numbers>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Vector3d;
constexpr double mm = 1e-3;

/// Wrench of the support on the whole block at the end of each phase, N and N mm.
struct Ends {
  std::vector<Vector3d> force, moment;
};

Ends pennate_block(Formulation formulation, std::array<int, 3> cells, bool whole,
                   const SolveOptions& options) {
  const double depth_mm = whole ? 10.0 : 5.0;
  Problem problem;
  problem.mesh = box_mesh(
      {.type = cell_type(formulation), .cells = cells, .size_m = Vector3d(20.0, 10.0, depth_mm) * mm});
  problem.formulation = formulation;
  problem.materials = {{thesis_muscle_tendon(), {VolumetricLaw::quadratic, incompressible}}};
  const double pennation = 20.0 * std::numbers::pi / 180.0;
  problem.tissue =
      uniform_fibres(*problem.mesh, formulation, Vector3d(std::cos(pennation), std::sin(pennation), 0.0));
  problem.conditions = {condition("left", "x0", Fixed{}),
                        condition("right", "x1", RigidMotion{.translation_m = Vector3d(1.0 * mm, 0.0, 0.0)})};
  if (!whole) problem.conditions.push_back(condition("middle", "z0", SymmetryPlane{}));
  problem.programme = {phase("stretch", {{"right", 1.0}}, {}, 2), phase("activate", {}, {{"body", 0.3}}, 2),
                       phase("activate more", {}, {{"body", 0.6}}, 2)};
  const Vector3d centre = Vector3d(21.0, 5.0, whole ? 5.0 : 0.0) * mm;
  // The mirror image of a half doubles what lies in the plane and cancels the rest.
  const Vector3d force_factor = whole ? Vector3d(1.0, 1.0, 1.0) : Vector3d(2.0, 2.0, 0.0);
  const Vector3d moment_factor = whole ? Vector3d(1.0, 1.0, 1.0) : Vector3d(0.0, 0.0, 2.0);
  const Discretisation discretisation(problem.mesh, formulation);
  Ends ends;
  const Summary summary = solve(problem, options, [&](const AcceptedState& accepted) {
    if (accepted.state.phase_time < 1.0) return;
    const Wrench w = wrench(discretisation, accepted.state.configuration, accepted.internal_force,
                            accepted.external_force, "x1", centre);
    EXPECT_EQ(accepted.record.stability.verdict, "stable");
    ends.force.push_back(-w.force_n.cwiseProduct(force_factor));
    ends.moment.push_back(-w.moment_n_m.cwiseProduct(moment_factor) / mm);
  });
  EXPECT_TRUE(summary.completed) << summary.reason;
  return ends;
}

SolveOptions ordinary() {
  SolveOptions options;
  options.threads = 1;
  options.volume_tolerance = 1e-7;
  return options;
}

TEST(PennateBlock, TaylorHoodAgreesWithAnIndependentCodeOnTheSameMesh) {
  const Ends ends = pennate_block(Formulation::q2_q1_taylor_hood, {8, 4, 2}, false, ordinary());
  ASSERT_EQ(ends.force.size(), 3u);
  EXPECT_NEAR(ends.force[0][0], 1.2439698, 1e-6);
  EXPECT_NEAR(ends.force[1][0], 8.0402085, 5e-6);
  EXPECT_NEAR(ends.force[1][1], 1.2985816, 5e-6);
  EXPECT_NEAR(ends.moment[1][2], -13.635107, 5e-5);
  EXPECT_NEAR(ends.force[2][0], 13.9137113, 1e-5);
  EXPECT_NEAR(ends.force[2][1], 2.7241535, 1e-5);
  EXPECT_NEAR(ends.moment[2][2], -28.603612, 1e-4);
}

TEST(PennateBlock, TaylorHoodTetrahedraAgreeWithAnIndependentCodeOnTheSameMesh) {
  const Ends ends = pennate_block(Formulation::p2_p1_taylor_hood, {8, 4, 4}, true, ordinary());
  ASSERT_EQ(ends.force.size(), 3u);
  EXPECT_LT((ends.force[0] - Vector3d(1.2513336, -0.0017537, -0.0017537)).norm(), 5e-6);
  EXPECT_LT((ends.force[1] - Vector3d(8.0382722, 1.3166963, 0.0024355)).norm(), 5e-6);
  EXPECT_LT((ends.force[2] - Vector3d(13.9009511, 2.7583658, 0.0075106)).norm(), 1e-3 * 14.17);
  EXPECT_LT((ends.moment[2] - Vector3d(0.0, 0.078861, -28.962841)).norm(), 1e-3 * 28.96);
}

class PennateBlockForce : public testing::TestWithParam<Formulation> {};

TEST_P(PennateBlockForce, IsWithinAThousandthOfTheFinestReference) {
  const Ends ends = pennate_block(GetParam(), {12, 6, 3}, false, ordinary());
  ASSERT_EQ(ends.force.size(), 3u);
  const Vector3d at_03(8.0324403, 1.2889078, 0.0), at_06(13.9141663, 2.7200498, 0.0);  // 16 x 8 x 8 cells
  EXPECT_LT((ends.force[1] - at_03).norm(), 1e-3 * at_03.norm());
  EXPECT_LT((ends.force[2] - at_06).norm(), 1e-3 * at_06.norm());
}

INSTANTIATE_TEST_SUITE_P(Hexahedra, PennateBlockForce,
                         testing::Values(Formulation::q2_p1_discontinuous, Formulation::q2_q1_taylor_hood),
                         named_by_formulation);

// Bubble tetrahedra need more cells for the same force: .59, .30, .17 % off with 8, 12, 16 cells along
// (activation .3).
TEST(PennateBlock, BubbleTetrahedraComeNearerToTheFinestReference) {
  const Ends coarse = pennate_block(Formulation::p2b_p1_discontinuous, {8, 4, 2}, false, ordinary());
  const Ends fine = pennate_block(Formulation::p2b_p1_discontinuous, {12, 6, 3}, false, ordinary());
  ASSERT_EQ(fine.force.size(), 3u);
  const std::array<Vector3d, 2> reference{Vector3d(8.0324403, 1.2889078, 0.0),
                                          Vector3d(13.9141663, 2.7200498, 0.0)};
  for (std::size_t k = 0; k < 2; ++k) {
    const double near = (fine.force[k + 1] - reference[k]).norm();
    EXPECT_LT(near, 3e-3 * reference[k].norm());
    EXPECT_LT(near, 0.55 * (coarse.force[k + 1] - reference[k]).norm()) << "order above 1.5";
  }
}

}  // namespace
}  // namespace brachium::fem::verification
