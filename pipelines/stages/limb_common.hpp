#pragma once
/// Stages over the rigid limb: motion, and the reference moment.

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void add_limb_kinematics(Catalogue& catalogue);
void add_limb_inverse_dynamics(Catalogue& catalogue);
void add_limb_dynamometer(Catalogue& catalogue);

/// The recorded angle of a coordinate: the signal that the scene names, else the trial's only joint angle of it.
data::Signal recorded_angle(const StageData& input, const std::string& trial, const data::Coordinate& coordinate);

}  // namespace brachium::pipelines
