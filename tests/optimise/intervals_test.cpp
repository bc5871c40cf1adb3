#include "optimise/intervals.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "toy_problems.hpp"

namespace brachium::optimise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd classical(const tests::ToyProblem& problem, const VectorXd& x, double sd) {
  VectorXd r;
  MatrixXd J;
  problem.evaluator()->evaluate(x, r, &J);
  return sd * sd * (J.transpose() * J).inverse();
}

// r = f(x) v: the likelihood-ratio interval is f^-1(f(x) +- t sd / |v|).
TEST(ProfileIntervals, OfOneParameterAreLikelihoodRatioIntervals) {
  const VectorXd v = VectorXd::LinSpaced(40, 0.5, 1.5);
  const tests::ToyProblem problem({tests::toy_parameter("x", 1.0, -3.0, 5.0)}, 40,
                                  [&](const VectorXd& x, VectorXd& r, MatrixXd* J) {
                                    r = std::exp(x[0]) * v;
                                    if (J) *J = r;
                                  });
  const VectorXd x = VectorXd::Constant(1, 1.0);
  const double sd = 5.5, t = 2.0, reach = t * sd / v.norm();
  const MatrixXd C = classical(problem, x, sd);
  const Intervals found = profile_intervals(problem, x, C, t);
  const double lower = std::log(std::exp(1.0) - reach), upper = std::log(std::exp(1.0) + reach);
  EXPECT_NEAR(found.lower[0], lower, 0.01 * (1.0 - lower));
  EXPECT_NEAR(found.upper[0], upper, 0.01 * (upper - 1.0));
  const double half = t * std::sqrt(C(0, 0));  // the symmetric interval is something else
  EXPECT_GT(std::abs(1.0 + half - upper), 0.2 * half);
  EXPECT_GT(std::abs(1.0 - half - lower), 0.2 * half);
}

TEST(ProfileIntervals, OfALinearModelAreSymmetric) {
  MatrixXd A(5, 2);
  A << 1, 0, 1, 1, 1, 2, 1, 3, 1, 4;
  const tests::ToyProblem problem(
      {tests::toy_parameter("a", 0.0, -1.0, 1.0), tests::toy_parameter("b", 0.0, -50.0, 50.0)}, 5,
      [&](const VectorXd& x, VectorXd& r, MatrixXd* J) {
        r = A * x;
        if (J) *J = A;
      });
  const VectorXd x = VectorXd::Constant(2, 0.3);
  const MatrixXd C = classical(problem, x, 0.7);
  const Intervals found = profile_intervals(problem, x, C, 2.5);
  for (int j = 0; j < 2; ++j) {
    EXPECT_NEAR(found.lower[j], x[j] - 2.5 * std::sqrt(C(j, j)), 1e-9);
    EXPECT_NEAR(found.upper[j], x[j] + 2.5 * std::sqrt(C(j, j)), 1e-9);
  }
}

// The same model written in x and in ln x: the same interval, which x +- t se is not.
TEST(ProfileIntervals, DoNotDependOnHowTheParameterIsWritten) {
  const VectorXd time = VectorXd::LinSpaced(30, 0.0, 3.0);
  const auto model = [&](double rate, double size, double chain, VectorXd& r, MatrixXd* J) {
    r = size * (-rate * time.array()).exp().matrix();
    if (!J) return;
    J->resize(30, 2);
    J->col(0) = -chain * (time.array() * r.array()).matrix();
    J->col(1) = r / size;
  };
  const auto parameters = [](double start, double lower, double upper) {
    return std::vector{tests::toy_parameter("rate", start, lower, upper),
                       tests::toy_parameter("size", 2.0, 0.1, 10.0)};
  };
  const tests::ToyProblem plain(
      parameters(1.0, 0.01, 20.0), 30,
      [&](const VectorXd& x, VectorXd& r, MatrixXd* J) { model(x[0], x[1], 1.0, r, J); });
  const tests::ToyProblem logarithm(parameters(0.0, std::log(0.01), std::log(20.0)), 30,
                                    [&](const VectorXd& x, VectorXd& r, MatrixXd* J) {
                                      model(std::exp(x[0]), x[1], std::exp(x[0]), r, J);
                                    });
  const VectorXd x{{1.0, 2.0}}, y{{0.0, 2.0}};
  const MatrixXd C = classical(plain, x, 0.4), D = classical(logarithm, y, 0.4);
  const Intervals a = profile_intervals(plain, x, C, 2.0), b = profile_intervals(logarithm, y, D, 2.0, 2);
  EXPECT_NEAR(a.lower[0], std::exp(b.lower[0]), 0.02 * (1.0 - a.lower[0]));
  EXPECT_NEAR(a.upper[0], std::exp(b.upper[0]), 0.02 * (a.upper[0] - 1.0));
  const double half = 2.0 * std::sqrt(C(0, 0));
  EXPECT_GT(std::abs(std::exp(2.0 * std::sqrt(D(0, 0))) - 1.0 - half), 0.1 * half);
  EXPECT_GT(a.upper[0] - 1.0, 1.1 * (1.0 - a.lower[0]));
}

}  // namespace
}  // namespace brachium::optimise
