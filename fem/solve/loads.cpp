#include "fem/solve/loads.hpp"

#include <algorithm>

#include "fem/solve/holds.hpp"

namespace brachium::fem {

Loads::Loads(const Problem& problem, const Discretisation& discretisation, double stiffness_pa,
             double cell_size_m)
    : dof_count_(discretisation.dof_count()), contacts_(problem, discretisation, stiffness_pa, cell_size_m) {
  for (std::size_t i = 0; i < problem.conditions.size(); ++i) {
    const BoundaryCondition& condition = problem.conditions[i];
    const int index = static_cast<int>(i);
    if (const auto* traction = std::get_if<DeadTraction>(&condition.kind)) {
      check_has_faces(discretisation.mesh(), condition.surface);
      const LoadedSurface surface(discretisation, condition.surface);
      const double share = traction->is_total_force ? 1.0 / surface.reference_area() : 1.0;
      Dead dead{index, Eigen::VectorXd::Zero(dof_count_)};
      surface.add_traction(share * traction->traction_pa, dead.force);
      dead_.push_back(std::move(dead));
    } else if (const auto* body = std::get_if<BodyForce>(&condition.kind)) {
      Dead dead{index, Eigen::VectorXd::Zero(dof_count_)};
      add_body_force(discretisation, body->force_n_m3, 1.0, dead.force);
      dead_.push_back(std::move(dead));
    } else if (const auto* pressure = std::get_if<FollowerPressure>(&condition.kind)) {
      check_has_faces(discretisation.mesh(), condition.surface);
      pressures_.push_back({index, pressure->pressure_pa, LoadedSurface(discretisation, condition.surface)});
    }
  }
}

Eigen::VectorXd Loads::force(const Eigen::VectorXd& amplitude, const Configuration& configuration) const {
  Eigen::VectorXd f = Eigen::VectorXd::Zero(dof_count_);
  for (const Dead& dead : dead_) f += amplitude[dead.condition] * dead.force;
  for (const Pressure& p : pressures_) {
    const double now = amplitude[p.condition] * p.pressure_pa;
    if (now != 0.0) p.surface.add_pressure(now, configuration.dofs, f);
  }
  contacts_.add_force(amplitude, configuration.dofs, configuration.contact_multiplier, f);
  return f;
}

bool Loads::has_pressure() const {
  return !pressures_.empty();
}

std::vector<FaceTangent> Loads::tangent(const Eigen::VectorXd& amplitude,
                                        const Configuration& configuration) const {
  std::vector<FaceTangent> all;
  for (const Pressure& p : pressures_) {
    const double now = amplitude[p.condition] * p.pressure_pa;
    if (now == 0.0) continue;
    std::vector<FaceTangent> tangents = p.surface.pressure_tangent(now, configuration.dofs);
    std::move(tangents.begin(), tangents.end(), std::back_inserter(all));
  }
  contacts_.append_tangents(amplitude, configuration.dofs, configuration.contact_multiplier, all);
  return all;
}

}  // namespace brachium::fem
