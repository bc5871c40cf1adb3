#pragma once
/// The shipped synthetic elbow and sessions made from it.

#include <stdexcept>

#include "data/io/scene_file.hpp"
#include "optimise/calibration.hpp"
#include "optimise/twin.hpp"
#include "tests/support/paths.hpp"

namespace brachium::optimise::tests {

inline data::Scene elbow() {
  return io::read_scene(brachium::tests::source_dir() / "pipelines/scenes/elbow_twin.toml");
}

inline TwinTrial plan(const std::string& name, Programme programme, double duration, double effort = 0.7) {
  TwinTrial t;
  t.name = name;
  t.programme = programme;
  t.duration_s = duration;
  t.effort = effort;
  t.lower_rad = programme == Programme::isometric_ramp || programme == Programme::isometric_hold ? 1.2 : 0.35;
  t.upper_rad = programme == Programme::isometric_ramp || programme == Programme::isometric_hold ? 1.2 : 2.1;
  return t;
}

/// Signals only, no raw EMG, no noise: two random trials and a ramp.
inline TwinOptions exact_options(double duration = 8.0) {
  TwinOptions options;
  options.raw_emg = false;
  options.trials = {plan("random-1", Programme::random, duration),
                    plan("random-2", Programme::random, duration),
                    plan("ramp", Programme::isometric_ramp, duration)};
  return options;
}

inline std::vector<CalibrationTrial> exact_trials(const TwinOptions& options = exact_options()) {
  return noise_free_trials(make_twin(elbow(), options), "elbow_flexion");
}

inline FreeQuantity free(Quantity quantity, Scope scope = Scope::each) {
  FreeQuantity f;
  f.quantity = quantity;
  f.scope = scope;
  return f;
}

inline const data::ParameterVerdict& verdict(const data::Subject& subject, const std::string& owner,
                                             const std::string& parameter) {
  for (const auto& v : subject.verdicts)
    if (v.muscle == owner && v.parameter == parameter) return v;
  throw std::out_of_range(owner + " " + parameter);
}

/// The scene with every value that a calibration may free moved away from the truth, inside the default
/// bounds.
inline data::Scene disturbed(data::Scene scene) {
  double sign = 1.0;
  for (data::SceneMuscle& m : scene.muscles) {
    sign = -sign;
    m.parameters.strength *= 1.0 + 0.2 * sign;
    m.parameters.tendon_slack_length_m *= 1.0 + 0.03 * sign;
    m.parameters.optimal_fibre_length_m *= 1.0 - 0.05 * sign;
    m.activation.delay_s = 0.055;
    m.activation.time_constant_1_s = 0.010;
    m.activation.time_constant_2_s = 0.045;
    m.activation.shape = -0.9;
  }
  return scene;
}

}  // namespace brachium::optimise::tests
