#pragma once
/// What a muscle's state is read off: forces, lever arms, length, fibres, contacts.

#include "fem/limb/muscle_states.hpp"

namespace brachium::fem {

struct MuscleReading {
  const MuscleBody& body;
  const Hinge& hinge;
  const Problem& problem;
  const Discretisation& discretisation;
  AngleRange range = {};  ///< for slopes
};

/// Fills all but contacts, iterations and times.
void read_state(const MuscleReading& muscle, const AcceptedState& accepted, SolvedMuscle& state);

/// Slopes of force, tension and moment by angle and activation; `state` as read_state leaves it.
/// ConvergenceFailure where the state is too near a limit point.
void read_slopes(const MuscleReading& muscle, const AcceptedState& accepted, SolvedMuscle& state);

/// Contacts of the problem, and the gap to the bones that are not part of it.
void read_contacts(const MuscleReading& muscle, const std::vector<Bone>& left_out,
                   const AcceptedState& accepted, SolvedMuscle& state);

/// Pressure of all contacts at the mesh's points [Pa], penalty and multipliers (NodalPressure).
Eigen::VectorXd contact_pressure_pa(const Problem& problem, const Discretisation& discretisation,
                                    const Configuration& now);

/// How the distal end moves with the angle [m/rad, 1], of the end's barycentre `end_m`.
struct EndVelocity {
  Eigen::Vector3d linear;
  double turning = 0.0;
};
EndVelocity end_velocity(const MuscleReading& muscle, double q_rad, const Eigen::Vector3d& end_m);

/// Work of the reactions on that motion: R . v + w e . M.
double generalised_moment(const MuscleReading& muscle, const SolvedMuscle& state);

/// Length of the line through the centroids of cross-sections from end to end [m]; the sections lie at the
/// cells' ends and middles, as planes of the stress-free body.
double centroid_line_m(const MuscleReading& muscle, const Configuration& configuration);

/// Least distance of the straight line between the ends from a body over the range of angles [m].
double least_axis_distance_m(const MuscleBody& body, const AngleRange& range, const RigidShape& shape);

}  // namespace brachium::fem
