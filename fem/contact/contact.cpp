#include "fem/contact/contact.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "fem/solve/problem.hpp"

namespace brachium::fem {

Contacts::Contacts(const Problem& problem, const Discretisation& discretisation, double stiffness_pa,
                   double cell_size_m)
    : problem_(&problem) {
  for (const Contact& contact : problem.contacts) {
    int moving = -1;
    if (!contact.moves_with.empty()) {
      std::vector<std::string> motions;
      for (std::size_t i = 0; i < problem.conditions.size(); ++i) {
        if (!std::holds_alternative<RigidMotion>(problem.conditions[i].kind)) continue;
        motions.push_back(problem.conditions[i].name);
        if (problem.conditions[i].name == contact.moves_with) moving = static_cast<int>(i);
      }
      if (moving < 0) {
        throw data::InputError(
            "unknown-condition",
            fmt::format("contact `{}` moves with `{}`, which is no rigid motion of the problem", contact.name,
                        contact.moves_with),
            data::suggest(contact.moves_with, motions));
      }
    }
    const double penalty =
        contact.penalty_pa_per_m > 0.0 ? contact.penalty_pa_per_m : 10.0 * stiffness_pa / cell_size_m;
    ContactSurface surface(discretisation, contact.surface, contact.body,
                           {penalty, contact.smoothing_m, contact.points_per_direction});
    const int first = points_;
    points_ += surface.point_count();
    contacts_.push_back({std::move(surface), moving, contact.penetration_tolerance_m, penalty, first});
  }
}

Pose Contacts::pose(const Entry& entry, const Eigen::VectorXd& amplitude) const {
  Pose pose;
  if (entry.moving_condition < 0) return pose;
  const auto& motion =
      std::get<RigidMotion>(problem_->conditions[static_cast<std::size_t>(entry.moving_condition)].kind);
  const double now = amplitude[entry.moving_condition];
  pose.rotation = Eigen::AngleAxisd(now * motion.angle_rad, motion.axis.normalized()).toRotationMatrix();
  pose.translation_m = motion.centre_m - pose.rotation * motion.centre_m + now * motion.translation_m;
  return pose;
}

Eigen::VectorXd Contacts::part(const Entry& entry, const Eigen::VectorXd& multiplier_pa) const {
  if (multiplier_pa.size() == 0) return {};
  return multiplier_pa.segment(entry.first_point, entry.surface.point_count());
}

void Contacts::add_force(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                         const Eigen::VectorXd& multiplier_pa, Eigen::VectorXd& force) const {
  for (const Entry& entry : contacts_)
    entry.surface.add_force(dofs, pose(entry, amplitude), part(entry, multiplier_pa), force);
}

void Contacts::append_tangents(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                               const Eigen::VectorXd& multiplier_pa,
                               std::vector<FaceTangent>& tangents) const {
  for (const Entry& entry : contacts_) {
    std::vector<FaceTangent> own =
        entry.surface.tangent(dofs, pose(entry, amplitude), part(entry, multiplier_pa));
    std::move(own.begin(), own.end(), std::back_inserter(tangents));
  }
}

Eigen::VectorXd Contacts::pressures(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                                    const Eigen::VectorXd& multiplier_pa) const {
  Eigen::VectorXd all(points_);
  for (const Entry& entry : contacts_) {
    all.segment(entry.first_point, entry.surface.point_count()) =
        entry.surface.points(dofs, pose(entry, amplitude), part(entry, multiplier_pa)).pressure_pa;
  }
  return all;
}

double Contacts::penetration_ratio(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                                   const Eigen::VectorXd& multiplier_pa) const {
  double worst = 0.0;
  for (const Entry& entry : contacts_) {
    if (!(entry.tolerance_m > 0.0)) continue;
    const ContactPoints points =
        entry.surface.points(dofs, pose(entry, amplitude), part(entry, multiplier_pa));
    // Complementarity: neither deeper than the tolerance, nor pressed from farther away than it.
    for (Eigen::Index i = 0; i < points.gap_m.size(); ++i) {
      const double error = points.pressure_pa[i] > 0.0 ? std::abs(points.gap_m[i]) : -points.gap_m[i];
      worst = std::max(worst, error / entry.tolerance_m);
    }
  }
  return worst;
}

std::vector<ContactSums> Contacts::sums(const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                                        const Eigen::VectorXd& multiplier_pa) const {
  std::vector<ContactSums> all;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(dofs.size());
  for (const Entry& entry : contacts_)
    all.push_back(entry.surface.add_force(dofs, pose(entry, amplitude), part(entry, multiplier_pa), force));
  return all;
}

ContactPoints Contacts::points(int contact, const Eigen::VectorXd& amplitude, const Eigen::VectorXd& dofs,
                               const Eigen::VectorXd& multiplier_pa) const {
  const Entry& entry = contacts_.at(static_cast<std::size_t>(contact));
  return entry.surface.points(dofs, pose(entry, amplitude), part(entry, multiplier_pa));
}

}  // namespace brachium::fem
