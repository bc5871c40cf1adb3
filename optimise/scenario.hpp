#pragma once
/// The equivalent static system of a joint, and three questions asked of it: which activation holds an angle,
/// at which angles given activations hold a load, and where a load history takes the limb. Over any muscle
/// model.
///
/// | symbol | identifier | unit | meaning                                                  |
/// |--------|------------|------|----------------------------------------------------------|
/// | q      | angle_rad  | rad  | the joint's angle, flexion positive                      |
/// | a      | activation | 1    | activations of all muscles                               |
/// | L      | load       | N    | size of the external load, sign as its arm says          |
/// | l(q)   | load_arm   | m    | moment for each newton of load, flexion positive         |
/// | M      | moment_N_m | N m  | M(q, a, L) = Σ r F + l(q) L + M_ext(q), flexion positive |
/// | S      | scale_N_m  | N m  | Σ |r F| + |l L| + |M_ext|                                |
///
/// All of them solve M = 0. An iteration stops where |M| < max(1e-6 S, 10 tolerance), tolerance being what
/// the model's own solver leaves open in M. Derivatives of the answers come from the implicit function
/// theorem:
///   dq/da = -M_a / M_q,   dq/dL = -M_L / M_q,   da_k/dq = -M_q / M_(a_k), ...
/// No solution in range is a result, with the nearest there is.

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "data/limb/muscle_model.hpp"
#include "data/model/curve.hpp"

namespace brachium::optimise {

/// One joint's angle at work; all other coordinates of the model stand still.
struct StaticSystem {
  const limb::MuscleModel* model = nullptr;          ///< quasi-static; not owned
  std::size_t coordinate = 0;                        ///< which entry of q moves
  Eigen::VectorXd q;                                 ///< the others (n_q); empty: all zero
  std::function<data::CurveValue(double)> load_arm;  ///< empty: no load
  std::function<data::CurveValue(double)>
      external_moment;                      ///< independent of L, such as gravity; may be empty
  double lower_rad = 0.0, upper_rad = 0.0;  ///< range of the angle
};

/// M and its derivatives at one state.
struct MomentState {
  double moment_N_m = 0.0;
  double dangle_N_m_per_rad = 0.0;
  Eigen::VectorXd dactivation_N_m;        ///< n_m
  double dload_m = 0.0;                   ///< l(q)
  double scale_N_m = 0.0;                 ///< S
  double error_bound_N_m = 0.0;           ///< the model's, 0 if it gives none
  Eigen::VectorXd force_N, moment_arm_m;  ///< n_m
};

/// Throws InputError("not-quasi-static"), ("wrong-size"), ("bad-range") for a system that is none, and what
/// the model throws. Derivatives that the model does not give are central differences over 1e-5 (inside the
/// range).
MomentState moment_at(const StaticSystem& system, double angle_rad, const Eigen::VectorXd& activation,
                      double load_N);

/// One row of an iteration, as the thesis' tables have it.
struct ConvergenceRow {
  int iteration = 0;
  double at = 0.0;          ///< the unknown: angle [rad] or activation
  double moment_N_m = 0.0;  ///< M there
  double step = 0.0;        ///< change that led there; 0 in the first row
};

struct ScenarioOptions {
  double relative_tolerance = 1e-6;       ///< of S
  double propagated_tolerance_N_m = 0.0;  ///< of the model's own solver, in M
  int max_iterations = 60;
  std::size_t scan_points = 141;  ///< over the range of angles, where all equilibria are sought
};

/// Where |M| counts as nothing: max(relative S, 10 propagated).
double stopping_moment(const MomentState& at, const ScenarioOptions& options);

// ---------------------------------------------------------------- which activation holds an angle

struct HeldAngle {
  std::optional<double> activation;  ///< of the muscle sought; none: not in [lower, upper]
  double nearest = 0.0;              ///< activation where |M| is smallest: the answer, or an end of the range
  double remaining_moment_N_m = 0.0;  ///< M at `nearest`
  std::optional<double>
      remaining_load_N;             ///< further load that would hold it with `nearest`; none without an arm
  double dactivation_dangle = 0.0;  ///< [1/rad], at an answer
  double dactivation_dload = 0.0;   ///< [1/N]
  Eigen::VectorXd dactivation_dactivation;  ///< by the other activations; 0 for its own
  std::vector<ConvergenceRow> history;
};

/// Position-driven: the activation of `muscle` that holds the angle, others as in `activation` (whose own
/// entry is the start). M has to be monotone in that activation: throws ConvergenceFailure where the
/// derivative changes its sign between lower and upper (looked at in 5 places, and along the iteration).
HeldAngle held_angle(const StaticSystem& system, double angle_rad, std::size_t muscle,
                     Eigen::VectorXd activation, double load_N, const ScenarioOptions& options = {},
                     double lower = 0.0, double upper = 1.0);

// ---------------------------------------------------------------- at which angles activations hold

struct EquilibriumAngle {
  double angle_rad = 0.0;
  bool stable = false;                     ///< dM/dq < 0
  double stiffness_N_m_per_rad = 0.0;      ///< dM/dq
  double moment_N_m = 0.0;                 ///< what is left of M
  Eigen::VectorXd dangle_dactivation_rad;  ///< n_m
  double dangle_dload_rad_per_N = 0.0;
  double angle_error_rad = 0.0;  ///< the model's error bound over |dM/dq|; 0 if it gives none
  std::vector<ConvergenceRow> history;
};

struct Equilibria {
  std::vector<EquilibriumAngle> all;  ///< by increasing angle
  double nearest_rad = 0.0;           ///< where |M| is smallest
  double nearest_moment_N_m = 0.0;    ///< M there
};

/// Activation-driven: every equilibrium in range. Roots closer together than the scan's step may be missed
/// unless |M| turns round there.
Equilibria equilibria(const StaticSystem& system, const Eigen::VectorXd& activation, double load_N,
                      const ScenarioOptions& options = {});

/// The one that Newton's method from `start_rad` reaches, kept inside the range and inside the last change of
/// sign; none where it does not reach any, with the history of how it went.
struct FromStart {
  std::optional<EquilibriumAngle> equilibrium;
  std::vector<ConvergenceRow> history;
};
FromStart equilibrium_from(const StaticSystem& system, const Eigen::VectorXd& activation, double load_N,
                           double start_rad, const ScenarioOptions& options = {});

// ---------------------------------------------------------------- where a history takes the limb

/// The load that holds an angle, L = -(Σ r F + M_ext) / l; none where |l| < 1e-9 m.
std::optional<double> load_for_angle(const StaticSystem& system, double angle_rad,
                                     const Eigen::VectorXd& activation);

enum class FrameKind {
  followed,  ///< along the branch of the frame before; in the first frame, from the start to the first
             ///< equilibrium
  jumped,    ///< the branch ended (fold): to the next equilibrium in the direction of M
  at_lower,  ///< no equilibrium in the direction of M: pushed against the lower end of the range
  at_upper
};
const char* frame_kind_name(FrameKind kind);

struct Frame {
  double time_s = 0.0;
  FrameKind kind = FrameKind::followed;
  double angle_rad = 0.0;   ///< of the equilibrium, or the end of the range
  double moment_N_m = 0.0;  ///< left of M: below tolerance, or what presses against the end
  double stiffness_N_m_per_rad = 0.0;
  double dangle_dload_rad_per_N = 0.0;
  Eigen::VectorXd dangle_dactivation_rad;
  int iterations = 0;
};

struct AngleHistory {
  std::vector<Frame> frames;
  std::vector<std::string> events;  ///< jumps, arrivals at and departures from the ends, in words
};

/// Force- and activation-driven histories: quasi-static motion from `start_rad`. In each frame the limb moves
/// from where it was in the direction of M until M vanishes; it follows a stable branch as long as that
/// exists. A motion that crosses angles with dM/dq > 0 has left its branch: a jump. (Seen at the scan's
/// resolution.) activation: n_m x n_t, load: n_t [N]. Throws InputError("wrong-size") for series of different
/// lengths, ("bad-range") for a start outside the range.
AngleHistory follow(const StaticSystem& system, const std::vector<double>& time_s,
                    const Eigen::MatrixXd& activation, const Eigen::VectorXd& load_N, double start_rad,
                    const ScenarioOptions& options = {});

struct ActivationFrame {
  double time_s = 0.0;
  HeldAngle held;
};

/// Position-driven history: the activation that holds each angle, started from the one before.
std::vector<ActivationFrame> hold(const StaticSystem& system, const std::vector<double>& time_s,
                                  const Eigen::VectorXd& angle_rad, std::size_t muscle,
                                  const Eigen::MatrixXd& activation, const Eigen::VectorXd& load_N,
                                  const ScenarioOptions& options = {});

}  // namespace brachium::optimise
