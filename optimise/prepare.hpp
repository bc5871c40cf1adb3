#pragma once
/// Checks and preparations of a calibration's trials. Internal to optimise/.

#include <memory>
#include <vector>

#include "optimise/chain.hpp"

namespace brachium::optimise {

/// Reference samples at which all signals of a trial exist, and those inside the edges that are compared.
struct UsableSpan {
  std::size_t first_frame = 0, last_frame = 0;  ///< of the reference, both included
  std::size_t first_row = 0, last_row = 0;
};
/// Throws InputError("empty-window") naming the trial.
UsableSpan usable_span(const CalibrationTrial& trial, double edge_s);

/// Throws InputError with every mistake of one trial. Fills all but weight and first_row.
std::shared_ptr<PreparedTrial> prepare_trial(const CalibrationTrial& trial, const Chain& chain,
                                             const std::vector<limb::MusclePath>& paths);

/// A trial's angle [rad] and velocity [rad/s] at some instants; the velocity from the angle's spline where
/// none is given.
void motion_at(const CalibrationTrial& trial, std::span<const double> times_s, std::vector<double>& angle,
               std::vector<double>& velocity);

/// Samples of the trial's channels in a given order; throws InputError("unmapped-channel") for one that is
/// absent.
std::vector<std::vector<double>> channel_samples(const CalibrationTrial& trial,
                                                 const std::vector<std::string>& channels);

}  // namespace brachium::optimise
