// The clamped active block, 40 x 10 x 10 mm, fibres along x, both ends held, right end moved to the stretch
// and then activated; incompressible. Numbers of an independent code (dolfinx):
// tests/fem/reference/clamped_block.py, and its converged values on three or more meshes.

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

constexpr double mm = 1e-3;

Problem clamped_block(Formulation formulation, std::array<int, 3> cells, double stretch,
                      std::vector<double> activations) {
  Problem problem;
  problem.mesh = box_mesh(
      {.type = cell_type(formulation), .cells = cells, .size_m = Eigen::Vector3d(40.0, 10.0, 10.0) * mm});
  problem.formulation = formulation;
  problem.materials = {{block_muscle(), {VolumetricLaw::quadratic, incompressible}}};
  problem.tissue = uniform_fibres(*problem.mesh, formulation, Eigen::Vector3d::UnitX());
  problem.conditions = {
      condition("left", "x0", Fixed{}),
      condition("right", "x1",
                RigidMotion{.translation_m = Eigen::Vector3d((stretch - 1.0) * 40.0 * mm, 0.0, 0.0)})};
  problem.programme = {phase("stretch", {{"right", 1.0}}, {}, 2)};
  for (const double a : activations) problem.programme.push_back(phase("activate", {}, {{"body", a}}, 1));
  return problem;
}

/// Axial force [N] at the end of each phase.
std::vector<double> forces(const Problem& problem, const SolveOptions& options,
                           std::vector<std::string>* verdicts = nullptr) {
  std::vector<double> result(problem.programme.size(), 0.0);
  const Discretisation discretisation(problem.mesh, problem.formulation);
  std::vector<std::string> stability(problem.programme.size());
  const Summary summary = solve(problem, options, [&](const AcceptedState& accepted) {
    for (std::size_t p = 0; p < problem.programme.size(); ++p) {
      if (accepted.state.phase != static_cast<int>(p) || accepted.state.phase_time < 1.0) continue;
      result[p] = -wrench(discretisation, accepted.state.configuration, accepted.internal_force,
                          accepted.external_force, "x1", Eigen::Vector3d::Zero())
                       .force_n[0];
      stability[p] = accepted.record.stability.verdict;
    }
  });
  EXPECT_TRUE(summary.completed) << summary.reason;
  if (verdicts) *verdicts = stability;
  return result;
}

SolveOptions ordinary() {
  SolveOptions options;
  options.threads = 1;
  options.volume_tolerance = 1e-7;
  return options;
}

TEST(ClampedBlock, TaylorHoodAgreesWithAnIndependentCodeOnTheSameMesh) {
  std::vector<std::string> verdicts;
  const std::vector<double> f = forces(
      clamped_block(Formulation::q2_q1_taylor_hood, {8, 2, 2}, 1.1, {0.25, 0.5, 1.0}), ordinary(), &verdicts);
  EXPECT_NEAR(f[0], 0.4077148, 1e-6);
  EXPECT_NEAR(f[1], 7.6908598, 1e-5);
  EXPECT_NEAR(f[2], 14.9722188, 1e-5);
  EXPECT_NEAR(f[3], 29.5330076, 3e-5);
  for (const std::string& v : verdicts) EXPECT_EQ(v, "stable");
}

TEST(ClampedBlock, CondensedCellsAgreeWithAnIndependentCodeOnTheSameMesh) {
  const std::vector<double> f =
      forces(clamped_block(Formulation::q2_p1_discontinuous, {16, 4, 4}, 1.1, {0.25, 0.5}), ordinary());
  EXPECT_NEAR(f[0], 0.4061068, 1e-6);
  EXPECT_NEAR(f[1], 7.6919156, 5e-6);
  EXPECT_NEAR(f[2], 14.9752861, 1e-5);
}

class ClampedBlockForce : public testing::TestWithParam<Formulation> {};

TEST_P(ClampedBlockForce, IsWithinAThousandthOfTheConvergedValue) {
  const bool tetrahedra = data::corners_per_cell(cell_type(GetParam())) == 4;
  const std::array<int, 3> cells = tetrahedra ? std::array{12, 3, 3} : std::array{16, 4, 4};
  const std::vector<double> f = forces(clamped_block(GetParam(), cells, 1.1, {0.25, 0.5, 1.0}), ordinary());
  EXPECT_NEAR(f[1], 7.69149, 1e-3 * 7.69149);
  EXPECT_NEAR(f[2], 14.97567, 1e-3 * 14.97567);
  EXPECT_NEAR(f[3], 29.54226, 1e-3 * 29.54226);
}

INSTANTIATE_TEST_SUITE_P(Formulations, ClampedBlockForce,
                         testing::Values(Formulation::q2_q1_taylor_hood, Formulation::p2_p1_taylor_hood,
                                         Formulation::p2b_p1_discontinuous),
                         named_by_formulation);

// Larger stretch, where fibres at the clamped edges stiffen and the limit comes slowly (1.3: 1.24801 N), and no
// fibres at all (.40494 N in the limit).
TEST(ClampedBlock, PassiveForcesAgreeWithAnIndependentCodeOnTheSameMesh) {
  const auto passive = [](double stretch, double fibres) {
    Problem problem = clamped_block(Formulation::q2_q1_taylor_hood, {16, 4, 4}, stretch, {});
    MuscleTendon m = block_muscle();
    m.muscle.c3_pa *= fibres;
    m.tendon.c3_pa *= fibres;
    problem.materials = {{m, {VolumetricLaw::quadratic, incompressible}}};
    return forces(problem, ordinary())[0];
  };
  EXPECT_NEAR(passive(1.1, 1.0), 0.4060482, 1e-6);
  EXPECT_NEAR(passive(1.2, 1.0), 0.7269221, 1e-6);
  EXPECT_NEAR(passive(1.3, 1.0), 1.2598628, 1e-6);
  EXPECT_NEAR(passive(1.1, 0.0), 0.40494, 3e-3 * 0.40494);
}

// 15.784 N on every mesh; a stable state by the independent code's count too.
TEST(ClampedBlock, ContractionAtTheTopOfTheForceLengthCurveAgreesInForceAndStability) {
  for (const auto& [cells, force] :
       {std::pair{std::array{8, 2, 2}, 15.7820133}, std::pair{std::array{16, 4, 4}, 15.7840725}}) {
    std::vector<std::string> verdicts;
    SolveOptions options = ordinary();
    options.on_instability = "report";
    const std::vector<double> f =
        forces(clamped_block(Formulation::q2_q1_taylor_hood, cells, 1.2, {0.5}), options, &verdicts);
    EXPECT_NEAR(f[1], force, 1e-5);
    EXPECT_EQ(verdicts[1], "stable");
  }
}

// Where plain Newton is lost: what is reached is a stable equilibrium of the block itself, nothing viscous left.
TEST(ClampedBlock, ContinuationGetsThroughWhereNewtonIsLost) {
  for (const auto& [stretch, activation] : {std::pair{1.2, 1.0}, std::pair{1.3, 0.25}}) {
    const Solved solved =
        run(clamped_block(Formulation::q2_p1_discontinuous, {8, 2, 2}, stretch, {activation}), ordinary());
    EXPECT_EQ(solved.summary.steps.back().stability.verdict, "stable") << stretch;
    EXPECT_LE(solved.summary.steps.back().relative_residual, 1e-8) << stretch;
    EXPECT_NEAR(solved.reaction("x1")[0], -solved.reaction("x0")[0], 1e-5) << stretch;
  }
}

// At stretch 1 nothing moves but the pressure: 22.307012 N times the activation, exactly.
TEST(ClampedBlock, ForceAtRestLengthIsExact) {
  for (const Formulation formulation : {Formulation::q2_q1_taylor_hood, Formulation::q2_p1_discontinuous}) {
    Problem problem = clamped_block(formulation, {8, 2, 2}, 1.0, {0.5, 1.0});
    problem.programme.erase(problem.programme.begin());
    const std::vector<double> f = forces(problem, ordinary());
    const double expected = 0.3 * 100.0 * force_length(block_muscle().force_length, 1.0);
    EXPECT_NEAR(expected, 22.307012, 1e-6);
    EXPECT_NEAR(f[0], 0.5 * expected, 1e-6);
    EXPECT_NEAR(f[1], expected, 1e-6);
  }
}

}  // namespace
}  // namespace brachium::fem::verification
