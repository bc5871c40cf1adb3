#pragma once
/// What a least-squares fit says of its parameters: covariance under autocorrelated residuals, directions that
/// the data do not see, correlations.
///
/// | symbol | identifier          | unit      | meaning                                                        |
/// |--------|---------------------|-----------|----------------------------------------------------------------|
/// | J      | jacobian            | 1 / unit  | m x n, residual rows only                                      |
/// | P      | -                   | 1 / unit^2| diagonal of 1 / sd^2 of the priors                             |
/// | H      | -                   | 1 / unit^2| J'J + P, the information the fit used                          |
/// | S      | -                   | 1 / unit^2| long-run covariance of the scores J_i' r_i                     |
/// | C      | covariance          | unit^2    | H^-1 (S + P) H^-1                                              |
/// | tau    | inflation           | 1         | samples per independent sample, 1 + 2 sum_k rho_k              |
///
/// C is the covariance of x^ when the data carry the long-run noise S and the prior means are themselves off by their
/// stated deviations (covariance P^-1, which enters the estimate through H^-1 P). It holds whatever weight the residuals
/// were given, and however they are correlated inside a block.

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "optimise/problem.hpp"

namespace brachium::optimise {

/// One contiguous, equally spaced run of residuals (a trial): correlation is sought inside, never across.
struct ResidualBlock {
  std::string name;
  std::size_t first = 0;
  std::size_t count = 0;
};

/// A direction in scaled parameter space along which the cost hardly changes.
struct WeakDirection {
  double relative_singular_value = 0.0;  ///< of the scaled Jacobian, against the largest
  std::vector<std::string> parameters;   ///< labels of the parameters that take part (|component| > 0.25)
  std::vector<double> components;        ///< of the unit vector, for these parameters
  std::string text;                      ///< "BICEPS gain (+0.71) with BIC strength (-0.70)"
};

struct CorrelatedPair {
  std::size_t first = 0, second = 0;  ///< indices of parameters
  double correlation = 0.0;
};

struct FitStatistics {
  double residual_sd = 0.0;         ///< sqrt(sum r^2 / (m - n)), in units of the scaled residuals
  double effective_samples = 0.0;   ///< m / tau
  double inflation = 1.0;           ///< tau >= 1: sum over blocks and lags of the residuals' autocorrelation
  double degrees_of_freedom = 0.0;  ///< effective_samples - n, at least 0
  Eigen::MatrixXd covariance;       ///< n x n, singular directions left out
  Eigen::VectorXd
      standard_error;  ///< sqrt of the diagonal; infinite along a singular direction without prior
  Eigen::VectorXd
      prior_ratio;  ///< posterior sd / prior sd, 0 where there is no prior: near 1, the prior decides
  std::vector<WeakDirection>
      weak;  ///< unseen directions, and those uncertain by more than the bounds' half width
  std::vector<CorrelatedPair> correlated;  ///< |correlation| > 0.95
  Eigen::VectorXd singular_values;         ///< of the scaled Jacobian (columns times scale)
};

struct StatisticsOptions {
  double singular_tolerance = 1e-6;  ///< relative singular value below which a direction counts as unseen
  double correlation_threshold = 0.95;
  std::size_t max_lag =
      0;  ///< samples; 0: automatic, first crossing of zero of the residuals' autocorrelation
};

/// Covariance at a solution: S with Bartlett weights inside blocks (Newey & West 1987, doi:10.2307/1913610;
/// lag from the first zero crossing of the residuals' autocorrelation, twice), times N / (N - n) with N
/// effective samples, and no standard error below the classical one with variance s^2 tau. All parameters are
/// treated as free, also those at a bound: wider, never falsely narrow. Noise-free data
/// (residuals below 1e-8 of sigma, whose correlation is not looked at) give a covariance near zero, weak
/// directions still named.
FitStatistics fit_statistics(const std::vector<Parameter>& parameters, const Eigen::VectorXd& x,
                             const Eigen::VectorXd& residuals, const Eigen::MatrixXd& jacobian,
                             const std::vector<ResidualBlock>& blocks, const StatisticsOptions& options = {});

/// How far residuals are correlated inside their blocks.
struct ResidualCorrelation {
  double inflation = 1.0;          ///< tau
  std::size_t first_crossing = 0;  ///< first lag at which the autocorrelation is not positive
};
ResidualCorrelation residual_correlation(const Eigen::VectorXd& residuals,
                                         const std::vector<ResidualBlock>& blocks);

/// sum over blocks and lags |k| <= lag of (1 - |k| / (lag + 1)) G_i' G_(i+k), with G the scores by row (m x
/// n).
Eigen::MatrixXd long_run_scores(const Eigen::MatrixXd& scores, const std::vector<ResidualBlock>& blocks,
                                std::size_t lag);

/// Standard errors, correlated pairs and weak directions of a covariance (in the parameters' units) as above,
/// for when another source of error has been added to it. `jacobian` as in fit_statistics.
void describe_covariance(const std::vector<Parameter>& parameters, const Eigen::MatrixXd& jacobian,
                         const StatisticsOptions& options, FitStatistics& statistics);

/// Quantile of Student's t distribution (two-sided 95 % by default) for nu > 0 degrees of freedom, by GSL.
double student_quantile(double degrees_of_freedom, double probability = 0.975);

}  // namespace brachium::optimise
