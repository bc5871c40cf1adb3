#include "optimise/statistics.hpp"

#include <fmt/format.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <cmath>

#include "emg/random.hpp"
#include "optimise/solve.hpp"
#include "optimise/verdicts.hpp"
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

/// (J'J)^-1 as GSL has it.
MatrixXd gsl_covariance(const MatrixXd& J) {
  const auto m = static_cast<std::size_t>(J.rows()), n = static_cast<std::size_t>(J.cols());
  gsl_matrix *rows = gsl_matrix_alloc(m, n), *out = gsl_matrix_alloc(n, n);
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t j = 0; j < n; ++j)
      gsl_matrix_set(rows, i, j, J(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)));
  gsl_multifit_nlinear_covar(rows, 0.0, out);
  MatrixXd C(J.cols(), J.cols());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j)
      C(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = gsl_matrix_get(out, i, j);
  gsl_matrix_free(rows);
  gsl_matrix_free(out);
  return C;
}

TEST(Statistics, GslsCovarianceOfALineIsTheTextbooks) {
  // var b = 1/Sxx, var a = 1/m + mean^2/Sxx, cov(a, b) = -mean/Sxx, in units of the residuals' variance.
  const VectorXd t = VectorXd::LinSpaced(50, 2.0, 9.0).array().square();
  MatrixXd J(50, 2);
  J << VectorXd::Ones(50), t;
  const double mean = t.mean(), Sxx = (t.array() - mean).square().sum();
  const MatrixXd C = gsl_covariance(J);
  EXPECT_NEAR(C(1, 1) * Sxx, 1.0, 1e-10);
  EXPECT_NEAR(C(0, 0) / (1.0 / 50.0 + mean * mean / Sxx), 1.0, 1e-10);
  EXPECT_NEAR(-C(0, 1) * Sxx / mean, 1.0, 1e-10);
}

TEST(Statistics, CorrelationsAboveTheLimitAreNamedInBothVerdicts) {
  // Of level and slope: -mean / sqrt(mean^2 + Sxx / m); -0.998 far from the origin, -0.866 beside it.
  const Line line(400);
  const VectorXd r = VectorXd::Constant(400, 0.3);
  std::vector<ResidualBlock> blocks;
  for (std::size_t i = 0; i < 400; ++i) blocks.push_back({"one", i, 1});
  for (const double from : {5.0, 0.0}) {
    const VectorXd t = VectorXd::LinSpaced(400, from, from + 1.0);
    MatrixXd J(400, 2);
    J << VectorXd::Ones(400), t;
    const double mean = t.mean(), Sxx = (t.array() - mean).square().sum();
    const FitStatistics s = fit_statistics(line.parameters, line.truth, r, J, blocks);
    const double expected = -mean / std::sqrt(mean * mean + Sxx / 400.0);
    if (from == 0.0) {
      EXPECT_GT(expected, -0.95);
      EXPECT_TRUE(s.correlated.empty());
      continue;
    }
    ASSERT_EQ(s.correlated.size(), 1u);
    EXPECT_NEAR(s.correlated[0].correlation, expected, 1e-9);
    VerdictInput input;
    input.parameters = &line.parameters;
    input.x = input.x_uncorrected = line.truth;
    input.bias = VectorXd::Zero(2);
    input.statistics = &s;
    input.intervals = {line.truth - s.standard_error, line.truth + s.standard_error};
    const auto found = verdicts(input);
    EXPECT_EQ(found[0].remark,
              fmt::format("correlated {:+.3f} with {}", expected, line.parameters[1].label()));
    EXPECT_EQ(found[1].remark,
              fmt::format("correlated {:+.3f} with {}", expected, line.parameters[0].label()));
  }
}

TEST(Statistics, OfResidualsOfOneSizeInBlocksOfOneAreGslsCovariance) {
  // Nothing to correlate, and the sandwich is s^2 J'J: what is left is the classical covariance.
  const Line line(400);
  VectorXd r = VectorXd::Constant(400, 0.3);
  for (Eigen::Index i = 0; i < 400; i += 3) r[i] = -0.3;
  std::vector<ResidualBlock> blocks;
  for (std::size_t i = 0; i < 400; ++i) blocks.push_back({"one", i, 1});
  const FitStatistics s = fit_statistics(line.parameters, line.truth, r, line.J, blocks);
  const MatrixXd C = gsl_covariance(line.J) * (s.residual_sd * s.residual_sd * 400.0 / 398.0);
  for (Eigen::Index i = 0; i < 2; ++i)
    for (Eigen::Index j = 0; j < 2; ++j)
      EXPECT_NEAR(s.covariance(i, j), C(i, j), 1e-10 * std::sqrt(C(i, i) * C(j, j)));
}

TEST(Statistics, OfNistsMisra1aAreTheCertifiedOnes) {
  // https://www.itl.nist.gov/div898/strd/nls/data/misra1a.shtml, y = b1 (1 - exp(-b2 x)): values certified to 11 digits.
  const VectorXd x{
      {77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0}};
  const VectorXd y{
      {10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78}};
  const auto evaluate = [&](const VectorXd& b, VectorXd& r, MatrixXd* J) {
    const VectorXd e = (-b[1] * x.array()).exp();
    r = b[0] * (1.0 - e.array()) - y.array();
    if (!J) return;
    J->resize(14, 2);
    J->col(0) = 1.0 - e.array();
    J->col(1) = b[0] * x.array() * e.array();
  };
  const tests::ToyProblem problem(
      {toy_parameter("b1", 250.0, 100.0, 600.0), toy_parameter("b2", 5e-4, 5e-5, 2e-3)}, 14, evaluate);
  for (const Solver solver : {Solver::levenberg_marquardt, Solver::gsl_levenberg_marquardt}) {
    SolveOptions options;
    options.solver = solver;
    options.max_iterations = 1000;
    const Summary summary = solve(problem, options);
    VectorXd r;
    MatrixXd J;
    evaluate(summary.x, r, &J);
    const double variance = r.squaredNorm() / 12.0;
    const MatrixXd C = gsl_covariance(J) * variance;
    EXPECT_NEAR(summary.x[0] / 2.3894212918e+02, 1.0, 1e-10) << to_string(solver);
    EXPECT_NEAR(summary.x[1] / 5.5015643181e-04, 1.0, 1e-10) << to_string(solver);
    EXPECT_NEAR(std::sqrt(variance) / 1.0187876330e-01, 1.0, 1e-10) << to_string(solver);
    EXPECT_NEAR(std::sqrt(C(0, 0)) / 2.7070075241e+00, 1.0, 1e-10) << to_string(solver);
    EXPECT_NEAR(std::sqrt(C(1, 1)) / 7.2668688436e-06, 1.0, 1e-10) << to_string(solver);
  }
}

TEST(Statistics, OfUncorrelatedResidualsAreCloseToTheClassicalOnes) {
  const Line line(4000);
  const VectorXd y = line.J * line.truth + noise(4000, 0.0, 3);
  const VectorXd x = line.J.colPivHouseholderQr().solve(y), r = line.J * x - y;
  const FitStatistics s = fit_statistics(line.parameters, x, r, line.J, {{"all", 0, 4000}});
  const MatrixXd C = gsl_covariance(line.J);
  for (Eigen::Index j = 0; j < 2; ++j) {
    const double classical = std::sqrt(C(j, j)) * s.residual_sd;
    EXPECT_NEAR(s.standard_error[j], classical, 0.12 * classical);
  }
  EXPECT_NEAR(s.inflation, 1.0, 0.1);
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

TEST(Statistics, ResidualsAtRoundingCountAsManySamplesAsTheyAre) {
  const Line line(400);
  const VectorXd course = VectorXd::LinSpaced(400, 0.0, 3.0).array().sin();
  const auto degrees = [&](double size) {
    return fit_statistics(line.parameters, line.truth, size * course, line.J, {{"all", 0, 400}})
        .degrees_of_freedom;
  };
  EXPECT_EQ(degrees(1e-12), 398.0);
  EXPECT_LT(degrees(1e-3), 4.0);
}

TEST(Statistics, StudentQuantileIsTheTabulatedOne) {
  EXPECT_NEAR(student_quantile(10.0), 2.228138852, 1e-8);
  EXPECT_NEAR(student_quantile(1e7), 1.959964, 1e-5);
  EXPECT_TRUE(std::isinf(student_quantile(0.0)));
}

}  // namespace
}  // namespace brachium::optimise
