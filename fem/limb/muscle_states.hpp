#pragma once
/// A muscle solved at any angle and activation, each state from the nearest one that is known.
///
/// | symbol | identifier              | unit   | meaning                                                                  |
/// |--------|-------------------------|--------|--------------------------------------------------------------------------|
/// | F      | force_n                 | N      | |R|, R the resultant of the consistent nodal reactions at the distal end |
/// | T      | tension_n               | N      | R . t, t the tendon's direction there                                    |
/// | L      | length_m                | m      | centroid line from end to end, and the rigid tendon's path               |
/// | M_q    | moment_n_m              | N m    | R . dp/dq + e . M dpsi/dq: work of the reactions on the end's motion     |
/// | p, psi | place of the distal end | m, rad | fem/limb/muscle_body.hpp                                                 |
///
/// M_q is what a muscle with a frictionless rigid tendon exerts about the hinge, whatever the tendon wraps
/// around: M_q = -dPi/dq of the muscle's energy, contact included. VRLA and VRLA+ take the wrench at the end
/// as it is.

#include <deque>
#include <limits>
#include <string>
#include <vector>

#include "fem/contact/contact.hpp"
#include "fem/limb/lever_arms.hpp"
#include "fem/limb/muscle_body.hpp"
#include "fem/quantities/wrench.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::fem {

/// A rigid body at rest that a muscle may touch.
struct Bone {
  std::string name;
  RigidShape shape;
};

struct BoneContact {
  std::string bone;
  double force_n = 0.0;  ///< |sum| on the muscle
  Eigen::Vector3d force_on_muscle_n = Eigen::Vector3d::Zero();
  double greatest_penetration_m = 0.0, greatest_pressure_pa = 0.0, area_m2 = 0.0;
};

/// How a figure moves with the state, by the tangent of the state itself (fem/solve/sensitivity.hpp).
struct StateSlope {
  double by_q = std::numeric_limits<double>::quiet_NaN();           ///< [unit/rad]
  double by_activation = std::numeric_limits<double>::quiet_NaN();  ///< [unit]
};

struct SolvedMuscle {
  double q_rad = 0.0, activation = 0.0;
  double force_n = 0.0, tension_n = 0.0, moment_n_m = 0.0, length_m = 0.0;
  Wrench wrench;                                    ///< on the tendon, about `end_m`
  Eigen::Vector3d end_m = Eigen::Vector3d::Zero();  ///< barycentre x_s of the distal end
  ResultantLeverArms arms;
  double identity_error = 0.0;  ///< largest difference of the three moments of the identity, over |R| 1 m
  /// About the hinge, from the stress in the middle of the belly and the contact beyond it: its difference to
  /// arms.moment_n_m measures the mesh.
  double moment_by_stress_n_m = 0.0;
  double stretch_min = 0.0, stretch_mean = 0.0,
         stretch_max = 0.0;                                     ///< of fibres; the mean by reference volume
  StateSlope force_slope_n, tension_slope_n, moment_slope_n_m;  ///< NaN where options leave them out
  double energy_j = 0.0;                                        ///< stored, contact included
  std::vector<BoneContact> contacts;                            ///< of the bones that are modelled
  double least_gap_left_out_m =
      std::numeric_limits<double>::infinity();  ///< to bones left out; negative: they overlap
  std::string stability;
  long newton_iterations = 0, chord_iterations = 0;
  int steps = 0;
  double relative_residual = 0.0;
  double seconds = 0.0;
  double from_q_rad = 0.0, from_activation = 0.0;  ///< the known state that it was reached from
};

inline SolveOptions one_thread() {
  SolveOptions options;
  options.threads = 1;
  return options;
}

struct SolvedMuscleOptions {
  SolveOptions solve = one_thread();  ///< states are solved side by side rather than one in parallel
  double step_rad = 0.2, step_activation = 0.34;  ///< load steps to begin with
  double contact_penalty_pa_per_m = 0.0;          ///< 0: 30 (c1 + c2) over the mean size of a cell
  double contact_smoothing_m = 2e-4;              ///< of the penalty; none with a tolerance
  double contact_tolerance_m = 0.0;               ///< greatest penetration; 0: whatever the penalty leaves
  bool slopes = true;
  double touch_margin_norm = 0.3;  ///< bones farther than this share of the greatest radius are left out
};

class MuscleStates {
 public:
  /// Builds the muscle and brings it to its in-situ place at the reference angle, passive. Throws InputError
  /// ("limb-geometry", ...), and ConvergenceFailure when that place cannot be reached.
  /// `like`: states of a muscle that differs little and has the same mesh's topology, to begin from.
  MuscleStates(MuscleBody body, AngleRange range, Hinge hinge, std::vector<Bone> bones,
               SolvedMuscleOptions options = {}, const MuscleStates* like = nullptr);

  const MuscleBody& body() const { return body_; }
  const AngleRange& range() const { return range_; }
  const Hinge& hinge() const { return hinge_; }
  long unknowns() const { return unknowns_; }
  /// Which bones are modelled, which are left out and by what distance; one line each.
  const std::vector<std::string>& log() const { return log_; }

  /// The state; remembered, so that the same question costs nothing. Throws InputError("limb-range") outside
  /// the range of angles or [0, 1], ConvergenceFailure naming muscle, state and what was tried.
  const SolvedMuscle& solve_state(double q_rad, double activation);

  /// The same, from the state that a muscle which differs little has there, its ends moved to where this
  /// one's are; in the usual way where there is none or it is too far.
  const SolvedMuscle& solve_state_like(const MuscleStates& other, double q_rad, double activation);

  /// Problem and placement of a state that was solved, for pictures. Throws InputError("limb-range") when it
  /// was not.
  const Problem& problem() const { return built_.problem; }
  const SolveState& solved(double q_rad, double activation) const;

 private:
  struct Known {
    SolvedMuscle state;
    SolveState solved;
  };
  MuscleBody body_;
  AngleRange range_;
  Hinge hinge_;
  std::vector<Bone> bones_, left_out_;
  SolvedMuscleOptions options_;
  BuiltMuscle built_;
  std::shared_ptr<const Discretisation> discretisation_;
  std::deque<Known> known_;  ///< states stay where they are
  std::vector<std::string> log_;
  long unknowns_ = 0;
  double penalty_ = 0.0;

  void choose_bones(const std::vector<Bone>& bones);
  void watch_obstacle();
  Phase phase_to(double q, double activation) const;
  Known in_situ(const MuscleStates* like);
  SolveState stretched(const Phase& phase) const;
  Eigen::Vector3d away_from_bones(const Eigen::Vector3d& from, const Eigen::Vector3d& line) const;
  void impose_ends(const Phase& phase, SolveState& state) const;
  SolveState adapted(const MuscleStates& other, const Known& known, const Phase& phase) const;
  const Known* find(double q, double activation) const;
  std::vector<const Known*> nearest(double q, double activation) const;
  /// Empty text, or why it failed.
  std::string attempt(const SolveState& from, const Phase& phase, Known& reached);
  void evaluate(const AcceptedState& accepted, SolvedMuscle& state) const;
};

}  // namespace brachium::fem
