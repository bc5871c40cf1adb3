#pragma once
/// What noise in the excitations does to calibrated parameters, and an estimate without its bias.
///
/// An envelope is a noisy estimate of the amplitude of a noise: e_observed(t) = e(t) (1 + eta(t)), with eta
/// of coefficient of variation c and the correlation time of the low-pass. Least squares then attenuates what
/// the excitation multiplies and shifts weight between channels that resemble each other, however long the
/// trial is. The score that the noise-free excitations would give is estimated by adding the same noise once
/// more (corrected score, Nakamura 1990, doi:10.1093/biomet/77.1.127, its correction simulated as in Cook &
/// Stefanski 1994, doi:10.1080/01621459.1994.10476871, but extrapolated in the score, where it is linear in
/// the variance, not in x):
///
///     0 = 2 J'r - mean_k J_k'r_k + P (x - mean),    H = 2 J'J - mean_k J_k'J_k + P,    C = H^-1 (S + P) H^-1
///
/// with S the long-run covariance of the corrected scores. In a linear model this is the method of moments
/// for errors in the regressors. bias = x_least_squares - x.
///
/// | symbol | identifier                | unit | meaning                                                      |
/// |--------|---------------------------|------|--------------------------------------------------------------|
/// | c      | coefficient_of_variation  | 1    | of the envelope at constant effort                           |
/// | f_c    | cutoff_hz                 | Hz   | -3 dB cut-off of the envelope's low-pass, all passes together |
/// | k      | replicates                | 1    | simulated data sets, in pairs of opposite noise              |
/// | J'J, H | -                         | -    | reliability: eigenvalues of H relative to J'J + P            |

#include <cstdint>
#include <vector>

#include "optimise/calibration_problem.hpp"

namespace brachium::optimise {

/// The law of the noise in an envelope.
struct ExcitationNoise {
  double coefficient_of_variation = 0.0;  ///< c; 0: no noise
  /// How well c is known, relative: real EMG is not the Gaussian noise c is computed from. What a
  /// wrong c does to x, 2 (dx / d ln c^2) times this, is part of the covariance.
  double coefficient_uncertainty = 0.15;
  /// F, the envelope at rest that has been taken off in the mean square (without_noise_floor), in units of
  /// excitation; 0: none. What is left, e, came of the envelope E = sqrt(e^2 + F^2), to which noise belongs:
  ///   var(E) = (c^2 (e^4 + 2 e^2 f^2) + c_n^2 F^4) / E^2
  double subtracted_floor = 0.0;
  double overlapping_floor = 0.0;              ///< f, see overlapping_noise_floor
  double rest_coefficient_of_variation = 0.0;  ///< c_n, of the envelope at rest
  double cutoff_hz = 6.0;
  int replicates = 20;  ///< simulated data sets
  int steps = 12;       ///< at most that many Newton steps on the corrected score
  std::uint64_t seed = 1;
};

/// sqrt(max(e^2 - floor^2, 0)): an envelope without the share of sensor noise, floor being the envelope at
/// rest.
std::vector<double> without_noise_floor(std::vector<double> envelope, double floor);

/// Excitations with one more dose of that noise, sign times the noise named by (seed, stream):
/// E = sqrt(e^2 + F^2), E + sign eta, F taken off again.
std::vector<double> with_envelope_noise(std::vector<double> excitation, double rate_hz,
                                        const ExcitationNoise& noise, std::uint64_t stream,
                                        double sign = 1.0);

/// f of ExcitationNoise: EMG and sensor noise beat with each other in the envelope only as far as their
/// spectra overlap, f^2 = floor^2 (int P_e P_n / (int P_e int P_n)) / (int P_e^2 / (int
/// P_e)^2). Spectra on one grid.
double overlapping_noise_floor(double floor, const std::vector<double>& emg_power,
                               const std::vector<double>& noise_power);

/// c of the linear envelope (full-wave rectified, zero-lag 4th-order Butterworth low-pass with -3 dB at
/// cutoff_hz) of Gaussian noise whose power spectrum is given on equally spaced frequencies: the
/// autocovariance of |x|, (2/pi) (rho asin rho + sqrt(1 - rho^2) - 1), integrated against the filter's
/// autocorrelation.
double envelope_coefficient_of_variation(const std::vector<double>& frequency_hz,
                                         const std::vector<double>& power, double cutoff_hz);
/// The same of a flat spectrum between two edges.
double envelope_coefficient_of_variation(double lower_edge_hz, double upper_edge_hz, double cutoff_hz);

/// Stationary Gaussian noise of unit variance with the spectrum of that low-pass; `count` samples at rate_hz.
std::vector<double> envelope_noise(std::size_t count, double rate_hz, double cutoff_hz, std::uint64_t seed,
                                   std::uint64_t stream);

struct ExcitationErrorResult {
  Eigen::VectorXd x;                    ///< n, root of the corrected score, inside the bounds
  Eigen::VectorXd bias;                 ///< n, least squares minus x, in the parameters' units
  Eigen::MatrixXd covariance;           ///< n x n of x
  Eigen::VectorXd bias_standard_error;  ///< Monte Carlo error of the bias, part of the covariance
  double explained_variance = 0.0;      ///< mean square of the scaled residuals that the noise itself brings
  double least_reliability = 1.0;       ///< smallest eigenvalue of H relative to J'J + P
  bool limited = false;  ///< it was below the least reliability that can be corrected for (0.15)
  bool converged = true;
  std::size_t replicates = 0;
  std::size_t failed = 0;  ///< data sets at which the model had no value (left out)
};

/// Starts at the least-squares solution x. Parameters flagged in `fixed` are held, others stay inside their
/// bounds. Throws data::InputError for a noise law outside its range, data::ConvergenceFailure if the model
/// has no value.
ExcitationErrorResult simulate_excitation_error(const CalibrationProblem& problem, const Eigen::VectorXd& x,
                                                const std::vector<bool>& fixed, const ExcitationNoise& noise,
                                                std::size_t threads = 1);

}  // namespace brachium::optimise
