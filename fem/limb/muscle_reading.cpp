#include "fem/limb/muscle_reading.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "fem/quantities/point_fields.hpp"
#include "fem/quantities/section.hpp"
#include "fem/quantities/stress_wrench.hpp"
#include "fem/solve/guided_motion.hpp"

namespace brachium::fem {
namespace {

ContactSurface contact_surface(const Discretisation& discretisation, const RigidShape& shape, double penalty,
                               double smoothing) {
  ContactOptions options;
  options.penalty_pa_per_m = penalty;
  options.smoothing_m = smoothing;
  return ContactSurface(discretisation, "side", shape, options);
}

/// Calls `f` with each contact, its surface, and its multipliers (none: penalty alone).
template <class F>
void for_each_contact(const Problem& problem, const Discretisation& discretisation, const Configuration& now,
                      F&& f) {
  Eigen::Index first = 0;
  for (const Contact& contact : problem.contacts) {
    const ContactSurface surface =
        contact_surface(discretisation, contact.body, contact.penalty_pa_per_m, contact.smoothing_m);
    Eigen::VectorXd multiplier;
    if (now.contact_multiplier.size() > 0)
      multiplier = now.contact_multiplier.segment(first, surface.point_count());
    first += surface.point_count();
    f(contact, surface, multiplier);
  }
}

void read_stretch(const MuscleReading& m, const Configuration& configuration, SolvedMuscle& state) {
  const PointFields fields = point_fields(m.problem, m.discretisation, configuration);
  state.stretch_min = fields.fibre_stretch.minCoeff();
  state.stretch_max = fields.fibre_stretch.maxCoeff();
  double sum = 0.0;
  const int points = m.discretisation.quadrature().size();
  Eigen::MatrixX3d gradient;
  for (int c = 0; c < m.discretisation.cell_count(); ++c) {
    for (int q = 0; q < points; ++q) {
      double weight = 0.0;
      m.discretisation.reference_gradients(c, q, gradient, weight);
      sum += weight * fields.fibre_stretch[q + points * c];
    }
  }
  state.stretch_mean = sum / m.discretisation.volume();
}

/// About the hinge: of the stress in the cross-section in the middle of the belly, and of the contact beyond
/// it. At the end itself stress is singular along the clamped edge.
double moment_by_stress(const MuscleReading& m, const Configuration& now) {
  const auto& origin = std::get<GuidedMotion>(m.problem.conditions[0].kind);
  const auto& insertion = std::get<GuidedMotion>(m.problem.conditions[1].kind);
  const Eigen::Vector3d along = (insertion.centre_m - origin.centre_m).normalized();
  const double middle = m.body.tendon_origin_m + m.body.belly_length_m * (m.body.belly_cells / 2) /
                                                     static_cast<double>(m.body.belly_cells);
  const Eigen::Vector3d plane = origin.centre_m + middle * along;
  Eigen::Vector3d moment =
      section_stress_wrench(m.problem, m.discretisation, now, plane, along, m.hinge.centre_m,
                            m.body.shape ? SectionFaces::parting : SectionFaces::in_plane)
          .moment_n_m;
  if (m.problem.contacts.empty()) return m.hinge.axis.dot(moment);
  // Off the faces between cells, where a plane would cut along edges.
  const SectionFigures cut = section(
      m.discretisation, now, plane + 1e-3 * m.body.belly_length_m / m.body.belly_cells * along, along);
  for_each_contact(m.problem, m.discretisation, now,
                   [&](const Contact& contact, const ContactSurface& surface, const auto& multiplier) {
                     const ContactPoints points = surface.points(now.dofs, {}, multiplier);
                     for (Eigen::Index i = 0; i < points.pressure_pa.size(); ++i) {
                       const Eigen::Vector3d x = points.position_m.col(i);
                       if (!(points.pressure_pa[i] > 0.0) || (x - cut.centroid_m).dot(cut.normal) < 0.0)
                         continue;
                       const Eigen::Vector3d f =
                           points.pressure_pa[i] * points.area_m2[i] * distance(contact.body, x).gradient;
                       moment += (x - m.hinge.centre_m).cross(f);
                     }
                   });
  return m.hinge.axis.dot(moment);
}

}  // namespace

double generalised_moment(const MuscleReading& m, const SolvedMuscle& state) {
  const EndVelocity v = end_velocity(m, state.q_rad, state.end_m);
  return state.wrench.force_n.dot(v.linear) + v.turning * m.hinge.axis.dot(state.wrench.moment_n_m);
}

double centroid_line_m(const MuscleReading& m, const Configuration& configuration) {
  const auto& origin = std::get<GuidedMotion>(m.problem.conditions[0].kind);
  const auto& insertion = std::get<GuidedMotion>(m.problem.conditions[1].kind);
  const Eigen::Vector3d along = insertion.centre_m - origin.centre_m;
  const int n = 2 * m.body.belly_cells;
  Eigen::Vector3d last = barycentre(m.discretisation, configuration, "origin");
  double length = 0.0;
  for (int i = 1; i < n; ++i) {
    // Off the faces between cells, where a plane would cut along edges.
    const double part = (i + 1e-3) / n;
    const Eigen::Vector3d next =
        section(m.discretisation, configuration, origin.centre_m + part * along, along).centroid_m;
    length += (next - last).norm();
    last = next;
  }
  return length + (barycentre(m.discretisation, configuration, "insertion") - last).norm();
}

void read_state(const MuscleReading& m, const AcceptedState& accepted, SolvedMuscle& state) {
  const Configuration& now = accepted.state.configuration;
  state.end_m = barycentre(m.discretisation, now, "insertion");
  state.wrench = wrench(m.discretisation, now, accepted.internal_force, accepted.external_force, "insertion",
                        state.end_m);
  state.force_n = state.wrench.force_n.norm();
  state.tension_n = state.wrench.force_n.dot(end_place(m.body, state.q_rad).pull);
  state.arms = lever_arms(m.hinge, state.wrench, state.end_m);
  // The third side of the identity: nodal forces summed about the hinge itself.
  const Wrench about_hinge = wrench(m.discretisation, now, accepted.internal_force, accepted.external_force,
                                    "insertion", m.hinge.centre_m);
  const double direct = m.hinge.axis.dot(about_hinge.moment_n_m);
  state.identity_error =
      std::max(std::abs(direct - state.arms.moment_n_m), std::abs(direct - state.arms.moment_of_line_n_m)) /
      state.force_n;
  state.moment_by_stress_n_m = moment_by_stress(m, now);
  state.moment_n_m = generalised_moment(m, state);
  state.length_m = centroid_line_m(m, now) + m.body.cable_length_m();
  read_stretch(m, now, state);
  state.energy_j = accepted.record.energy;
  state.stability = accepted.record.stability.verdict;
  state.relative_residual = accepted.record.relative_residual;
}

void read_contacts(const MuscleReading& m, const std::vector<Bone>& left_out, const AcceptedState& accepted,
                   SolvedMuscle& state) {
  const Eigen::VectorXd& dofs = accepted.state.configuration.dofs;
  for_each_contact(
      m.problem, m.discretisation, accepted.state.configuration,
      [&](const Contact& contact, const ContactSurface& surface, const auto& multiplier) {
        Eigen::VectorXd force = Eigen::VectorXd::Zero(dofs.size());
        const ContactSums sums = surface.add_force(dofs, {}, multiplier, force);
        state.energy_j += sums.energy_j;
        state.contacts.push_back({contact.name, sums.force_n.norm(), sums.force_n,
                                  sums.greatest_penetration_m, sums.greatest_pressure_pa, sums.area_m2});
      });
  for (const Bone& bone : left_out) {
    state.least_gap_left_out_m =
        std::min(state.least_gap_left_out_m,
                 contact_surface(m.discretisation, bone.shape, 1.0, 0.0).least_gap_m(dofs, {}));
  }
}

Eigen::VectorXd contact_pressure_pa(const Problem& problem, const Discretisation& discretisation,
                                    const Configuration& now) {
  Eigen::VectorXd pressure = Eigen::VectorXd::Zero(discretisation.mesh().points.cols());
  for_each_contact(problem, discretisation, now,
                   [&](const Contact&, const ContactSurface& surface, const auto& multiplier) {
                     pressure += surface.at_mesh_points(now.dofs, {}, multiplier).pressure_pa;
                   });
  return pressure;
}

double least_axis_distance_m(const MuscleBody& body, const AngleRange& range, const RigidShape& shape) {
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d from(body.cable.origin_m.x(), body.cable.origin_m.y(), 0.0);
  for (int i = 0; i <= 60; ++i) {
    const Eigen::Vector3d to =
        end_place(body, range.lower_rad + (range.upper_rad - range.lower_rad) * i / 60.0).centre_m;
    for (int k = 0; k <= 100; ++k)
      least = std::min(least, distance(shape, from + (to - from) * (k / 100.0)).value);
  }
  return least;
}

}  // namespace brachium::fem
