#include "fem/solve/stepping.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "fem/linear/stopwatch.hpp"
#include "fem/solve/sensitivity.hpp"

namespace brachium::fem {
namespace {

constexpr int cuts_before_relaxation = 4;
constexpr int quick = 4, easy = 7, hard = 10;  // factorisations a step
constexpr double branch_step =
    1.0 / 16.0;  // of a phase: the shortest step that is blamed for an unstable state
constexpr double time_tolerance = 1e-12;

}  // namespace

Stepper::Stepper(const Problem& problem, const SolveOptions& options, const Observer& observer,
                 const Progress& progress)
    : problem_(problem),
      options_(options),
      observer_(observer),
      progress_(progress),
      programme_(problem),
      equations_(problem, options),
      factor_(options) {
  summary_.penalty_pa = equations_.penalty_pa();
  if (equations_.augmented()) {
    summary_.diagnostics.push_back(
        {data::Severity::note, "penalty-chosen",
         fmt::format("exact incompressibility by augmented Lagrange around a bulk modulus of {:.4g} Pa{}",
                     equations_.penalty_pa(), options.penalty_pa > 0.0 ? "" : ", chosen from the materials"),
         std::nullopt, ""});
  }
}

std::string Stepper::place(double time) const {
  const Phase& phase = problem_.programme[static_cast<std::size_t>(state_.phase)];
  return fmt::format("phase `{}`, step {} at {:.4g} of the phase", phase.name, state_.steps_taken + 1, time);
}

void Stepper::restore(const SolveState& restart) {
  if (restart.configuration.dofs.size() != equations_.discretisation().dof_count() || restart.phase < 0 ||
      restart.phase >= static_cast<int>(problem_.programme.size()) ||
      restart.configuration.activation.size() != static_cast<Eigen::Index>(problem_.mesh->regions.size())) {
    throw data::InputError(
        "restart-mismatch",
        fmt::format("the saved state has {} degrees of freedom and stands in phase {}, the problem has {} "
                    "and {} phases",
                    restart.configuration.dofs.size(), restart.phase + 1,
                    equations_.discretisation().dof_count(), problem_.programme.size()),
        "a solve goes on with the mesh, the formulation and the programme it was begun with");
  }
  state_ = restart;
  equations_.constrain(state_.released);
  factor_.analyse(equations_);
  equations_.set_released_force(state_.released_force);
  if (state_.factorised_at.dofs.size() == 0) return;
  const Configuration& at = state_.factorised_at;
  LoadPoint load;
  load.amplitude = state_.factorised_amplitude;
  load.activation = at.activation;
  factor_.make(equations_, at, load);
}

std::string Stepper::begin_phase() {
  const Phase& phase = problem_.programme[static_cast<std::size_t>(state_.phase)];
  if (!phase.release.empty()) {
    const LoadPoint now = programme_.at(state_, 0.0);
    Configuration here = state_.configuration;
    const Evaluation e = equations_.evaluate(here, now);
    if (!e.valid())
      return fmt::format("phase `{}`: reactions could not be evaluated where constraints are released",
                         phase.name);
    state_.released.insert(state_.released.end(), phase.release.begin(), phase.release.end());
    if (equations_.constrain(state_.released)) {
      factor_.analyse(equations_);
      state_.factorised_at = {};
    }
    Eigen::VectorXd reaction = equations_.constraints().not_borne(e.internal - e.external);
    reaction.tail(equations_.discretisation().pressure_node_count()).setZero();
    state_.released_force = std::move(reaction);
  }
  equations_.set_released_force(state_.released_force);
  if (state_.step_size <= 0.0) state_.step_size = 1.0 / phase.steps;
  return {};
}

void Stepper::accept(Attempt& attempt, double time, StepRecord& record) {
  const double h = time - state_.phase_time;
  state_.dofs_before = state_.configuration.dofs;
  state_.step_before = h;
  if (record.relaxation_steps > 0) state_.dofs_before.resize(0);  // not one smooth branch
  Eigen::VectorXd force;
  record.energy = equations_.assembly().residual(attempt.configuration, force, true).energy.value_or(0.0);
  state_.configuration = std::move(attempt.configuration);
  state_.configuration.dofs_before.resize(0);
  state_.configuration.inverse_dt = 0.0;
  programme_.advance(state_, time);
  ++state_.steps_taken;
  if (factor_.ready()) {
    state_.factorised_at = factor_.configuration();
    state_.factorised_amplitude = factor_.amplitude();
  } else {
    state_.factorised_at = {};
  }
  state_.unstable = record.stability.verdict == "unstable";
  state_.guessed_pressure_pa.resize(0, 0);
  const Assembled& sums = attempt.last.sums;
  record.phase_time = time;
  record.volume = sums.volume;
  record.worst_volume = sums.worst_volume;
  record.smallest_jacobian = sums.smallest_jacobian;
  record.smallest_jacobian_cell = sums.smallest_jacobian_cell;
  record.relative_residual = attempt.last.relative;
  if (options_.grow_steps) {
    if (record.cut_backs == 0 && record.newton_iterations <= quick) {
      state_.step_size *= 2.0;
    } else if (record.newton_iterations <= easy) {
      state_.step_size *= 1.25;
    } else if (record.newton_iterations > hard && record.relaxation_steps == 0) {
      state_.step_size *= 0.67;
    }
  }
  state_.step_size = std::clamp(state_.step_size, options_.smallest_step, options_.largest_step);
  summary_.last = state_;
}

void Stepper::halve(const Attempt& attempt, double h, StepRecord& record) {
  IterationRecord cut;
  cut.step = record.step;
  cut.kind = "cut";
  cut.note = attempt.accepted ? fmt::format("{} negative modes: a shorter step may keep to the stable branch",
                                            attempt.stability.negative_modes)
                              : attempt.reason;
  cut.relative_residual = attempt.last.relative;
  cut.worst_cell = attempt.last.sums.smallest_jacobian_cell;
  cut.worst_jacobian = attempt.last.sums.smallest_jacobian;
  record.iterations.push_back(cut);
  ++record.cut_backs;
  state_.step_size = 0.5 * h;
  factor_.forget();  // a factor of a lost iterate predicts badly
}

/// Empty when `attempt` may be judged: a halved step, or a relaxed one, or the reason why neither is
/// possible.
std::string Stepper::after_failure(Attempt& attempt, double h, double time, StepRecord& record, bool& again) {
  halve(attempt, h, record);
  const bool may_relax = options_.on_instability == "relax" && !equations_.rate_dependent();
  const bool smallest = 0.5 * h < options_.smallest_step || record.cut_backs >= options_.max_cut_backs;
  again = !smallest && !(may_relax && record.cut_backs >= cuts_before_relaxation);
  if (again) return {};
  const std::string trouble = fmt::format(
      "{}: {} (relative residual {:.3g}, smallest J {:.3g} in cell {})", place(time), attempt.reason,
      attempt.last.relative, attempt.last.sums.smallest_jacobian, attempt.last.sums.smallest_jacobian_cell);
  if (!may_relax) return fmt::format("{}; the step was cut {} times", trouble, record.cut_backs);
  attempt.configuration = state_.configuration;
  relax(attempt, programme_.at(state_, state_.phase_time), programme_.at(state_, time), false, record);
  if (!attempt.accepted) return fmt::format("{}; viscous continuation: {}", trouble, attempt.reason);
  summary_.diagnostics.push_back(
      {data::Severity::warning, "relaxed-state",
       fmt::format("{}; {} viscous steps led to a stable state, {:.3g} J dissipated", trouble,
                   record.relaxation_steps, record.dissipated_energy),
       std::nullopt, "the path of equilibria turns back or ends here: the body snaps"});
  return {};
}

std::string Stepper::take_step() {
  const Stopwatch watch;
  StepRecord record;
  record.step = state_.steps_taken + 1;
  record.phase = problem_.programme[static_cast<std::size_t>(state_.phase)].name;
  Attempt attempt;
  double time = 0.0;
  std::string trouble;
  for (bool again = true; again && trouble.empty();) {
    again = false;
    const double left = 1.0 - state_.phase_time;
    double h = std::min(state_.step_size, left);
    if (left - h < 0.2 * h || left - h < time_tolerance) h = left;
    time = h == left ? 1.0 : state_.phase_time + h;
    attempt = try_newton(time, record);
    if (!attempt.accepted) {
      trouble = after_failure(attempt, h, time, record, again);
    } else {
      judge_stability(attempt, time);
      again = attempt.stability.verdict == "unstable" && !state_.unstable && h > branch_step;
      if (again) halve(attempt, h, record);
    }
  }
  if (trouble.empty()) trouble = settle(attempt, time, record);
  if (trouble.empty()) accept(attempt, time, record);
  record.seconds = watch.seconds();
  summary_.newton_iterations += record.newton_iterations;
  summary_.chord_iterations += record.chord_iterations;
  summary_.augmentations += record.augmentations;
  summary_.relaxation_steps += record.relaxation_steps;
  if (!trouble.empty()) {
    record.phase_time = time;
    summary_.failed = std::move(record);
    return trouble;
  }
  summary_.steps.push_back(std::move(record));
  if (observer_) {
    const LoadPoint load = programme_.at(state_, time);
    Sensitivity sensitivity(equations_, factor_, state_.configuration, load);
    observer_({state_, summary_.steps.back(), attempt.last.internal, attempt.last.external, &sensitivity});
  }
  return {};
}

std::string Stepper::walk_phase() {
  if (state_.phase_time == 0.0) {
    if (std::string trouble = begin_phase(); !trouble.empty()) return trouble;
  }
  while (state_.phase_time < 1.0) {
    if (std::string trouble = take_step(); !trouble.empty()) return trouble;
    if (progress_) {
      progress_((state_.phase + state_.phase_time) / static_cast<double>(problem_.programme.size()),
                problem_.programme[static_cast<std::size_t>(state_.phase)].name);
    }
  }
  return {};
}

void Stepper::collect(double seconds) {
  summary_.factorisations = factor_.factorisations;
  summary_.analyses = factor_.analyses;
  summary_.back_substitutions = factor_.back_substitutions;
  summary_.residual_evaluations = equations_.residual_evaluations;
  summary_.tangent_evaluations = equations_.tangent_evaluations;
  summary_.assembly_seconds = equations_.seconds;
  summary_.factor_seconds = factor_.factor_seconds;
  summary_.solve_seconds = factor_.solve_seconds;
  summary_.analyse_seconds = factor_.analyse_seconds;
  summary_.total_seconds = seconds;
  summary_.unknowns = equations_.unknowns().count();
  summary_.factor_nonzeros = factor_.nonzeros;
  summary_.factor_flops = factor_.flops;
  summary_.linear_solver = factor_.method;
  summary_.ordering = factor_.ordering;
  if (equations_.unsymmetric()) {
    summary_.diagnostics.push_back(
        {data::Severity::note, "unsymmetric-tangent",
         "a pressure follows a surface with a free edge: the tangent is unsymmetric and goes to UMFPACK",
         std::nullopt, ""});
  }
}

Summary Stepper::run(const SolveState* restart) {
  const Stopwatch watch;
  if (restart) {
    restore(*restart);
  } else {
    state_ = programme_.start(equations_.discretisation().dof_count());
    equations_.constrain({});
    factor_.analyse(equations_);
  }
  summary_.last = state_;
  std::string trouble;
  while (trouble.empty()) {
    if (state_.phase_time >= 1.0) {
      if (state_.phase + 1 >= static_cast<int>(problem_.programme.size())) break;
      programme_.next_phase(state_);
    }
    trouble = walk_phase();
  }
  summary_.completed = trouble.empty();
  summary_.reason = trouble;
  collect(watch.seconds());
  return std::move(summary_);
}

}  // namespace brachium::fem
