#pragma once
/// What noise in the excitations does to calibrated parameters: bias and spread by simulation.
///
/// An envelope is a noisy estimate of the amplitude of a noise: e_observed(t) = e(t) (1 + eta(t)), with eta of
/// coefficient of variation c and the correlation time of the low-pass. In a least-squares fit it attenuates the
/// gains of what it multiplies, however long the trial is. Adding further noise of the same law and refitting
/// (a simulation-extrapolation step, Cook & Stefanski 1994, doi:10.1080/01621459.1994.10476871, linear in the
/// variance) shows bias and spread:
///
///     bias = mean_k(x*_k) - x^,    corrected x = x^ - bias,    C_excitation = cov_k(x*_k)
///
/// | symbol | identifier                | unit | meaning                                                       |
/// |--------|---------------------------|------|---------------------------------------------------------------|
/// | c      | coefficient_of_variation  | 1    | of the envelope at constant effort                            |
/// | B      | bandwidth_hz              | Hz   | width of the conditioned EMG's band                           |
/// | f_c    | cutoff_hz                 | Hz   | -3 dB cut-off of the envelope's low-pass, all passes together |

#include <cstdint>
#include <vector>

#include "optimise/calibration_problem.hpp"

namespace brachium::optimise {

/// The law of the noise in an envelope.
struct ExcitationNoise {
  double coefficient_of_variation = 0.0;  ///< c; 0: no noise
  double cutoff_hz = 6.0;
  int replicates = 40;        ///< simulated data sets
  int steps = 2;              ///< Gauss-Newton steps of each refit
  std::uint64_t seed = 1;
};

/// c of the linear envelope (full-wave rectified, zero-lag 4th-order Butterworth low-pass with -3 dB at cutoff_hz) of
/// Gaussian noise whose power spectrum is given on equally spaced frequencies: the autocovariance of |x|,
/// (2/pi) (rho asin rho + sqrt(1 - rho^2) - 1), integrated against the filter's autocorrelation.
double envelope_coefficient_of_variation(const std::vector<double>& frequency_hz, const std::vector<double>& power,
                                         double cutoff_hz);
/// The same of a flat spectrum between two edges.
double envelope_coefficient_of_variation(double lower_edge_hz, double upper_edge_hz, double cutoff_hz);

/// Stationary Gaussian noise of unit variance with the spectrum of that low-pass; `count` samples at rate_hz.
std::vector<double> envelope_noise(std::size_t count, double rate_hz, double cutoff_hz, std::uint64_t seed,
                                   std::uint64_t stream);

struct ExcitationErrorResult {
  Eigen::VectorXd bias;                 ///< n, in the parameters' units
  Eigen::MatrixXd covariance;           ///< n x n of the refits
  Eigen::VectorXd bias_standard_error;  ///< Monte Carlo error of the bias
  double explained_variance = 0.0;      ///< mean square of the scaled residuals that the noise itself brings
  std::size_t replicates = 0;
  std::size_t failed = 0;               ///< refits at which the model had no value (left out)
};

/// Refits about x with simulated noise; parameters flagged in `fixed` are held, others stay inside their bounds.
ExcitationErrorResult simulate_excitation_error(const CalibrationProblem& problem, const Eigen::VectorXd& x,
                                                const std::vector<bool>& fixed, const ExcitationNoise& noise,
                                                std::size_t threads = 1);

}  // namespace brachium::optimise
