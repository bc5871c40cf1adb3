#include "optimise/statistics.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Root mean square, in units of sigma, below which residuals are rounding: their correlation says nothing.
constexpr double kRounding = 1e-8;

/// Autocovariance sum_i r_i r_(i+k) over all blocks.
double lagged(const VectorXd& r, const std::vector<ResidualBlock>& blocks, std::size_t lag) {
  double sum = 0.0;
  for (const ResidualBlock& block : blocks) {
    if (block.count <= lag) continue;
    const auto first = static_cast<Index>(block.first), count = static_cast<Index>(block.count - lag);
    sum += r.segment(first, count).dot(r.segment(first + static_cast<Index>(lag), count));
  }
  return sum;
}

WeakDirection direction(const std::vector<Parameter>& parameters, VectorXd v, double relative) {
  WeakDirection weak;
  weak.relative_singular_value = relative;
  const double size = v.cwiseAbs().maxCoeff();
  for (Index j = 0; j < v.size(); ++j) {
    if (std::abs(v[j]) < 0.99 * size) continue;  // the first of the largest components is written positive
    if (v[j] < 0.0) v = -v;
    break;
  }
  std::vector<Index> order;
  for (Index j = 0; j < v.size(); ++j)
    if (std::abs(v[j]) > 0.25) order.push_back(j);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return std::abs(v[a]) > std::abs(v[b]) + 1e-9; });
  for (Index j : order) {
    const std::string label = parameters[static_cast<std::size_t>(j)].label();
    weak.parameters.push_back(label);
    weak.components.push_back(v[j]);
    weak.text += fmt::format("{}{} ({:+.2f})", weak.text.empty() ? "" : " with ", label, v[j]);
  }
  return weak;
}

}  // namespace

ResidualCorrelation residual_correlation(const VectorXd& r, const std::vector<ResidualBlock>& blocks) {
  ResidualCorrelation out;
  std::size_t longest = 0;
  for (const ResidualBlock& block : blocks) longest = std::max(longest, block.count);
  const double zero = lagged(r, blocks, 0);
  if (!(zero > 0.0)) return out;
  for (std::size_t lag = 1; lag < longest; ++lag) {
    const double rho = lagged(r, blocks, lag) / zero;
    out.first_crossing = lag;
    if (!(rho > 0.0)) break;
    out.inflation += 2.0 * rho;
  }
  return out;
}

// As the mean square of running sums over lag + 1 rows: the cost does not grow with the lag.
MatrixXd long_run_scores(const MatrixXd& G, const std::vector<ResidualBlock>& blocks, std::size_t lag) {
  const Index n = G.cols(), window = static_cast<Index>(lag) + 1;
  MatrixXd S = MatrixXd::Zero(n, n);
  for (const ResidualBlock& block : blocks) {
    const auto first = static_cast<Index>(block.first), count = static_cast<Index>(block.count);
    MatrixXd sums = MatrixXd::Zero(count + window - 1, n);
    for (Index j = 0; j < n; ++j) {
      double running = 0.0;
      for (Index t = 0; t < sums.rows(); ++t) {
        if (t < count) running += G(first + t, j);
        if (t >= window) running -= G(first + t - window, j);
        sums(t, j) = running;
      }
    }
    S.noalias() += sums.transpose() * sums / static_cast<double>(window);
  }
  return S;
}

void describe_covariance(const std::vector<Parameter>& parameters, const MatrixXd& jacobian,
                         const StatisticsOptions& options, FitStatistics& out) {
  const Index n = jacobian.cols();
  const VectorXd scale = scale_of(parameters);
  const MatrixXd Js = jacobian * scale.asDiagonal();
  const MatrixXd information = Js.transpose() * Js;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> data_eigen(information);
  const double largest = std::max(data_eigen.eigenvalues().maxCoeff(), 0.0);
  out.singular_values = data_eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().reverse();

  out.standard_error = out.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  out.weak.clear();
  out.correlated.clear();
  const double infinity = std::numeric_limits<double>::infinity();
  for (Index k = 0; k < n; ++k) {
    const double relative =
        largest > 0.0 ? std::sqrt(std::max(data_eigen.eigenvalues()[k], 0.0) / largest) : 0.0;
    if (relative > options.singular_tolerance) continue;
    const VectorXd v = data_eigen.eigenvectors().col(k);
    out.weak.push_back(direction(parameters, v, relative));
    for (Index j = 0; j < n; ++j)
      if (std::abs(v[j]) > 0.05 && !parameters[static_cast<std::size_t>(j)].prior)
        out.standard_error[j] = infinity;
  }
  // Directions the data do see, but not well enough to leave the middle of the bounds.
  const MatrixXd Cs = scale.cwiseInverse().asDiagonal() * out.covariance * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> cov_eigen(Cs);
  for (Index k = n - 1; k >= 0; --k) {
    if (!(1.96 * std::sqrt(std::max(cov_eigen.eigenvalues()[k], 0.0)) > 1.0)) break;
    const VectorXd v = cov_eigen.eigenvectors().col(k);
    const double seen = std::sqrt(std::max(v.dot(information * v), 0.0) / std::max(largest, 1e-300));
    if (seen > options.singular_tolerance) out.weak.push_back(direction(parameters, v, seen));
  }
  for (Index a = 0; a < n; ++a) {
    for (Index b = a + 1; b < n; ++b) {
      const double size = std::sqrt(out.covariance(a, a) * out.covariance(b, b));
      if (!(size > 0.0)) continue;
      const double correlation = out.covariance(a, b) / size;
      if (std::abs(correlation) > options.correlation_threshold)
        out.correlated.push_back({static_cast<std::size_t>(a), static_cast<std::size_t>(b), correlation});
    }
  }
  out.prior_ratio = VectorXd::Zero(n);
  for (Index j = 0; j < n; ++j) {
    const auto& prior = parameters[static_cast<std::size_t>(j)].prior;
    if (prior) out.prior_ratio[j] = out.standard_error[j] / prior->standard_deviation;
  }
}

FitStatistics fit_statistics(const std::vector<Parameter>& parameters, const VectorXd& x,
                             const VectorXd& residuals, const MatrixXd& jacobian,
                             const std::vector<ResidualBlock>& blocks, const StatisticsOptions& options) {
  const Index m = residuals.size(), n = x.size();
  if (jacobian.rows() != m || jacobian.cols() != n || static_cast<Index>(parameters.size()) != n)
    throw data::InputError("wrong-size",
                           fmt::format("{} residuals and {} parameters do not fit a {} x {} Jacobian", m, n,
                                       jacobian.rows(), jacobian.cols()));
  FitStatistics out;
  const bool rounding = residuals.squaredNorm() < kRounding * kRounding * static_cast<double>(m);
  const ResidualCorrelation correlation =
      rounding ? ResidualCorrelation{} : residual_correlation(residuals, blocks);
  out.inflation = correlation.inflation;
  out.effective_samples = static_cast<double>(m) / out.inflation;
  out.degrees_of_freedom = std::max(out.effective_samples - static_cast<double>(n), 0.0);
  out.residual_sd = std::sqrt(residuals.squaredNorm() / std::max(static_cast<double>(m - n), 1.0));

  const VectorXd scale = scale_of(parameters);
  const MatrixXd Js = jacobian * scale.asDiagonal();
  const MatrixXd information = Js.transpose() * Js;
  VectorXd prior = VectorXd::Zero(n);
  for (Index j = 0; j < n; ++j) {
    const auto& p = parameters[static_cast<std::size_t>(j)].prior;
    if (p) prior[j] = std::pow(scale[j] / p->standard_deviation, 2);
  }
  MatrixXd H = information;
  H.diagonal() += prior;

  const std::size_t lag = options.max_lag > 0 ? options.max_lag : 2 * correlation.first_crossing;
  const MatrixXd G = residuals.asDiagonal() * Js;
  const double small_sample = out.effective_samples / std::max(out.degrees_of_freedom, 1.0);
  MatrixXd S = long_run_scores(G, blocks, lag) * small_sample;
  S.diagonal() += prior;
  MatrixXd S_classical = information * (out.residual_sd * out.residual_sd * out.inflation * small_sample);
  S_classical.diagonal() += prior;

  // Pseudo-inverse of H over the directions that data or priors see.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(H);
  VectorXd inverse = VectorXd::Zero(n);
  const double cut = std::pow(options.singular_tolerance, 2) * std::max(eigen.eigenvalues().maxCoeff(), 0.0);
  for (Index k = 0; k < n; ++k)
    if (eigen.eigenvalues()[k] > cut) inverse[k] = 1.0 / eigen.eigenvalues()[k];
  const MatrixXd Hinv = eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
  MatrixXd C = Hinv * S * Hinv;
  const MatrixXd classical = Hinv * S_classical * Hinv;
  VectorXd raise = VectorXd::Ones(n);
  for (Index j = 0; j < n; ++j)
    if (C(j, j) > 0.0 && classical(j, j) > C(j, j)) raise[j] = std::sqrt(classical(j, j) / C(j, j));
  C = raise.asDiagonal() * C * raise.asDiagonal();
  out.covariance = scale.asDiagonal() * C * scale.asDiagonal();
  describe_covariance(parameters, jacobian, options, out);
  return out;
}

double student_quantile(double degrees_of_freedom, double probability) {
  if (!(degrees_of_freedom > 0.0)) return std::numeric_limits<double>::infinity();
  return gsl_cdf_tdist_Pinv(probability, degrees_of_freedom);
}

}  // namespace brachium::optimise
