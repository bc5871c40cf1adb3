#pragma once
/// Where a guided motion is at an amplitude.

#include <string>

#include "fem/solve/problem.hpp"

namespace brachium::fem {

struct GuidedPlace {
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  double angle_rad = 0.0;
};

GuidedPlace guided_place(const GuidedMotion& motion, double amplitude);

/// What is wrong with the lists, in words; empty when sound.
std::string guided_motion_fault(const GuidedMotion& motion);

}  // namespace brachium::fem
