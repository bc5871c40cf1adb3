#include "fem/solve/programme.hpp"

namespace brachium::fem {

SolveState Programme::start(int dof_count) const {
  SolveState state;
  const auto regions = static_cast<Eigen::Index>(problem_->mesh->regions.size());
  state.configuration.dofs = Eigen::VectorXd::Zero(dof_count);
  state.configuration.activation = Eigen::VectorXd::Zero(regions);
  for (const BoundaryCondition& c : problem_->conditions) state.amplitude[c.name] = 0.0;
  state.phase_amplitude = state.amplitude;
  state.phase_activation = state.configuration.activation;
  return state;
}

LoadPoint Programme::at(const SolveState& state, double time) const {
  const Phase& phase = problem_->programme[static_cast<std::size_t>(state.phase)];
  LoadPoint point;
  const auto conditions = static_cast<Eigen::Index>(problem_->conditions.size());
  point.amplitude.resize(conditions);
  for (Eigen::Index c = 0; c < conditions; ++c) {
    const std::string& name = problem_->conditions[static_cast<std::size_t>(c)].name;
    const auto begin = state.phase_amplitude.find(name);
    const double from = begin == state.phase_amplitude.end() ? 0.0 : begin->second;
    const auto end = phase.amplitude.find(name);
    const double to = end == phase.amplitude.end() ? from : end->second;
    point.amplitude[c] = time >= 1.0 ? to : from + (to - from) * time;
  }
  point.activation = state.phase_activation;
  for (Eigen::Index r = 0; r < point.activation.size(); ++r) {
    const auto end = phase.activation.find(problem_->mesh->regions[static_cast<std::size_t>(r)]);
    if (end == phase.activation.end()) continue;
    const double from = state.phase_activation[r];
    point.activation[r] = time >= 1.0 ? end->second : from + (end->second - from) * time;
  }
  point.released = state.released_force.size() > 0 ? 1.0 - time : 0.0;
  return point;
}

void Programme::advance(SolveState& state, double time) const {
  const LoadPoint point = at(state, time);
  for (std::size_t c = 0; c < problem_->conditions.size(); ++c) {
    state.amplitude[problem_->conditions[c].name] = point.amplitude[static_cast<Eigen::Index>(c)];
  }
  state.configuration.activation = point.activation;
  state.phase_time = time;
}

void Programme::next_phase(SolveState& state) const {
  ++state.phase;
  state.phase_time = 0.0;
  state.phase_amplitude = state.amplitude;
  state.phase_activation = state.configuration.activation;
  state.released_force.resize(0);
  state.step_size = 0.0;
  state.dofs_before.resize(0);
  state.step_before = 0.0;
}

}  // namespace brachium::fem
