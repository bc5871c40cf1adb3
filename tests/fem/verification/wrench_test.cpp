// On every solved state: the moment of the nodal forces about a joint is the same through the attachment's
// wrench and through the line of action,
//   e · [(x_s - x_J) × R + M] = e · [(x_m - x_J) × R + M_par] = e · Σ (x_i - x_J) × f_i,
// forces and moments on the body balance, and the wrench of the stress comes near under refinement.

#include <Eigen/Geometry>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Vector3d;

Problem bent_and_twisted(Formulation formulation, std::array<int, 3> cells) {
  Problem problem;
  problem.mesh = box_mesh({.type = cell_type(formulation),
                           .cells = cells,
                           .size_m = Vector3d(0.03, 0.01, 0.012),
                           .distortion = 0.1});
  problem.formulation = formulation;
  problem.materials = {{thesis_muscle_tendon(), {VolumetricLaw::quadratic, incompressible}}};
  problem.tissue = uniform_fibres(*problem.mesh, formulation, Vector3d(1.0, 0.25, 0.1));
  RigidMotion move{.translation_m = Vector3d(0.004, 0.002, -0.001),
                   .centre_m = Vector3d(0.03, 0.005, 0.006),
                   .axis = Vector3d(0.6, 0.0, 0.8),
                   .angle_rad = 0.4};
  problem.conditions = {condition("origin", "x0", Fixed{}), condition("insertion", "x1", move)};
  problem.programme = {phase("move", {{"insertion", 1.0}}, {}, 2), phase("activate", {}, {{"body", 0.6}}, 2)};
  return problem;
}

class Wrenches : public testing::TestWithParam<Formulation> {};

TEST_P(Wrenches, MomentsAboutAJointAgreeOnEveryAcceptedState) {
  const Problem problem = bent_and_twisted(GetParam(), {3, 2, 2});
  const Discretisation discretisation(problem.mesh, problem.formulation);
  const Vector3d joint(0.05, -0.02, 0.01), hinge = Vector3d(0.2, 0.9, -0.3).normalized();
  int states = 0;
  SolveOptions options = tight(problem);
  options.relative_residual = 1e-11;
  const Summary summary = solve(problem, options, [&](const AcceptedState& accepted) {
    ++states;
    const Configuration& configuration = accepted.state.configuration;
    const auto about = [&](const std::string& surface, const Vector3d& point) {
      return wrench(discretisation, configuration, accepted.internal_force, accepted.external_force, surface,
                    point);
    };
    const Vector3d x_s = barycentre(discretisation, configuration, "x1");
    const Wrench at_surface = about("x1", x_s);
    const double direct = hinge.dot(about("x1", joint).moment_n_m);
    const double through_surface = hinge.dot(moved(at_surface, x_s, joint).moment_n_m);
    const LineOfAction line = line_of_action(at_surface, x_s);
    const double through_line =
        hinge.dot((line.point_m - joint).cross(at_surface.force_n) + line.parallel_moment_n_m);
    const double scale = at_surface.force_n.norm() * (x_s - joint).norm();
    EXPECT_NEAR(through_surface, direct, 1e-13 * scale);
    EXPECT_NEAR(through_line, direct, 1e-13 * scale);
    // Balance of forces and moments on the whole body.
    const Wrench origin = about("x0", joint), insertion = about("x1", joint);
    EXPECT_LT((origin.force_n + insertion.force_n).norm(), 1e-9 * insertion.force_n.norm());
    EXPECT_LT((origin.moment_n_m + insertion.moment_n_m).norm(), 1e-9 * scale);
  });
  EXPECT_TRUE(summary.completed) << summary.reason;
  EXPECT_GE(states, 4);
}

INSTANTIATE_TEST_SUITE_P(Formulations, Wrenches, testing::ValuesIn(mixed_formulations()),
                         named_by_formulation);

TEST(StressWrench, ComesNearTheReactionsUnderRefinement) {
  double before = 0.0;
  for (const int n : {2, 4}) {
    const Problem problem = bent_and_twisted(Formulation::q2_p1_discontinuous, {2 * n, n, n});
    SolveOptions options;
    options.on_instability = "report";
    options.volume_tolerance = 1e-6;
    const Solved solved = run(problem, options);
    ASSERT_TRUE(solved.summary.completed);
    const Vector3d joint(0.05, -0.02, 0.01);
    const Wrench nodal =
        wrench(*solved.discretisation, solved.configuration, solved.internal, solved.external, "x1", joint);
    const Wrench stress = stress_wrench(problem, *solved.discretisation, solved.configuration, "x1", joint);
    const double error = (nodal.force_n - stress.force_n).norm() / nodal.force_n.norm();
    RecordProperty("error_" + std::to_string(n), std::to_string(error));
    if (n == 2) {
      EXPECT_LT(error, 0.1);
    } else {
      EXPECT_LT(error, 0.7 * before);  // the clamped edges are singular
    }
    before = error;
  }
}

}  // namespace
}  // namespace brachium::fem::verification
