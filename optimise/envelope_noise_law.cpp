/// The law of an envelope's noise from the spectra of EMG and sensor noise (excitation_error.hpp).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"
#include "optimise/excitation_error.hpp"

namespace brachium::optimise {
namespace {

/// |H|^2 of two passes of a second-order Butterworth low-pass whose joint -3 dB edge is f_c:
/// H = 1 / (1 + (f / f_p)^4), f_p = f_c / C, C = (sqrt(2) - 1)^(1/4).
double power_gain(double f, double cutoff_hz) {
  const double x = f * std::pow(std::sqrt(2.0) - 1.0, 0.25) / cutoff_hz;
  const double h = 1.0 / (1.0 + x * x * x * x);
  return h * h;
}

/// Autocovariance of |x| / E|x| for Gaussian x of autocorrelation rho: rho asin rho + sqrt(1 - rho^2) - 1.
double rectified_autocovariance(double rho) {
  const double r = std::clamp(rho, -1.0, 1.0);
  return r * std::asin(r) + std::sqrt(1.0 - r * r) - 1.0;
}

/// Variance of the low-passed |x| / E|x| by the spectrum of |x|: integral of S(f) |H(f)|^2 over all f.
double envelope_variance(const std::vector<double>& frequency_hz, const std::vector<double>& power,
                         double cutoff_hz) {
  const double top = frequency_hz.back();
  double total = 0.0;
  for (double p : power) total += p;
  // Lags up to where rho has died out; the spectrum of |x| is flat over the low-pass's band, but is not
  // assumed so.
  const double step = 1.0 / (8.0 * top), longest = 0.5 / cutoff_hz + 0.25;
  const auto lags = static_cast<std::size_t>(longest / step);
  double variance = 0.0;
  // R_h(tau), autocorrelation of the low-pass: integral of |H|^2 cos(2 pi f tau) df over all f.
  const double df = cutoff_hz / 100.0;
  const int bins = 600;
  for (std::size_t k = 0; k <= lags; ++k) {
    const double tau = static_cast<double>(k) * step;
    double rho = 0.0;
    for (std::size_t i = 0; i < power.size(); ++i)
      rho += power[i] * std::cos(2.0 * std::numbers::pi * frequency_hz[i] * tau);
    const double c = rectified_autocovariance(rho / total);
    if (std::abs(c) < 1e-12) continue;
    double filter = 0.0;
    for (int b = 0; b < bins; ++b) {
      const double f = (b + 0.5) * df;
      filter += 2.0 * power_gain(f, cutoff_hz) * std::cos(2.0 * std::numbers::pi * f * tau) * df;
    }
    variance += (k == 0 ? 1.0 : 2.0) * c * filter * step;
  }
  return variance;
}

}  // namespace

std::vector<double> without_noise_floor(std::vector<double> envelope, double floor) {
  if (!(floor >= 0.0) || !std::isfinite(floor))
    throw data::InputError("out-of-range", fmt::format("noise floor {} must not be negative", floor));
  for (double& value : envelope) value = std::sqrt(std::max(value * value - floor * floor, 0.0));
  return envelope;
}

double overlapping_noise_floor(double floor, const std::vector<double>& emg_power,
                               const std::vector<double>& noise_power) {
  if (emg_power.size() != noise_power.size() || emg_power.empty())
    throw data::InputError("wrong-size",
                           "the spectra of EMG and sensor noise must be given on the same frequencies");
  double e = 0.0, n = 0.0, ee = 0.0, en = 0.0;
  for (std::size_t i = 0; i < emg_power.size(); ++i) {
    e += emg_power[i];
    n += noise_power[i];
    ee += emg_power[i] * emg_power[i];
    en += emg_power[i] * noise_power[i];
  }
  if (!(ee > 0.0) || !(n > 0.0))
    throw data::InputError("out-of-range", "a spectrum without power has no noise floor");
  return floor * std::sqrt(en * e / (ee * n));
}

double envelope_coefficient_of_variation(const std::vector<double>& frequency_hz,
                                         const std::vector<double>& power, double cutoff_hz) {
  if (frequency_hz.size() < 2 || frequency_hz.size() != power.size() || !(cutoff_hz > 0.0))
    throw data::InputError(
        "wrong-size", "a spectrum needs as many powers as frequencies, two at least, and a cut-off above 0");
  return std::sqrt(std::max(envelope_variance(frequency_hz, power, cutoff_hz), 0.0));
}

double envelope_coefficient_of_variation(double lower_edge_hz, double upper_edge_hz, double cutoff_hz) {
  if (!(lower_edge_hz >= 0.0) || !(upper_edge_hz > lower_edge_hz) || !(cutoff_hz > 0.0))
    throw data::InputError("out-of-range", fmt::format("band {} to {} Hz with cut-off {} Hz is not possible",
                                                       lower_edge_hz, upper_edge_hz, cutoff_hz));
  std::vector<double> frequency, power;
  const int bins = 400;
  for (int b = 0; b < bins; ++b) {
    frequency.push_back(lower_edge_hz + (b + 0.5) * (upper_edge_hz - lower_edge_hz) / bins);
    power.push_back(1.0);
  }
  return envelope_coefficient_of_variation(frequency, power, cutoff_hz);
}

}  // namespace brachium::optimise
