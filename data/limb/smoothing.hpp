#pragma once
/// Smoothing of recorded motion without phase lag, and its time derivatives.
///
/// | symbol | identifier | unit | meaning                                                                   |
/// |--------|------------|------|---------------------------------------------------------------------------|
/// | f_c    | cutoff_hz  | Hz   | where the gain of both passes together is 1/sqrt(2)                       |
/// | f_s    | rate_hz    | Hz   | sampling rate                                                             |
///
/// A second-order Butterworth low-pass run forwards and backwards (effective order 4, no phase lag). The
/// design frequency is prewarped and raised so that the two passes together have -3 dB exactly at f_c:
///   tan(pi f_d / f_s) = tan(pi f_c / f_s) (sqrt(2) - 1)^(-1/4)     (Winter 2009, ch. 3.4.4; Robertson &
///   Dowling
/// 2003, doi:10.1016/S1050-6411(03)00080-4). The record is continued at both ends by odd reflection over two
/// periods of f_c; within one period of the ends the result leans on that continuation.

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace brachium::limb {

struct Smoothing {
  double cutoff_hz = 0.0;
  double rate_hz = 0.0;

  /// Samples at each end that lean on the continuation: one period of the cut-off.
  std::size_t edge_samples() const;
};

/// The record smoothed. Throws InputError, naming `what`: "cutoff-above-nyquist" (f_c must lie in (0, 0.45
/// f_s)), "trial-too-short" (it must be longer than two periods of f_c), "not-finite" (first bad sample).
std::vector<double> smooth(std::span<const double> samples, const Smoothing& smoothing,
                           const std::string& what);

/// Each row of a d x n record smoothed.
Eigen::MatrixXd smooth_rows(const Eigen::MatrixXd& rows, const Smoothing& smoothing, const std::string& what);

/// Time derivative of each row by differences of fourth order (one-sided of the same order at the ends); n
/// >= 5.
Eigen::MatrixXd derivative_rows(const Eigen::MatrixXd& rows, double rate_hz);
std::vector<double> derivative(std::span<const double> samples, double rate_hz);

}  // namespace brachium::limb
