#include "optimise/excitation_error.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/model/error.hpp"
#include "data/model/parallel.hpp"
#include "emg/random.hpp"
#include "optimise/objective.hpp"

namespace brachium::optimise {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// |H|^2 of two passes of a second-order Butterworth low-pass whose joint -3 dB edge is f_c:
/// H = 1 / (1 + (f / f_p)^4), f_p = f_c / C, C = (sqrt(2) - 1)^(1/4).
double power_gain(double f, double cutoff_hz) {
  const double x = f * std::pow(std::sqrt(2.0) - 1.0, 0.25) / cutoff_hz;
  const double h = 1.0 / (1.0 + x * x * x * x);
  return h * h;
}

/// One pass of a second-order Butterworth low-pass, bilinear with prewarped edge.
struct LowPass {
  double b0, a1, a2;

  LowPass(double edge_hz, double rate_hz) {
    const double w = std::tan(std::numbers::pi * std::min(edge_hz / rate_hz, 0.49)), norm = 1.0 + std::numbers::sqrt2 * w + w * w;
    b0 = w * w / norm;
    a1 = 2.0 * (w * w - 1.0) / norm;
    a2 = (1.0 - std::numbers::sqrt2 * w + w * w) / norm;
  }

  void run(std::vector<double>& x) const {
    double s1 = 0.0, s2 = 0.0;  // transposed direct form II
    for (double& value : x) {
      const double y = b0 * value + s1;
      s1 = 2.0 * b0 * value - a1 * y + s2;
      s2 = b0 * value - a2 * y;
      value = y;
    }
  }

  void both_ways(std::vector<double>& x) const {
    run(x);
    std::reverse(x.begin(), x.end());
    run(x);
    std::reverse(x.begin(), x.end());
  }
};

/// Autocovariance of |x| / E|x| for Gaussian x of autocorrelation rho: rho asin rho + sqrt(1 - rho^2) - 1.
double rectified_autocovariance(double rho) {
  const double r = std::clamp(rho, -1.0, 1.0);
  return r * std::asin(r) + std::sqrt(1.0 - r * r) - 1.0;
}

/// Variance of the low-passed |x| / E|x| by the spectrum of |x|: integral of S(f) |H(f)|^2 over all f.
double envelope_variance(const std::vector<double>& frequency_hz, const std::vector<double>& power, double cutoff_hz) {
  const double top = frequency_hz.back();
  double total = 0.0;
  for (double p : power) total += p;
  // Lags up to where rho has died out; the spectrum of |x| is flat over the low-pass's band, but is not assumed so.
  const double step = 1.0 / (8.0 * top), longest = 0.5 / cutoff_hz + 0.25;
  const auto lags = static_cast<std::size_t>(longest / step);
  double variance = 0.0;
  // R_h(tau), autocorrelation of the low-pass: integral of |H|^2 cos(2 pi f tau) df over all f.
  const double df = cutoff_hz / 100.0;
  const int bins = 600;
  for (std::size_t k = 0; k <= lags; ++k) {
    const double tau = static_cast<double>(k) * step;
    double rho = 0.0;
    for (std::size_t i = 0; i < power.size(); ++i) rho += power[i] * std::cos(2.0 * std::numbers::pi * frequency_hz[i] * tau);
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

/// One refit's Gauss-Newton steps from x, held and bounded components respected.
bool refit(const CalibrationProblem& problem, const std::vector<bool>& fixed, int steps, VectorXd& x, double& square) {
  Objective objective(problem);
  const VectorXd &lower = objective.lower(), &upper = objective.upper();
  VectorXd u = objective.scaled(x), r;
  MatrixXd J;
  for (int step = 0; step < steps; ++step) {
    if (!objective.evaluate(u, r, &J)) return false;
    if (step == 0) square = r.head(static_cast<Index>(problem.residual_count())).squaredNorm();
    const MatrixXd A = J.transpose() * J;
    const VectorXd g = J.transpose() * r;
    std::vector<bool> held = fixed;
    VectorXd p = VectorXd::Zero(u.size());
    for (Index pass = 0; pass <= u.size(); ++pass) {
      std::vector<Index> free;
      for (Index j = 0; j < u.size(); ++j)
        if (!held[static_cast<std::size_t>(j)]) free.push_back(j);
      if (free.empty()) break;
      const auto k = static_cast<Index>(free.size());
      MatrixXd K(k, k);
      VectorXd b(k);
      for (Index a = 0; a < k; ++a) {
        b[a] = -g[free[static_cast<std::size_t>(a)]] - A.row(free[static_cast<std::size_t>(a)]).dot(p);
        for (Index c = 0; c < k; ++c) {
          K(a, c) = A(free[static_cast<std::size_t>(a)], free[static_cast<std::size_t>(c)]);
          b[a] += K(a, c) * p[free[static_cast<std::size_t>(c)]];
        }
      }
      // Directions the data do not see are not stepped along: pseudo-inverse.
      const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(K);
      VectorXd q = VectorXd::Zero(k);
      for (Index a = 0; a < k; ++a)
        if (eigen.eigenvalues()[a] > 1e-12 * eigen.eigenvalues()[k - 1])
          q += eigen.eigenvectors().col(a) * (eigen.eigenvectors().col(a).dot(b) / eigen.eigenvalues()[a]);
      bool stopped = false;
      for (Index a = 0; a < k; ++a) {
        const Index j = free[static_cast<std::size_t>(a)];
        p[j] = std::clamp(q[a], lower[j] - u[j], upper[j] - u[j]);
        if (p[j] == q[a]) continue;
        held[static_cast<std::size_t>(j)] = true;
        stopped = true;
      }
      if (!stopped) break;
    }
    u += p;
  }
  x = objective.unscaled(u);
  return x.allFinite();
}

}  // namespace

double envelope_coefficient_of_variation(const std::vector<double>& frequency_hz, const std::vector<double>& power,
                                         double cutoff_hz) {
  if (frequency_hz.size() < 2 || frequency_hz.size() != power.size() || !(cutoff_hz > 0.0))
    throw data::InputError("wrong-size", "a spectrum needs as many powers as frequencies, two at least, and a cut-off above 0");
  return std::sqrt(std::max(envelope_variance(frequency_hz, power, cutoff_hz), 0.0));
}

double envelope_coefficient_of_variation(double lower_edge_hz, double upper_edge_hz, double cutoff_hz) {
  if (!(lower_edge_hz >= 0.0) || !(upper_edge_hz > lower_edge_hz) || !(cutoff_hz > 0.0))
    throw data::InputError("out-of-range", fmt::format("band {} to {} Hz with cut-off {} Hz is not possible", lower_edge_hz,
                                                       upper_edge_hz, cutoff_hz));
  std::vector<double> frequency, power;
  const int bins = 400;
  for (int b = 0; b < bins; ++b) {
    frequency.push_back(lower_edge_hz + (b + 0.5) * (upper_edge_hz - lower_edge_hz) / bins);
    power.push_back(1.0);
  }
  return envelope_coefficient_of_variation(frequency, power, cutoff_hz);
}

std::vector<double> envelope_noise(std::size_t count, double rate_hz, double cutoff_hz, std::uint64_t seed,
                                   std::uint64_t stream) {
  if (!(rate_hz > 0.0) || !(cutoff_hz > 0.0) || !(cutoff_hz < 0.4 * rate_hz))
    throw data::InputError("cutoff-above-nyquist",
                           fmt::format("noise with cut-off {} Hz cannot be simulated on excitations at {} Hz", cutoff_hz, rate_hz));
  // White noise through the low-pass itself, forward and backward, with room at both ends for its transients.
  const LowPass pass(cutoff_hz / std::pow(std::sqrt(2.0) - 1.0, 0.25), rate_hz);
  const auto margin = static_cast<std::size_t>(std::ceil(4.0 * rate_hz / cutoff_hz));
  emg::Random random(seed, stream);
  std::vector<double> x(count + 2 * margin), impulse(2 * margin + 1, 0.0);
  for (double& value : x) value = random.normal();
  impulse[margin] = 1.0;
  double energy = 0.0;
  pass.both_ways(x);
  pass.both_ways(impulse);
  for (double value : impulse) energy += value * value;
  std::vector<double> out(x.begin() + static_cast<std::ptrdiff_t>(margin), x.begin() + static_cast<std::ptrdiff_t>(margin + count));
  for (double& value : out) value /= std::sqrt(energy);
  return out;
}

ExcitationErrorResult simulate_excitation_error(const CalibrationProblem& problem, const VectorXd& x,
                                                const std::vector<bool>& fixed, const ExcitationNoise& noise,
                                                std::size_t threads) {
  const Index n = x.size();
  if (static_cast<Index>(fixed.size()) != n || !(noise.coefficient_of_variation >= 0.0) || noise.replicates < 2 ||
      noise.steps < 1 || !(noise.cutoff_hz > 0.0))
    throw data::InputError("out-of-range",
                           fmt::format("excitation noise: `coefficient_of_variation` {} >= 0, `cutoff_hz` {} > 0, `replicates` "
                                       "{} >= 2 and `steps` {} >= 1 are needed",
                                       noise.coefficient_of_variation, noise.cutoff_hz, noise.replicates, noise.steps));
  const auto replicates = static_cast<std::size_t>(noise.replicates);
  std::vector<VectorXd> refits(replicates);
  std::vector<double> square(replicates, 0.0);
  std::vector<unsigned char> good(replicates, 0);
  const auto& samples = problem.excitations();
  Objective base(problem);
  VectorXd r0;
  if (!base.evaluate(base.scaled(x), r0, nullptr))
    throw data::ConvergenceFailure({"simulation of errors in the excitation", base.failure(), 0, 0.0, 0.0, {}});
  const double square0 = r0.head(static_cast<Index>(problem.residual_count())).squaredNorm();

  data::parallel_for(replicates, threads, [&](std::size_t k) {
    CalibrationProblem::Samples noisy = samples;
    std::uint64_t stream = static_cast<std::uint64_t>(k / 2) << 20;
    for (std::size_t t = 0; t < noisy.size(); ++t) {
      for (auto& channel : noisy[t]) {
        // Antithetic pairs: replicate 2i + 1 has the opposite noise of 2i, so that the bias, which is even in the
        // noise, is not blurred by its odd part.
        const std::vector<double> eta =
            envelope_noise(channel.size(), problem.excitation_rate_hz(t), noise.cutoff_hz, noise.seed, ++stream);
        const double sign = k % 2 == 0 ? noise.coefficient_of_variation : -noise.coefficient_of_variation;
        for (std::size_t i = 0; i < channel.size(); ++i) channel[i] *= 1.0 + sign * eta[i];
      }
    }
    refits[k] = x;
    good[k] = refit(problem.with_excitations(std::move(noisy)), fixed, noise.steps, refits[k], square[k]) ? 1 : 0;
  });

  ExcitationErrorResult out;
  out.bias = VectorXd::Zero(n);
  out.covariance = MatrixXd::Zero(n, n);
  out.bias_standard_error = VectorXd::Zero(n);
  std::vector<std::size_t> used;
  for (std::size_t k = 0; k < replicates; ++k) {
    if (good[k]) used.push_back(k);
    else ++out.failed;
  }
  out.replicates = used.size();
  if (used.size() < 2)
    throw data::ConvergenceFailure({"simulation of errors in the excitation", "fewer than two refits have a value",
                                    noise.replicates, 0.0, 0.0, {}});
  const double count = static_cast<double>(used.size());
  for (std::size_t k : used) {
    out.bias += (refits[k] - x) / count;
    out.explained_variance += (square[k] - square0) / count / static_cast<double>(problem.residual_count());
  }
  for (std::size_t k : used) {
    const VectorXd d = refits[k] - x - out.bias;
    out.covariance += d * d.transpose() / (count - 1.0);
  }
  // Monte Carlo error of the mean over antithetic pairs.
  VectorXd pair_square = VectorXd::Zero(n);
  double pairs = 0.0;
  for (std::size_t k = 0; k + 1 < replicates; k += 2) {
    if (!good[k] || !good[k + 1]) continue;
    const VectorXd d = 0.5 * (refits[k] + refits[k + 1]) - x - out.bias;
    pair_square += d.cwiseAbs2();
    pairs += 1.0;
  }
  if (pairs > 1.0) out.bias_standard_error = (pair_square / (pairs * (pairs - 1.0))).cwiseSqrt();
  return out;
}

}  // namespace brachium::optimise
