#pragma once
/// Solves a problem along its programme: Newton with a consistent tangent, line search, adaptive load steps,
/// tangent predictor, chord iterations where they pay, augmented Lagrange for exact incompressibility,
/// stability of every accepted state, continuation past limit points by viscous relaxation, restart.
///
/// Options -> solve -> Summary; every accepted state goes to an observer.

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "fem/assembly/assembly.hpp"
#include "fem/solve/problem.hpp"

namespace brachium::fem {

/// Of the iteration at one load point.
struct NewtonSettings {
  double relative_residual = 1e-8;  ///< see fem/solve/equations.hpp for the norm that |R| is compared with
  double relative_step = 1e-6;     ///< |du| of the correction that is left, over the norm of the displacement
  int max_iterations = 20;         ///< Newton iterations a step (factorisations)
  int max_chord_iterations = 60;   ///< a step
  bool chord = true;               ///< reuse a factor while the contraction is good enough
  double volume_tolerance = 1e-8;  ///< on |theta - 1| where a bulk modulus is infinite (augmented Lagrange)
  bool augment = true;             ///< move the multipliers there; else they stay
};

struct SolveOptions : NewtonSettings {
  int max_cut_backs = 8;           ///< in a row
  int max_relaxation_steps = 300;  ///< of one viscous continuation
  bool predictor = true;  ///< begin a step with the last factor; else with a new one at the last state
  double smallest_step = 1.0 / 1024.0;  ///< fraction of a phase; below it the solve relaxes or fails
  double largest_step = 1.0;
  bool grow_steps = true;
  int max_augmentations = 30;             ///< of contact pressures, a step
  double penalty_pa = 0.0;                ///< 0: chosen from the materials and said
  std::string stability = "every_state";  ///< "every_state", "phase_ends", "off"
  std::string on_instability =
      "relax";                         ///< "relax": viscous continuation to a stable state; "report"; "fail"
  std::string linear_solver = "ldl";   ///< fem/linear; an unsymmetric tangent always goes to UMFPACK
  std::string ordering = "automatic";  ///< "metis", "amd", "automatic"
  std::size_t threads = 0;
  bool deterministic = true;
};

/// Where the body is; everything that a restart needs: a solve that goes on from it gives the same bits as
/// one that was not interrupted.
struct SolveState {
  Configuration configuration;
  int phase = 0;                                  ///< index of the phase in progress
  double phase_time = 0.0;                        ///< [0, 1] within it
  std::map<std::string, double> amplitude;        ///< by boundary condition
  std::map<std::string, double> phase_amplitude;  ///< at the beginning of the phase in progress
  Eigen::VectorXd phase_activation;               ///< by region, at the beginning of the phase in progress
  Eigen::VectorXd released_force;     ///< reactions by dof [N] that fade in this phase; empty: none
  std::vector<std::string> released;  ///< conditions that no longer hold
  double step_size = 0.0;             ///< next step, fraction of the phase; 0: the phase's own
  int steps_taken = 0;
  /// Where the tangent was last factorised: the next step is predicted with it. Empty dofs: nowhere.
  Configuration factorised_at;
  Eigen::VectorXd factorised_amplitude;  ///< by condition
  /// State before this one in the same phase, and the step between them: for extrapolation. Empty: none.
  Eigen::VectorXd dofs_before;
  double step_before = 0.0;
  bool unstable = false;  ///< this state was found to be
  /// Of a restart that is a guess rather than an equilibrium: pressures of condensed formulations, which it is
  /// solved from as it stands, without a predictor (pressures_per_cell x n_cells). Empty: an equilibrium.
  Eigen::MatrixXd guessed_pressure_pa;
};

struct Stability {
  std::string verdict;  ///< "stable", "unstable", "not checked"
  long negative_modes = 0;
  std::string
      method;  ///< "LDL' inertia, growth 12, at the state"; how far from the state where it was not at it
};

/// One row of the convergence history.
struct IterationRecord {
  int step = 0, iteration = 0;
  double residual_norm = 0.0;  ///< N, after the iteration
  double relative_residual = 0.0;
  double step_norm = 0.0;    ///< m, of the displacements
  double energy_norm = 0.0;  ///< J, work of the residual before the iteration on its step
  double line_search = 1.0;  ///< part of the step that was taken
  double worst_volume = 0.0;
  std::string
      kind;  ///< "predictor", "newton", "chord", "relax newton", "relax chord"; "cut" ends a failed step
  std::string note;     ///< "augmented"; why a step was cut
  int worst_cell = -1;  ///< smallest J
  double worst_jacobian = 1.0;
};

struct StepRecord {
  int step = 0;
  std::string phase;
  double phase_time = 0.0;
  int newton_iterations = 0, chord_iterations = 0, augmentations = 0, relaxation_steps = 0, cut_backs = 0;
  double energy = 0.0, volume = 0.0, worst_volume = 0.0, smallest_jacobian = 1.0;
  int smallest_jacobian_cell = -1;
  double relative_residual = 0.0;
  double dissipated_energy =
      0.0;  ///< J, by viscous continuation on the way to this state; the state itself has no viscosity
  Stability stability;
  double seconds = 0.0;
  std::vector<IterationRecord> iterations;
};

class Sensitivity;

/// What an observer sees at an accepted state.
struct AcceptedState {
  const SolveState& state;
  const StepRecord& record;
  const Eigen::VectorXd&
      internal_force;  ///< by dof, global axes [N]: at held dofs the reactions (minus applied loads)
  const Eigen::VectorXd& external_force;  ///< by dof, global axes [N]: applied loads
  Sensitivity* sensitivity = nullptr;     ///< how the state moves with its loads (fem/solve/sensitivity.hpp)
};

struct Summary {
  bool completed = false;
  std::string reason;  ///< why it stopped where it did not complete
  std::vector<StepRecord> steps;
  StepRecord failed;  ///< the step that was not taken, where not completed: its iterations
  SolveState last;    ///< last converged state
  long newton_iterations = 0, chord_iterations = 0, factorisations = 0, analyses = 0, augmentations = 0,
       relaxation_steps = 0;
  long residual_evaluations = 0, tangent_evaluations = 0, back_substitutions = 0;
  double assembly_seconds = 0.0, factor_seconds = 0.0, solve_seconds = 0.0, total_seconds = 0.0,
         analyse_seconds = 0.0;
  long unknowns = 0;
  double factor_nonzeros = 0.0, factor_flops = 0.0;
  double penalty_pa = 0.0;  ///< of the augmented Lagrange iteration; 0 where no region needs it
  std::string linear_solver, ordering;
  std::vector<data::Diagnostic>
      diagnostics;  ///< warnings: unstable states, unsymmetric tangent, slow convergence
};

using Observer = std::function<void(const AcceptedState&)>;
using Progress = std::function<void(double fraction, const std::string& what)>;

/// Throws InputError with everything that check(problem) finds. A failed solve does not throw: the summary
/// says where and why, and keeps the last converged state.
Summary solve(const Problem& problem, const SolveOptions& options, const Observer& observer = {},
              const Progress& progress = {}, const SolveState* restart = nullptr);

}  // namespace brachium::fem
