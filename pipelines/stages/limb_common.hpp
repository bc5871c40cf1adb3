#pragma once
/// Stages over the rigid limb: motion, and the reference moment.

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "data/model/error.hpp"
#include "data/model/resample.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void add_limb_kinematics(Catalogue& catalogue);
void add_limb_inverse_dynamics(Catalogue& catalogue);
void add_limb_dynamometer(Catalogue& catalogue);

/// The recorded angle of a coordinate: the signal that the scene names, else the trial's only joint angle of it.
data::Signal recorded_angle(const StageData& input, const std::string& trial,
                            const data::Coordinate& coordinate);

/// Values on an even grid as a signal of a coordinate.
data::Signal make_signal(const data::TimeGrid& grid, const std::string& name, data::Quantity quantity,
                         const std::string& unit, const std::string& coordinate,
                         const Eigen::VectorXd& values);

/// Runs `task`; what it finds wrong is told with the trial in front.
template <class Task>
auto in_trial(const std::string& trial, const Task& task) {
  try {
    return task();
  } catch (const data::InputError& error) {
    std::vector<data::Diagnostic> named = error.diagnostics();
    for (data::Diagnostic& finding : named) finding.message = "trial `" + trial + "`: " + finding.message;
    throw data::InputError(std::move(named));
  }
}

}  // namespace brachium::pipelines
