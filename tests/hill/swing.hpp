#pragma once
/// A smooth swing of one pennate muscle: lengths, their exact rates, moment arms and activations.

#include <cmath>
#include <vector>

#include "data/model/muscle.hpp"

namespace brachium::tests {

/// The lateral head of arm26, with a strength of its own.
inline data::MuscleParameters triceps() {
  data::MuscleParameters p;
  p.max_isometric_force_N = 624.3;
  p.optimal_fibre_length_m = 0.1138;
  p.tendon_slack_length_m = 0.098;
  p.pennation_at_optimal_rad = 0.15708;
  p.strength = 1.2;
  return p;
}

struct Swing {
  double rate_hz;
  std::vector<double> length, velocity, arm, activation;

  Swing(double rate, std::size_t frames) : rate_hz(rate) {
    for (std::size_t k = 0; k < frames; ++k) {
      const double t = static_cast<double>(k) / rate, w = 5.0;
      length.push_back(0.2157 + 0.013 * std::sin(w * t + 0.3));
      velocity.push_back(0.013 * w * std::cos(w * t + 0.3));
      arm.push_back(-0.021 + 0.002 * std::cos(w * t));
      activation.push_back(0.45 + 0.3 * std::sin(1.3 * w * t + 1.0) + 0.05 * std::cos(3.1 * w * t));
    }
  }
};

}  // namespace brachium::tests
