#pragma once
/// One seed of the stochastic twin: EMG as modulated noise with sensor noise, conditioned as recordings are,
/// and what a calibration makes of it. Shared by the test (10 seeds) and the coverage benchmark (100 seeds).

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "emg/conditioning.hpp"
#include "emg/synthetic_emg.hpp"
#include "emg/welch.hpp"
#include "optimise/calibration.hpp"
#include "optimise/excitation_error.hpp"
#include "optimise/twin.hpp"

namespace brachium::optimise::tests {

/// Envelopes of one trial's channels: the known maximum (a maximal contraction without error) divides, the
/// noise floor of rest is taken off in the mean square.
inline std::vector<data::Signal> stochastic_envelopes(const data::Trial& truth,
                                                      const emg::SyntheticEmgOptions& electrode,
                                                      std::uint64_t seed, std::uint64_t trial,
                                                      double rate_hz) {
  emg::ConditioningOptions conditioning;
  conditioning.output_rate_hz = rate_hz;
  conditioning.trim_edges = true;
  const emg::ConditioningChain chain = emg::design_conditioning(conditioning, electrode.rate_hz);
  const auto envelope = [&](std::vector<double> raw, emg::OutputLayout& layout) {
    const std::vector<std::span<double>> spans = {raw};
    const std::vector<std::string> names = {"emg"};
    layout = emg::condition(chain, spans, names, truth.name);
    raw.resize(layout.count);
    return raw;
  };
  const auto mean = [](const std::vector<double>& x) {
    double sum = 0.0;
    for (double v : x) sum += v / static_cast<double>(x.size());
    return sum;
  };
  // One long record of the electrode at full effort and one at rest: the unit, and the floor, without error.
  static const std::pair<double, double> levels = [&] {
    emg::SyntheticEmgOptions clean = electrode;
    clean.snr_db.reset();
    clean.seed = 987;
    emg::OutputLayout layout;
    const double at_one =
        mean(envelope(emg::synthesise_emg(std::vector<double>(60000, 1.0), 200.0, clean).raw, layout));
    emg::SyntheticEmgOptions rest = electrode;
    rest.seed = 987;
    return std::pair{
        at_one,
        mean(envelope(emg::synthesise_emg(std::vector<double>(60000, 0.0), 200.0, rest).raw, layout)) /
            at_one};
  }();
  const auto [unit, floor] = levels;
  std::vector<data::Signal> out;
  for (const data::Signal& signal : truth.signals) {
    if (signal.info.quantity != data::Quantity::excitation) continue;
    emg::SyntheticEmgOptions own = electrode;
    own.seed = seed;
    own.stream = (trial << 16) + out.size();
    emg::OutputLayout layout;
    data::Signal s = signal;
    s.samples = envelope(emg::synthesise_emg(signal.samples, signal.info.rate_hz, own).raw, layout);
    for (double& v : s.samples) v /= unit;
    s.samples = without_noise_floor(std::move(s.samples), floor);
    s.info.rate_hz = rate_hz;
    s.info.start_time_s = signal.info.start_time_s + layout.start_shift_s;
    s.info.count = s.samples.size();
    out.push_back(std::move(s));
  }
  return out;
}

/// The law of these envelopes' noise, as a user gets it: from the spectrum of a maximal contraction (here five
/// minutes of it) and white sensor noise, both after the 30 Hz high-pass.
inline ExcitationNoise stochastic_noise(const emg::SyntheticEmgOptions& electrode) {
  emg::SyntheticEmgOptions clean = electrode;
  clean.snr_db.reset();
  clean.seed = 988;
  const emg::Periodogram spectrum =
      emg::welch(emg::synthesise_emg(std::vector<double>(60000, 1.0), 200.0, clean).raw, clean.rate_hz, 0.5);
  std::vector<double> f, emg_power, noise_power;
  double emg_before = 0.0, emg_after = 0.0, noise_before = 0.0, noise_after = 0.0;
  for (std::size_t i = 1; i < spectrum.density.size(); ++i) {
    const double x = static_cast<double>(i) * spectrum.resolution_hz,
                 r = 30.0 / x * std::pow(std::sqrt(2.0) - 1.0, 0.25),
                 high_pass = std::pow(1.0 + std::pow(r, 4), -2);
    f.push_back(x);
    emg_power.push_back(spectrum.density[i] * high_pass);
    noise_power.push_back(high_pass);
    emg_before += spectrum.density[i];
    emg_after += spectrum.density[i] * high_pass;
    noise_before += 1.0;
    noise_after += high_pass;
  }
  ExcitationNoise noise;
  noise.coefficient_of_variation = envelope_coefficient_of_variation(f, emg_power, 6.0);
  const double floor = std::pow(10.0, -*electrode.snr_db / 20.0) *
                       std::sqrt(noise_after / noise_before * emg_before / emg_after);
  noise.subtracted_floor = floor;
  noise.overlapping_floor = overlapping_noise_floor(floor, emg_power, noise_power);
  noise.rest_coefficient_of_variation = envelope_coefficient_of_variation(f, noise_power, 6.0);
  noise.cutoff_hz = 6.0;
  return noise;
}

struct StochasticOutcome {
  CalibrationResult result;
  Eigen::VectorXd truth;
};

inline FreeQuantity free_quantity(Quantity quantity, Scope scope) {
  FreeQuantity f;
  f.quantity = quantity;
  f.scope = scope;
  return f;
}

struct StochasticStudy {
  std::vector<FreeQuantity> free = {free_quantity(Quantity::strength, Scope::group),
                                    free_quantity(Quantity::tendon_slack_length, Scope::group),
                                    free_quantity(Quantity::delay, Scope::global),
                                    free_quantity(Quantity::shape, Scope::global)};
  ModelChoice model;
  double duration_s = 15.0;  ///< of each trial
  int replicates = 20;
};

/// Three random trials and ramps, known maximum, 20 dB, 0.3 N m of noise in the reference.
inline StochasticOutcome stochastic_seed(const data::Scene& scene, std::uint64_t seed,
                                         const StochasticStudy& study) {
  TwinOptions options;
  options.seed = seed;
  options.raw_emg = false;
  options.moment_noise_sd_N_m = 0.3;
  options.model = study.model;
  for (const auto& [name, programme, angle] :
       {std::tuple{"random-1", Programme::random, 0.0}, std::tuple{"random-2", Programme::random, 0.0},
        std::tuple{"random-3", Programme::random, 0.0}, std::tuple{"ramp", Programme::isometric_ramp, 1.2}}) {
    TwinTrial t;
    t.name = name;
    t.programme = programme;
    t.duration_s = study.duration_s;
    t.lower_rad = angle > 0.0 ? angle : 0.35;
    t.upper_rad = angle > 0.0 ? angle : 2.1;
    t.effort = 0.7;
    options.trials.push_back(t);
  }
  options.motion_rate_hz = options.excitation_rate_hz = 100.0;
  emg::SyntheticEmgOptions electrode;
  electrode.snr_db = 20.0;
  const Twin twin = make_twin(scene, options);
  std::vector<CalibrationTrial> trials = noise_free_trials(twin, scene.coordinates[0].name);
  for (std::size_t t = 0; t < trials.size(); ++t)
    trials[t].excitations = stochastic_envelopes(twin.truth.trials[t], electrode, seed, t + 1, 100.0);

  CalibrationOptions calibration;
  calibration.problem.free = study.free;
  calibration.problem.model = study.model;
  calibration.problem.edge_s = 0.25;
  calibration.problem.decimate = 2;
  calibration.excitation_noise = stochastic_noise(electrode);
  calibration.excitation_noise.replicates = study.replicates;
  StochasticOutcome out;
  out.result = calibrate(scene, trials, calibration);
  out.truth = start_of(out.result.parameters);  // the scene is the truth
  return out;
}

}  // namespace brachium::optimise::tests
