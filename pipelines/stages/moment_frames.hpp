#pragma once
/// Activations and joint angle on common frames: what stages that turn both into moments begin with.

#include <optional>
#include <string>
#include <vector>

#include "data/model/resample.hpp"
#include "data/model/signal.hpp"

namespace brachium::pipelines {

/// Kinematics on the activations' own grid, where both are known.
struct MomentFrames {
  data::TimeGrid time;
  std::vector<double> angle_rad, velocity_rad_s;  ///< velocity empty where none is given
  std::size_t first = 0;                          ///< activation sample that frame 0 is
};

/// Throws InputError("no-common-window") naming the trial where fewer than 9 frames are common.
MomentFrames moment_frames(const data::SignalInfo& activation, const data::Signal& angle,
                           const std::optional<data::Signal>& velocity, const std::string& trial);

/// Name of the part of a modelled joint moment that passive tissue exerts. It carries no coordinate, so that
/// the moment of the coordinate stays the only one.
inline std::string passive_moment_name(const std::string& coordinate) {
  return coordinate + "_moment_passive";
}

/// The header of a signal on a grid.
data::SignalInfo signal_on(const data::TimeGrid& grid, const std::string& name, data::Quantity quantity,
                           const std::string& unit);

/// Samples of an activation at the frames, brought into [0, 1] (those below 0 are ringing of filters);
/// `brought` counts them. Throws InputError("activation-range") for one above 1 where `clamp` is off.
std::vector<double> activation_at(const MomentFrames& frames, const data::Signal& activation, bool clamp,
                                  const std::string& trial, std::size_t& brought);

}  // namespace brachium::pipelines
