#include "optimise/solve.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "toy_problems.hpp"

namespace brachium::optimise {
namespace {

using tests::decay;
using tests::rosenbrock;
using tests::toy_parameter;
using tests::ToyProblem;

SolveOptions with(Solver solver) {
  SolveOptions options;
  options.solver = solver;
  options.max_iterations = 2000;
  options.max_evaluations = 6000;
  return options;
}

class EverySolver : public ::testing::TestWithParam<Solver> {};

TEST_P(EverySolver, FindsTheFloorOfRosenbrocksValley) {
  const Summary summary = solve(rosenbrock(), with(GetParam()));
  const bool exact = GetParam() <= Solver::lbfgs;
  EXPECT_NEAR(summary.x[0], 1.0, exact ? 1e-6 : 2e-2) << to_string(GetParam()) << ": " << summary.message();
  EXPECT_NEAR(summary.x[1], 1.0, exact ? 1e-6 : 4e-2) << to_string(GetParam()) << ": " << summary.message();
  EXPECT_LT(summary.cost, summary.cost_start);
}

TEST_P(EverySolver, StopsOnTheBoundThatCutsTheValley) {
  // With x <= 0.5 the minimum is at x = 0.5, y = 0.25, f = 0.125.
  const Summary summary = solve(rosenbrock(0.5), with(GetParam()));
  EXPECT_NEAR(summary.x[0], 0.5, 2e-3) << to_string(GetParam()) << ": " << summary.message();
  EXPECT_NEAR(summary.cost, 0.125, 2e-3) << to_string(GetParam());
  EXPECT_LE(summary.x[0], 0.5);
}

TEST_P(EverySolver, RepeatsExactlyAndDoesNotDependOnThreads) {
  SolveOptions options = with(GetParam());
  options.max_evaluations = 300;
  options.starts = 3;
  const Summary one = solve(decay(), options);
  options.threads = 2;
  const Summary two = solve(decay(), options);
  EXPECT_EQ(one.cost, two.cost);
  EXPECT_EQ(one.evaluations, two.evaluations);
  EXPECT_TRUE((one.x.array() == two.x.array()).all());
}

INSTANTIATE_TEST_SUITE_P(Solvers, EverySolver,
                         ::testing::Values(Solver::levenberg_marquardt, Solver::gsl_levenberg_marquardt,
                                           Solver::slsqp, Solver::lbfgs, Solver::mma, Solver::bobyqa,
                                           Solver::subplex, Solver::crs2, Solver::isres, Solver::mlsl),
                         [](const auto& one) { return to_string(one.param); });

TEST(Solve, OwnAndGslLevenbergMarquardtAgreeOnADisturbedDecay) {
  const Summary own = solve(decay(), with(Solver::levenberg_marquardt));
  const Summary gsl = solve(decay(), with(Solver::gsl_levenberg_marquardt));
  EXPECT_TRUE(own.converged);
  for (int j = 0; j < 3; ++j) EXPECT_NEAR(own.x[j], gsl.x[j], 1e-7 * std::abs(gsl.x[j]));
  EXPECT_NEAR(own.cost, gsl.cost, 1e-12 * gsl.cost);
}

TEST(Solve, APriorPullsTheLinearEstimateAsTheClosedFormSays) {
  // r_i = x - 3 (four times) with prior 1 +- 0.5: x = (4 * 3 + 4 * 1) / (4 + 4) = 2.
  std::vector<Parameter> parameters = {toy_parameter("x", 0.0, -10.0, 10.0)};
  parameters[0].prior = Prior{1.0, 0.5};
  const ToyProblem problem(parameters, 4,
                           [](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
                             r = Eigen::VectorXd::Constant(4, x[0] - 3.0);
                             if (J) *J = Eigen::MatrixXd::Ones(4, 1);
                           });
  const Summary summary = solve(problem, {});
  EXPECT_NEAR(summary.x[0], 2.0, 1e-12);
  EXPECT_NEAR(summary.cost, 0.5 * (4.0 * 1.0 + 4.0), 1e-12);
}

TEST(Solve, MultiStartLeavesALocalMinimum) {
  // f = 1/2 (cos-shaped)^2 with the lower valley far from the start.
  const ToyProblem problem({toy_parameter("x", 4.5, -6.0, 6.0)}, 2,
                           [](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
                             r.resize(2);
                             r << 1.0 + std::sin(2.0 * x[0]), 0.3 * (x[0] + 2.0);
                             if (!J) return;
                             J->resize(2, 1);
                             *J << 2.0 * std::cos(2.0 * x[0]), 0.3;
                           });
  SolveOptions options;
  const Summary single = solve(problem, options);
  options.starts = 12;
  const Summary many = solve(problem, options);
  EXPECT_GT(single.cost, 0.5);
  EXPECT_LT(many.cost, 0.25);
  EXPECT_EQ(many.starts.size(), 12u);
}

TEST(Solve, APointWithoutAValueIsNoStepAndNotFatal) {
  // The model fails left of 0.5; the way from 3 to 1 would first overshoot there.
  const ToyProblem problem(
      {toy_parameter("x", 3.0, -5.0, 5.0)}, 1,
      [](const Eigen::VectorXd& x, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
        if (x[0] < 0.5)
          throw data::ConvergenceFailure({"muscle `toy`, frame 3", "no root", 9, 1.0, 1.0, "toy"});
        r = Eigen::VectorXd::Constant(1, std::log(x[0]));
        if (J) *J = Eigen::MatrixXd::Constant(1, 1, 1.0 / x[0]);
      });
  const Summary summary = solve(problem, {});
  EXPECT_NEAR(summary.x[0], 1.0, 1e-9);
  EXPECT_NE(summary.reason.find("points without a value"), std::string::npos) << summary.reason;
}

TEST(Solve, ReportsOneRowAnIterationWithFallingCost) {
  SolveOptions options;
  std::vector<Iteration> rows;
  options.progress = [&](const Iteration& row) { rows.push_back(row); };
  const Summary summary = solve(decay(), options);
  ASSERT_GT(rows.size(), 2u);
  EXPECT_EQ(rows.size(), summary.iterations.size());
  for (std::size_t i = 1; i < rows.size(); ++i) EXPECT_LT(rows[i].cost, rows[i - 1].cost);
  EXPECT_EQ(log_heading().size(), log_row(rows.back()).size());
}

TEST(Solve, RefusesBadParametersAllAtOnce) {
  std::vector<Parameter> parameters = {toy_parameter("x", 3.0, 0.0, 2.0), toy_parameter("y", 1.0, 2.0, 1.0),
                                       toy_parameter("y", std::nan(""), 0.0, 1.0)};
  parameters[1].scale = 1.0;
  try {
    check_parameters(parameters);
    FAIL();
  } catch (const data::InputError& error) {
    ASSERT_EQ(error.diagnostics().size(), 4u);
    EXPECT_EQ(error.diagnostics()[0].message, "parameter `toy x`: start 3 is outside the bounds [0, 2]");
    EXPECT_EQ(error.diagnostics()[1].message,
              "parameter `toy y`: lower bound 2 is not below the upper bound 1");
    EXPECT_EQ(error.diagnostics()[3].code, "duplicate-parameter");
  }
}

TEST(Solve, NamesTheNearestSolver) {
  try {
    parse_solver("slsp");
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message, "`slsp` is not a solver");
    EXPECT_EQ(error.diagnostics()[0].help, "did you mean `slsqp`?");
  }
}

}  // namespace
}  // namespace brachium::optimise
