#include "optimise/excitation_error.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
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

/// One pass of a second-order Butterworth low-pass, bilinear with prewarped edge.
struct LowPass {
  double b0, a1, a2;

  LowPass(double edge_hz, double rate_hz) {
    const double w = std::tan(std::numbers::pi * std::min(edge_hz / rate_hz, 0.49)),
                 norm = 1.0 + std::numbers::sqrt2 * w + w * w;
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

constexpr double kLeastReliability = 0.15;

/// White noise of a given standard deviation, sample by sample, through the low-pass, forward and backward:
/// how an envelope's noise comes about. Ends are continued far enough for the filter's transients; unit
/// deviation gives unit variance.
std::vector<double> filtered_noise(const std::vector<double>& deviation, double rate_hz, double cutoff_hz,
                                   std::uint64_t seed, std::uint64_t stream) {
  const LowPass pass(cutoff_hz / std::pow(std::sqrt(2.0) - 1.0, 0.25), rate_hz);
  const auto margin = static_cast<std::size_t>(std::ceil(4.0 * rate_hz / cutoff_hz));
  const std::size_t count = deviation.size();
  emg::Random random(seed, stream);
  std::vector<double> x(count + 2 * margin), impulse(2 * margin + 1, 0.0);
  for (std::size_t i = 0; i < x.size(); ++i)
    x[i] = random.normal() * deviation[i < margin ? 0 : std::min(i - margin, count - 1)];
  impulse[margin] = 1.0;
  double energy = 0.0;
  pass.both_ways(x);
  pass.both_ways(impulse);
  for (double value : impulse) energy += value * value;
  std::vector<double> out(x.begin() + static_cast<std::ptrdiff_t>(margin),
                          x.begin() + static_cast<std::ptrdiff_t>(margin + count));
  for (double& value : out) value /= std::sqrt(energy);
  return out;
}

/// Excitations with one more dose of noise, added where noise comes in: before the sensor noise is taken off.
/// Replicates 2i and 2i + 1 have opposite noise, so that what is odd in it cancels.
CalibrationProblem::Samples noisy_samples(const CalibrationProblem& problem, const ExcitationNoise& noise,
                                          std::size_t replicate) {
  CalibrationProblem::Samples out = problem.excitations();
  std::uint64_t stream = static_cast<std::uint64_t>(replicate / 2) << 20;
  for (std::size_t t = 0; t < out.size(); ++t)
    for (auto& channel : out[t])
      channel = with_envelope_noise(std::move(channel), problem.excitation_rate_hz(t), noise, ++stream,
                                    replicate % 2 == 0 ? 1.0 : -1.0);
  return out;
}

/// Scores and information of one data set at one point, in scaled parameters, without priors.
struct ScoreData {
  bool good = false;
  VectorXd score;        ///< J'r
  MatrixXd information;  ///< J'J
  MatrixXd rows;         ///< J_i r_i, m x n, where wanted
  double square = 0.0;   ///< |r|^2
};

ScoreData score_of(const CalibrationProblem& problem, const VectorXd& u, bool rows) {
  Objective objective(problem);
  ScoreData out;
  VectorXd r;
  MatrixXd J;
  if (!objective.evaluate(u, r, &J)) return out;
  const auto m = static_cast<Index>(problem.residual_count());
  const VectorXd data = r.head(m);
  const MatrixXd Jd = J.topRows(m);
  out.good = true;
  out.score = Jd.transpose() * data;
  out.information = Jd.transpose() * Jd;
  out.square = data.squaredNorm();
  if (rows) out.rows = data.asDiagonal() * Jd;
  return out;
}

/// The corrected score at one point.
struct Corrected {
  VectorXd score;        ///< priors included
  MatrixXd H;            ///< priors included, reliabilities limited from below
  VectorXd noise_score;  ///< what one dose of noise adds to J'r
  MatrixXd rows;         ///< corrected score by row
  MatrixXd monte_carlo;  ///< covariance of the simulated part of the score
  double reliability = 1.0, explained = 0.0;
  bool limited = false;
  std::size_t used = 0, failed = 0;
};

Corrected corrected_score(const CalibrationProblem& problem, const VectorXd& u, const VectorXd& prior_weight,
                          const VectorXd& prior_mean, const ExcitationNoise& noise, std::size_t threads,
                          bool rows) {
  const auto K = static_cast<std::size_t>(noise.replicates);
  const ScoreData base = score_of(problem, u, rows);
  if (!base.good)
    throw data::ConvergenceFailure(
        {"errors in the excitation", "the model has no value at the solution", 0, 0.0, 0.0, {}});
  const Index n = u.size();
  Corrected out;
  VectorXd mean_score = VectorXd::Zero(n);
  MatrixXd mean_information = MatrixXd::Zero(n, n),
           mean_rows = MatrixXd::Zero(base.rows.rows(), rows ? n : 0);
  std::vector<VectorXd> pair_scores;
  double mean_square = 0.0;
  // A few pairs at a time, summed in their order: the same for any number of threads, in bounded memory.
  const std::size_t chunk = 2 * std::max<std::size_t>(1, data::thread_count(threads));
  for (std::size_t first = 0; first < K; first += chunk) {
    const std::size_t count = std::min(chunk, K - first);
    std::vector<ScoreData> parts(count);
    data::parallel_for(count, threads, [&](std::size_t i) {
      parts[i] = score_of(problem.with_excitations(noisy_samples(problem, noise, first + i)), u, rows);
    });
    for (std::size_t i = 0; i + 1 < count; i += 2) {
      if (!parts[i].good || !parts[i + 1].good) {
        out.failed += 2;
        continue;
      }
      for (const ScoreData* part : {&parts[i], &parts[i + 1]}) {
        mean_score += part->score;
        mean_information += part->information;
        if (rows) mean_rows += part->rows;
        mean_square += part->square;
      }
      pair_scores.push_back(0.5 * (parts[i].score + parts[i + 1].score));
      out.used += 2;
    }
  }
  if (out.used < 4)
    throw data::ConvergenceFailure({"errors in the excitation",
                                    "fewer than two pairs of simulated data have a value",
                                    noise.replicates,
                                    0.0,
                                    0.0,
                                    {}});
  const double count = static_cast<double>(out.used), pairs = 0.5 * count;
  mean_score /= count;
  mean_information /= count;
  out.noise_score = mean_score - base.score;
  out.score = 2.0 * base.score - mean_score + prior_weight.cwiseProduct(u - prior_mean);
  out.explained = (mean_square / count - base.square) / static_cast<double>(problem.residual_count());
  if (rows) out.rows = 2.0 * base.rows - mean_rows / count;
  out.monte_carlo = MatrixXd::Zero(n, n);
  for (const VectorXd& s : pair_scores)
    out.monte_carlo += (s - mean_score) * (s - mean_score).transpose() / (pairs * (pairs - 1.0));

  MatrixXd H0 = base.information, H = 2.0 * base.information - mean_information;
  H0.diagonal() += prior_weight;
  H.diagonal() += prior_weight;
  H0.diagonal() += VectorXd::Constant(n, 1e-12 * std::max(H0.diagonal().maxCoeff(), 1e-300));
  const Eigen::LLT<MatrixXd> root(H0);
  const MatrixXd L = root.matrixL();
  const MatrixXd whitened =
      L.triangularView<Eigen::Lower>().solve(L.triangularView<Eigen::Lower>().solve(H).transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(0.5 * (whitened + whitened.transpose()));
  out.reliability = eigen.eigenvalues().minCoeff();
  out.limited = out.reliability < kLeastReliability;
  const VectorXd limited = eigen.eigenvalues().cwiseMax(kLeastReliability);
  out.H = L * eigen.eigenvectors() * limited.asDiagonal() * eigen.eigenvectors().transpose() * L.transpose();
  return out;
}

/// Newton's step on the free parameters; those that reach a bound stop there.
VectorXd newton_step(const MatrixXd& H, const VectorXd& score, const VectorXd& u, const VectorXd& lower,
                     const VectorXd& upper, std::vector<bool> held) {
  VectorXd p = VectorXd::Zero(u.size());
  for (Index pass = 0; pass <= u.size(); ++pass) {
    std::vector<Index> free;
    for (Index j = 0; j < u.size(); ++j)
      if (!held[static_cast<std::size_t>(j)]) free.push_back(j);
    if (free.empty()) break;
    const auto k = static_cast<Index>(free.size());
    MatrixXd A(k, k);
    VectorXd b(k);
    for (Index a = 0; a < k; ++a) {
      const Index ja = free[static_cast<std::size_t>(a)];
      b[a] = -score[ja];
      for (Index j = 0; j < u.size(); ++j)
        if (held[static_cast<std::size_t>(j)]) b[a] -= H(ja, j) * p[j];
      for (Index c = 0; c < k; ++c) A(a, c) = H(ja, free[static_cast<std::size_t>(c)]);
    }
    const VectorXd q = A.ldlt().solve(b);
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
  return p;
}

}  // namespace

std::vector<double> envelope_noise(std::size_t count, double rate_hz, double cutoff_hz, std::uint64_t seed,
                                   std::uint64_t stream) {
  if (!(rate_hz > 0.0) || !(cutoff_hz > 0.0) || !(cutoff_hz < 0.4 * rate_hz))
    throw data::InputError("cutoff-above-nyquist",
                           fmt::format("noise with cut-off {} Hz cannot be simulated on excitations at {} Hz",
                                       cutoff_hz, rate_hz));
  return filtered_noise(std::vector<double>(count, 1.0), rate_hz, cutoff_hz, seed, stream);
}

std::vector<double> with_envelope_noise(std::vector<double> excitation, double rate_hz,
                                        const ExcitationNoise& noise, std::uint64_t stream, double sign) {
  const double c2 = noise.coefficient_of_variation * noise.coefficient_of_variation,
               f2 = noise.overlapping_floor * noise.overlapping_floor, F = noise.subtracted_floor,
               rest = std::pow(noise.rest_coefficient_of_variation * F * F, 2);
  std::vector<double> deviation(excitation.size());
  for (std::size_t i = 0; i < excitation.size(); ++i) {
    const double e2 = excitation[i] * excitation[i], E2 = e2 + F * F;
    if (!(E2 > 0.0)) continue;
    const double relative = (c2 * e2 * (e2 + 2.0 * f2) + rest) / (E2 * E2);
    // E_observed^2 exceeds E^2 by the factor 1 + relative in the mean: the dose is that much smaller.
    deviation[i] = std::sqrt(E2 * relative / (1.0 + relative));
  }
  const std::vector<double> eta = filtered_noise(deviation, rate_hz, noise.cutoff_hz, noise.seed, stream);
  for (std::size_t i = 0; i < excitation.size(); ++i)
    excitation[i] = F > 0.0 ? std::hypot(excitation[i], F) + sign * eta[i] : excitation[i] + sign * eta[i];
  return F > 0.0 ? without_noise_floor(std::move(excitation), F) : excitation;
}

ExcitationErrorResult simulate_excitation_error(const CalibrationProblem& problem, const VectorXd& x,
                                                const std::vector<bool>& fixed, const ExcitationNoise& noise,
                                                std::size_t threads) {
  const Index n = x.size();
  if (static_cast<Index>(fixed.size()) != n || !(noise.coefficient_of_variation >= 0.0) ||
      !(noise.overlapping_floor >= 0.0) || !(noise.subtracted_floor >= 0.0) ||
      !(noise.rest_coefficient_of_variation >= 0.0) || !(noise.coefficient_uncertainty >= 0.0) ||
      noise.replicates < 4 || noise.steps < 1 || !(noise.cutoff_hz > 0.0))
    throw data::InputError(
        "out-of-range",
        fmt::format("excitation noise: `coefficient_of_variation` {} >= "
                    "0, `subtracted_floor` {} >= 0, `overlapping_floor` "
                    "{} >= 0, `rest_coefficient_of_variation` {} >= 0, "
                    "`cutoff_hz` {} > 0, `replicates` {} >= 4 and `steps` "
                    "{} >= 1 are needed",
                    noise.coefficient_of_variation, noise.subtracted_floor, noise.overlapping_floor,
                    noise.rest_coefficient_of_variation, noise.cutoff_hz, noise.replicates, noise.steps));
  const auto& parameters = problem.parameters();
  const VectorXd scale = scale_of(parameters), lower = lower_of(parameters).cwiseQuotient(scale),
                 upper = upper_of(parameters).cwiseQuotient(scale);
  VectorXd prior_weight = VectorXd::Zero(n), prior_mean = VectorXd::Zero(n);
  for (Index j = 0; j < n; ++j) {
    const auto& prior = parameters[static_cast<std::size_t>(j)].prior;
    if (!prior) continue;
    prior_weight[j] = std::pow(scale[j] / prior->standard_deviation, 2);
    prior_mean[j] = prior->mean / scale[j];
  }
  VectorXd u = x.cwiseQuotient(scale);
  ExcitationErrorResult out;
  out.converged = false;
  VectorXd before;
  double relaxation = 1.0;
  for (int step = 0; step < noise.steps && !out.converged; ++step) {
    const Corrected at = corrected_score(problem, u, prior_weight, prior_mean, noise, threads, false);
    std::vector<bool> held = fixed;
    for (Index j = 0; j < n; ++j)  // at a bound, and pushed outward
      if ((u[j] <= lower[j] && at.score[j] > 0.0) || (u[j] >= upper[j] && at.score[j] < 0.0))
        held[static_cast<std::size_t>(j)] = true;
    VectorXd p = newton_step(at.H, at.score, u, lower, upper, held);
    const double largest = p.lpNorm<Eigen::Infinity>();
    // H leaves out how the force curves: steps that turn back on each other are relaxed (Aitken's factor for
    // vectors, Irons & Tuck 1969, doi:10.1002/nme.1620010306).
    if (step > 0) {
      const VectorXd turn = p - before;
      if (turn.squaredNorm() > 0.0)
        relaxation = std::clamp(-relaxation * before.dot(turn) / turn.squaredNorm(), 0.1, 1.0);
    }
    before = p;
    if (largest > 0.5) p *= 0.5 / largest;  // half the bounds' half width at a time
    u = (u + relaxation * p).cwiseMax(lower).cwiseMin(upper);
    out.converged = largest < 5e-3;
  }
  const Corrected at = corrected_score(problem, u, prior_weight, prior_mean, noise, threads, true);
  VectorXd residuals;
  const VectorXd solution =
      u.cwiseProduct(scale).cwiseMax(lower_of(parameters)).cwiseMin(upper_of(parameters));
  problem.evaluator()->evaluate(solution, residuals, nullptr);
  const auto blocks = problem.blocks();
  const ResidualCorrelation correlation = residual_correlation(residuals, blocks);
  const double samples = static_cast<double>(residuals.size()) / correlation.inflation;
  MatrixXd S = long_run_scores(at.rows, blocks, 2 * correlation.first_crossing) *
               (samples / std::max(samples - static_cast<double>(n), 1.0));
  S.diagonal() += prior_weight;
  const MatrixXd inverse = at.H.ldlt().solve(MatrixXd::Identity(n, n));
  const MatrixXd monte_carlo = inverse * at.monte_carlo * inverse.transpose();
  const MatrixXd C = inverse * S * inverse.transpose() + monte_carlo;
  out.x = solution;
  out.bias = x - solution;
  out.covariance = scale.asDiagonal() * C * scale.asDiagonal();
  // dx / d ln c^2 = H^-1 (one dose's share of the score): what a wrong law of the noise does to x.
  const VectorXd by_law =
      2.0 * noise.coefficient_uncertainty * (inverse * at.noise_score).cwiseProduct(scale);
  out.covariance += by_law * by_law.transpose();
  out.bias_standard_error = monte_carlo.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseProduct(scale);
  out.explained_variance = at.explained;
  out.least_reliability = at.reliability;
  out.limited = at.limited;
  out.replicates = at.used;
  out.failed = at.failed;
  return out;
}

}  // namespace brachium::optimise
