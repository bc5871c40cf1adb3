// Muscle-tendon-muscle bar, 30 x 6 x 6 mm, fibres along x, tendon in 10 <= x <= 20 mm with sharp interfaces,
// both ends held, right end moved by 1.5 mm, then the muscle activated to 0.3 and 0.6. Quarter model. Axial
// force and displacement of the interfaces on the axis by an independent code on the same mesh:
// tests/fem/reference/tendon_bar.py.

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Vector3d;
constexpr double mm = 1e-3;

struct State {
  double force_n, first_mm, second_mm;
};

void expect_states(Formulation formulation, const std::vector<State>& expected) {
  auto mesh = box_mesh(
      {.type = cell_type(formulation), .cells = {12, 2, 2}, .size_m = Vector3d(30.0, 3.0, 3.0) * mm});
  split_region(*mesh, "tendon", [](const Vector3d& x) { return x[0] > 10.0 * mm && x[0] < 20.0 * mm; });
  Problem problem;
  problem.mesh = mesh;
  problem.formulation = formulation;
  problem.materials.assign(2, {thesis_muscle_tendon(), {VolumetricLaw::quadratic, incompressible}});
  problem.tissue = uniform_fibres(*mesh, formulation, Vector3d::UnitX());
  set_muscle_by_region(problem.tissue, *mesh, formulation, "body");
  problem.conditions = {condition("left", "x0", Fixed{}), condition("y", "y0", SymmetryPlane{}),
                        condition("z", "z0", SymmetryPlane{}),
                        condition("right", "x1", RigidMotion{.translation_m = Vector3d(1.5 * mm, 0.0, 0.0)})};
  problem.programme = {phase("pull", {{"right", 1.0}}, {}, 2), phase("activate", {}, {{"body", 0.3}}),
                       phase("activate more", {}, {{"body", 0.6}})};
  SolveOptions options;
  options.threads = 1;
  options.volume_tolerance = 1e-8;
  const Discretisation discretisation(mesh, formulation);
  std::size_t state = 0;
  const Summary summary = solve(problem, options, [&](const AcceptedState& accepted) {
    if (accepted.state.phase_time < 1.0 || state >= expected.size()) return;
    const State& known = expected[state++];
    const Configuration& c = accepted.state.configuration;
    const Wrench end =
        wrench(discretisation, c, accepted.internal_force, accepted.external_force, "x1", Vector3d::Zero());
    EXPECT_NEAR(-4.0 * end.force_n[0], known.force_n, 2e-6);
    EXPECT_NEAR(displacement_at(discretisation, c, Vector3d(10.0 * mm, 0.0, 0.0))[0] / mm, known.first_mm,
                1e-6);
    EXPECT_NEAR(displacement_at(discretisation, c, Vector3d(20.0 * mm, 0.0, 0.0))[0] / mm, known.second_mm,
                1e-6);
    EXPECT_EQ(accepted.record.stability.verdict, "stable");
  });
  EXPECT_TRUE(summary.completed) << summary.reason;
  EXPECT_EQ(state, expected.size());
}

TEST(TendonBar, TaylorHoodAgreesWithAnIndependentCode) {
  expect_states(Formulation::q2_q1_taylor_hood, {{0.6666182, 0.7498319, 0.7501681},
                                                 {3.8608105, 0.7467670, 0.7532330},
                                                 {7.0497619, 0.7438292, 0.7561708}});
}

TEST(TendonBar, CondensedCellsAgreeWithAnIndependentCode) {
  expect_states(Formulation::q2_p1_discontinuous, {{0.6729149, 0.7493793, 0.7506207},
                                                   {3.8694352, 0.7462857, 0.7537143},
                                                   {7.0612623, 0.7432304, 0.7567696}});
}

}  // namespace
}  // namespace brachium::fem::verification
