#pragma once
/// The generic arm on a mesh coarse enough for tests, and what they read of its muscles.

#include <numbers>

#include "fem/limb/upper_limb.hpp"

namespace brachium::fem {

constexpr double degree = std::numbers::pi / 180.0;

inline UpperLimb coarse_arm() {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  return generic_arm(coarse);
}

inline MuscleStates states_of(const UpperLimb& arm, const MuscleBody& body, double tolerance_m = 0.0) {
  SolvedMuscleOptions options;
  options.slopes = false;
  options.contact_tolerance_m = tolerance_m;
  return {body, arm.range, arm.hinge, arm.humerus, options};
}

inline double contact_force(const SolvedMuscle& s) {
  double sum = 0.0;
  for (const BoneContact& c : s.contacts) sum += c.force_n;
  return sum;
}

}  // namespace brachium::fem
