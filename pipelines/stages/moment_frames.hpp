#pragma once
/// Activations and joint angle on common frames: what stages that turn both into moments begin with.

#include <optional>
#include <string>
#include <vector>

#include "data/model/resample.hpp"
#include "data/model/scene.hpp"
#include "data/model/session.hpp"

namespace brachium::pipelines {

/// The activations' own grid, where the angle and another signal are known too.
struct CommonFrames {
  data::TimeGrid time;
  std::size_t first = 0;  ///< activation sample that frame 0 is

  /// Frames [from, from + count).
  CommonFrames piece(std::size_t from, std::size_t count) const;
};

/// Throws InputError("no-common-window") naming the trial where fewer than 9 frames are common.
CommonFrames common_frames(const data::SignalInfo& activation, const data::Signal& angle,
                           const std::optional<data::Signal>& other, const std::string& trial);

/// Kinematics on such frames.
struct MomentFrames : CommonFrames {
  std::vector<double> angle_rad, velocity_rad_s;  ///< velocity empty where none is given
};

/// Throws InputError("angle-out-of-range") naming trial and time of the first angle outside the coordinate's range.
void check_angles(const MomentFrames& frames, const data::Coordinate& coordinate, const std::string& trial);

MomentFrames kinematics_at(const CommonFrames& frames, const data::Signal& angle,
                           const std::optional<data::Signal>& velocity);

/// Name of the part of a modelled joint moment that passive tissue exerts. It carries no coordinate, so that
/// the moment of the coordinate stays the only one.
inline std::string passive_moment_name(const std::string& coordinate) {
  return coordinate + "_moment_passive";
}

/// The header of a signal on a grid.
data::SignalInfo signal_on(const data::TimeGrid& grid, const std::string& name, data::Quantity quantity,
                           const std::string& unit);

/// Samples of a trial's activation at the frames, brought into [0, 1] (those below 0 are ringing of filters);
/// `brought` is raised by their number. Throws InputError("activation-range") for one above 1 where `clamp` is off.
std::vector<double> activation_at(const CommonFrames& frames, const data::SessionSource& source,
                                  std::size_t trial, std::size_t signal, bool clamp, std::size_t& brought);

}  // namespace brachium::pipelines
