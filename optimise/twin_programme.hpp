#pragma once
/// Angle and effort of a trial's programme. Internal to optimise/.

#include <vector>

#include "optimise/twin.hpp"

namespace brachium::optimise {

struct ProgrammeTraces {
  std::vector<double> angle_rad, velocity_rad_s;  ///< at motion_rate_hz
  std::vector<double> flexion, extension;         ///< efforts in [0, 1], at excitation_rate_hz
};

ProgrammeTraces run_programme(const TwinTrial& trial, const TwinOptions& options, std::size_t index);

/// A smooth random course in [0, 1] of sines between two frequencies, sampled at rate_hz.
std::vector<double> smooth_course(std::size_t count, double rate_hz, double lowest_hz, double highest_hz,
                                  std::uint64_t seed, std::uint64_t stream);

}  // namespace brachium::optimise
