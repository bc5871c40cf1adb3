/// Slopes of what is read off a state:
///   R = sum f_i,                  dR = sum df_i
///   M = sum (x_i - x_s) x f_i,    dM = sum (dx_i - dx_s) x f_i + (x_i - x_s) x df_i
///   M_q = R . v + w e . M,        dM_q/dq = dR/dq . v + w e . dM/dq + R . dv/dq + dw/dq e . M

#include <Eigen/Geometry>

#include "fem/limb/muscle_reading.hpp"
#include "fem/quantities/surface_nodes.hpp"
#include "fem/solve/sensitivity.hpp"

namespace brachium::fem {
namespace {

constexpr double h = 1e-5;       // rad; the place is known to rounding, so that velocities hold 1e-10
constexpr double curved = 1e-3;  // rad, for differences of velocities: h^2 and 1e-10/h

Wrench wrench_rate(const MuscleReading& m, const AcceptedState& accepted, const StateRate& rate,
                   const Eigen::Vector3d& end) {
  Configuration now = accepted.state.configuration;
  Wrench sum;
  Configuration moved = now;
  moved.dofs += rate.dofs;  // the barycentre is linear in them
  const Eigen::Vector3d end_rate = barycentre(m.discretisation, moved, "insertion") - end;
  const data::Mesh& mesh = m.discretisation.mesh();
  for (const int node : surface_nodes(mesh, "insertion")) {
    const Eigen::Index k = 3 * static_cast<Eigen::Index>(node);
    const Eigen::Vector3d f = accepted.external_force.segment<3>(k) - accepted.internal_force.segment<3>(k);
    const Eigen::Vector3d df = rate.external_force.segment<3>(k) - rate.internal_force.segment<3>(k);
    const Eigen::Vector3d x = mesh.points.col(node) + now.dofs.segment<3>(k);
    sum.force_n += df;
    sum.moment_n_m += (rate.dofs.segment<3>(k) - end_rate).cross(f) + (x - end).cross(df);
  }
  return sum;
}

}  // namespace

EndVelocity end_velocity(const MuscleReading& m, double q, const Eigen::Vector3d& end) {
  const EndPlace after = end_place(m.body, q + h), before = end_place(m.body, q - h);
  const double turning = (after.turn_rad - before.turn_rad) / (2.0 * h);
  // The barycentre need not be the centre that the place is given for: it turns about that.
  const Eigen::Vector3d off = end - end_place(m.body, q).centre_m;
  return {(after.centre_m - before.centre_m) / (2.0 * h) + turning * m.hinge.axis.cross(off), turning};
}

void read_slopes(const MuscleReading& m, const AcceptedState& accepted, SolvedMuscle& state) {
  const Wrench& w = state.wrench;
  const Eigen::Vector3d& e = m.hinge.axis;
  const EndVelocity v = end_velocity(m, state.q_rad, state.end_m);
  const EndPlace now = end_place(m.body, state.q_rad), after = end_place(m.body, state.q_rad + h),
                 before = end_place(m.body, state.q_rad - h);
  const double towards = m.body.reference_rad == m.range.lower_rad ? 1.0 : -1.0;  // da/dq

  LoadRate turning, activating;
  turning.amplitude["insertion"] = towards;
  for (const std::string& region : m.problem.mesh->regions) activating.activation[region] = 1.0;
  const auto set = [&](const LoadRate& rate, double StateSlope::*by) {
    const Wrench dw = wrench_rate(m, accepted, accepted.sensitivity->along(rate), state.end_m);
    state.force_slope_n.*by = w.force_n.dot(dw.force_n) / state.force_n;
    state.tension_slope_n.*by = dw.force_n.dot(now.pull);
    state.moment_slope_n_m.*by = dw.force_n.dot(v.linear) + v.turning * e.dot(dw.moment_n_m);
  };
  set(turning, &StateSlope::by_q);
  set(activating, &StateSlope::by_activation);

  state.tension_slope_n.by_q += w.force_n.dot(after.pull - before.pull) / (2.0 * h);
  // The barycentre rides along: its velocity at a neighbouring angle is that of where it will be.
  const EndVelocity next = end_velocity(m, state.q_rad + curved, state.end_m + curved * v.linear),
                    last = end_velocity(m, state.q_rad - curved, state.end_m - curved * v.linear);
  state.moment_slope_n_m.by_q += w.force_n.dot(next.linear - last.linear) / (2.0 * curved) +
                                 (next.turning - last.turning) / (2.0 * curved) * e.dot(w.moment_n_m);
}

}  // namespace brachium::fem
