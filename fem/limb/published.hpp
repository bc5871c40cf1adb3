#pragma once
/// Published lever arms and forces of the Upper Limb Model (Valentin 2019, doi:10.18419/opus-10504, ch. 7),
/// both as positive numbers.

#include <vector>

namespace brachium::fem {

/// [m], q in 10 ... 150 deg.
double published_biceps_lever_arm_m(double q_rad);
double published_triceps_lever_arm_m(double q_rad);

/// Forces at seven angles, passive and fully active.
struct PublishedForce {
  double q_rad = 0.0, activation = 0.0, triceps_n = 0.0, biceps_n = 0.0;
};
const std::vector<PublishedForce>& published_forces();

}  // namespace brachium::fem
