#include "optimise/statistics.hpp"

#include <gsl/gsl_multifit_nlinear.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "emg/random.hpp"
#include "toy_problems.hpp"

namespace brachium::optimise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using tests::toy_parameter;

struct Line {
  std::vector<Parameter> parameters = {toy_parameter("level", 0.0, -5.0, 5.0),
                                       toy_parameter("slope", 0.0, -5.0, 5.0)};
  MatrixXd J;
  VectorXd truth = VectorXd::Zero(2);

  explicit Line(Eigen::Index m) : J(m, 2) {
    for (Eigen::Index i = 0; i < m; ++i) J.row(i) << 1.0, std::sin(0.01 * static_cast<double>(i));
    truth << 1.0, -0.5;
  }
};

/// AR(1) noise of unit variance.
VectorXd noise(Eigen::Index m, double rho, std::uint64_t seed) {
  emg::Random random(seed);
  VectorXd out(m);
  double state = random.normal();
  for (Eigen::Index i = 0; i < m; ++i, state = rho * state + std::sqrt(1.0 - rho * rho) * random.normal())
    out[i] = state;
  return out;
}

TEST(Statistics, OfUncorrelatedResidualsMatchTheClassicalCovarianceOfGsl) {
  const Line line(4000);
  const VectorXd y = line.J * line.truth + noise(4000, 0.0, 3);
  const VectorXd x = line.J.colPivHouseholderQr().solve(y), r = line.J * x - y;
  const FitStatistics s = fit_statistics(line.parameters, x, r, line.J, {{"all", 0, 4000}});
  gsl_matrix* J = gsl_matrix_alloc(4000, 2);
  for (std::size_t i = 0; i < 4000; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      gsl_matrix_set(J, i, j, line.J(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
  gsl_matrix* C = gsl_matrix_alloc(2, 2);
  gsl_multifit_nlinear_covar(J, 0.0, C);
  for (Eigen::Index j = 0; j < 2; ++j) {
    const double classical =
        std::sqrt(gsl_matrix_get(C, static_cast<std::size_t>(j), static_cast<std::size_t>(j))) *
        s.residual_sd;
    EXPECT_NEAR(s.standard_error[j], classical, 0.12 * classical);
  }
  EXPECT_NEAR(s.inflation, 1.0, 0.1);
  gsl_matrix_free(J);
  gsl_matrix_free(C);
}

TEST(Statistics, IntervalsCoverTheTruthUnderAutocorrelatedNoise) {
  // 400 independent data sets whose noise has 39 samples per independent sample: the classical +- would cover
  // about a quarter of the time.
  const Line line(4000);
  int covered = 0, classical = 0;
  const int sets = 400;
  for (int k = 0; k < sets; ++k) {
    const VectorXd y = line.J * line.truth + noise(4000, 0.95, 100 + static_cast<std::uint64_t>(k));
    const VectorXd x = line.J.colPivHouseholderQr().solve(y), r = line.J * x - y;
    const FitStatistics s = fit_statistics(line.parameters, x, r, line.J, {{"all", 0, 4000}});
    const double half = student_quantile(s.degrees_of_freedom) * s.standard_error[1];
    covered += std::abs(x[1] - line.truth[1]) <= half ? 1 : 0;
    classical += std::abs(x[1] - line.truth[1]) <= 1.96 * s.residual_sd / line.J.col(1).norm() ? 1 : 0;
  }
  EXPECT_GE(covered, 360);
  EXPECT_LE(covered, 396);
  EXPECT_LE(classical, 200);
}

TEST(Statistics, NameADirectionThatTheDataDoNotSee) {
  // Only the product gain * strength matters: equal columns.
  std::vector<Parameter> parameters = {toy_parameter("gain", 1.0, 0.5, 2.0),
                                       toy_parameter("strength", 1.0, 0.5, 2.0),
                                       toy_parameter("delay", 0.0, -1.0, 1.0)};
  MatrixXd J(200, 3);
  for (Eigen::Index i = 0; i < 200; ++i) J.row(i) << std::sin(0.1 * i), std::sin(0.1 * i), std::cos(0.1 * i);
  const FitStatistics s =
      fit_statistics(parameters, VectorXd::Ones(3), noise(200, 0.0, 1), J, {{"all", 0, 200}});
  EXPECT_TRUE(std::isinf(s.standard_error[0]));
  EXPECT_TRUE(std::isinf(s.standard_error[1]));
  EXPECT_TRUE(std::isfinite(s.standard_error[2]));
  ASSERT_GE(s.weak.size(), 1u);
  EXPECT_EQ(s.weak[0].text, "toy gain (+0.71) with toy strength (-0.71)");
  // A prior on one of them makes both finite, and is seen to decide.
  parameters[0].prior = Prior{1.0, 0.1};
  const FitStatistics p =
      fit_statistics(parameters, VectorXd::Ones(3), noise(200, 0.0, 1), J, {{"all", 0, 200}});
  EXPECT_TRUE(std::isfinite(p.standard_error[0]));
  EXPECT_NEAR(p.prior_ratio[0], 1.0, 1e-6);
}

TEST(Statistics, RunningSumsEqualTheBartlettSumOfNeweyAndWest) {
  const Line line(300);
  const VectorXd r = noise(300, 0.7, 5);
  StatisticsOptions options;
  options.max_lag = 9;
  const FitStatistics s =
      fit_statistics(line.parameters, line.truth, r, line.J, {{"a", 0, 120}, {"b", 120, 180}}, options);
  // The sum as it is written in the paper.
  MatrixXd S = MatrixXd::Zero(2, 2);
  const MatrixXd G = r.asDiagonal() * line.J;
  for (const auto& [first, count] : {std::pair<Eigen::Index, Eigen::Index>{0, 120}, {120, 180}})
    for (Eigen::Index i = first; i < first + count; ++i)
      for (Eigen::Index k = first; k < first + count; ++k)
        if (std::abs(i - k) <= 9)
          S += (1.0 - static_cast<double>(std::abs(i - k)) / 10.0) * G.row(i).transpose() * G.row(k);
  const double n = s.effective_samples;
  const MatrixXd H = (line.J.transpose() * line.J).inverse();
  const MatrixXd C = H * S * H * n / (n - 2.0);
  const MatrixXd classical = H * (s.residual_sd * s.residual_sd * s.inflation * n / (n - 2.0));
  for (Eigen::Index j = 0; j < 2; ++j)
    EXPECT_NEAR(s.covariance(j, j), std::max(C(j, j), classical(j, j)), 1e-10 * C(j, j));
}

TEST(Statistics, StudentQuantileIsTheTabulatedOne) {
  EXPECT_NEAR(student_quantile(10.0), 2.228138852, 1e-8);
  EXPECT_NEAR(student_quantile(1e7), 1.959964, 1e-5);
  EXPECT_TRUE(std::isinf(student_quantile(0.0)));
}

}  // namespace
}  // namespace brachium::optimise
