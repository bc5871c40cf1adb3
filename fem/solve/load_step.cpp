// One load step: first guess, Newton, contact's multipliers, stability, relaxation.

#include <fmt/format.h>

#include "fem/solve/predictor.hpp"
#include "fem/solve/relaxation.hpp"
#include "fem/solve/stability.hpp"
#include "fem/solve/stepping.hpp"

namespace brachium::fem {

void Stepper::count(const NewtonOutcome& outcome, StepRecord& record) {
  record.newton_iterations += outcome.newton;
  record.chord_iterations += outcome.chord;
  record.augmentations += outcome.augmentations;
}

Configuration Stepper::first_guess(const LoadPoint& from, const LoadPoint& to, double h, StepRecord& record,
                                   Eigen::MatrixXd& pressure) {
  Configuration guess = state_.configuration;
  if (state_.guessed_pressure_pa.size() > 0) {
    equations_.constraints().impose(to.amplitude, guess.dofs);
    guess.activation = to.activation;
    pressure = state_.guessed_pressure_pa;
    return guess;
  }
  if (!options_.predictor) factor_.forget();
  const bool fresh = !factor_.ready();
  if (fresh) factor_.make(equations_, state_.configuration, from);
  if (fresh && !options_.predictor) ++record.newton_iterations;
  if (!predict(equations_, factor_, from, to, guess, pressure)) {
    equations_.constraints().impose(to.amplitude, guess.dofs);
    return guess;
  }
  IterationRecord r;
  r.step = record.step;
  r.kind = "predictor";
  r.step_norm = equations_.displacements(guess.dofs - state_.configuration.dofs).norm();
  if (fresh) r.note = "new factor";
  if (options_.predictor && state_.dofs_before.size() > 0 && state_.step_before > 0.0) {
    guess.dofs =
        extrapolate(state_.dofs_before, state_.configuration.dofs, guess.dofs, h / state_.step_before);
    equations_.constraints().impose(to.amplitude, guess.dofs);
    r.note = "second order";
  }
  record.iterations.push_back(r);
  return guess;
}

Stepper::Attempt Stepper::try_newton(double time, StepRecord& record) {
  Attempt attempt;
  const LoadPoint from = programme_.at(state_, state_.phase_time), to = programme_.at(state_, time);
  const double h = time - state_.phase_time;
  Eigen::MatrixXd pressure;
  attempt.configuration = first_guess(from, to, h, record, pressure);
  if (equations_.rate_dependent()) {
    attempt.configuration.dofs_before = state_.configuration.dofs;
    attempt.configuration.inverse_dt =
        1.0 / (h * problem_.programme[static_cast<std::size_t>(state_.phase)].duration_s);
  }
  NewtonOutcome outcome =
      Newton(equations_, factor_, options_)
          .run(attempt.configuration, to, record.step, record.iterations, std::move(pressure));
  count(outcome, record);
  attempt.accepted = outcome.converged;
  attempt.reason = outcome.reason;
  attempt.last = std::move(outcome.last);
  press(attempt, to, record);
  return attempt;
}

/// Uzawa's iteration: contact pressures become multipliers until the penetration is within its tolerance.
void Stepper::press(Attempt& attempt, const LoadPoint& load, StepRecord& record) {
  const Contacts& contacts = equations_.loads().contacts();
  if (contacts.empty()) return;
  Configuration& c = attempt.configuration;
  for (int k = 0; attempt.accepted; ++k) {
    const double ratio = contacts.penetration_ratio(load.amplitude, c.dofs, c.contact_multiplier);
    if (ratio <= 1.0) return;
    if (k == options_.max_augmentations) {
      attempt.accepted = false;
      attempt.reason = fmt::format(
          "{} augmentations left a contact gap of {:.3g} times its tolerance; a higher penalty needs fewer",
          k, ratio);
      return;
    }
    c.contact_multiplier = contacts.pressures(load.amplitude, c.dofs, c.contact_multiplier);
    NewtonOutcome outcome =
        Newton(equations_, factor_, options_).run(c, load, record.step, record.iterations);
    count(outcome, record);
    ++record.augmentations;
    attempt.accepted = outcome.converged;
    attempt.reason = outcome.reason;
    attempt.last = std::move(outcome.last);
  }
}

/// Viscous continuation from the attempt's configuration, an equilibrium at `from`, to a stable state at
/// `to`.
void Stepper::relax(Attempt& attempt, const LoadPoint& from, const LoadPoint& to, bool disturb,
                    StepRecord& record) {
  Relaxation r = Relaxer(equations_, factor_, options_)
                     .run(attempt.configuration, from, to, disturb, record.step, record.iterations);
  record.newton_iterations += r.newton;
  record.chord_iterations += r.chord;
  record.augmentations += r.augmentations;
  record.relaxation_steps += r.steps;
  record.dissipated_energy += r.dissipated_energy;
  attempt.accepted = r.reached;
  attempt.reason = r.reason;
  attempt.stability = r.stability;
  attempt.last = std::move(r.last);
  const int before = record.augmentations;
  press(attempt, to, record);  // the viscous flow holds the contacts by their penalty
  if (!attempt.accepted || record.augmentations == before) return;
  attempt.stability = check_stability(equations_, factor_, options_, attempt.configuration, to);
  if (attempt.stability.verdict != "unstable") return;
  attempt.accepted = false;
  attempt.reason = "stable while the penalty holds the contacts, unstable with contacts to their tolerance";
}

bool Stepper::wants_stability(double time) const {
  return options_.stability == "every_state" || (options_.stability == "phase_ends" && time >= 1.0);
}

void Stepper::judge_stability(Attempt& attempt, double time) {
  attempt.stability =
      wants_stability(time)
          ? check_stability(equations_, factor_, options_, attempt.configuration, programme_.at(state_, time))
          : Stability{"not checked", 0, ""};
}

/// What options ask for where a state is unstable. Empty when the state, perhaps a relaxed one, may be
/// accepted.
std::string Stepper::settle(Attempt& attempt, double time, StepRecord& record) {
  record.stability = attempt.stability;
  if (record.stability.verdict != "unstable") return {};
  const std::string finding =
      fmt::format("{}: the equilibrium is unstable, {} negative modes ({})", place(time),
                  record.stability.negative_modes, record.stability.method);
  const auto warn = [&](const std::string& text) {
    summary_.diagnostics.push_back(
        {data::Severity::warning, "unstable-state", text, std::nullopt,
         "contraction on the descending limb of the force-length curve is not unique"});
  };
  if (options_.on_instability == "fail") return finding;
  if (options_.on_instability == "report") {
    warn(finding);
    return {};
  }
  const LoadPoint load = programme_.at(state_, time);
  relax(attempt, load, load, true, record);
  if (!attempt.accepted) return finding + "; " + attempt.reason;
  warn(fmt::format("{}; relaxed to a stable state in {} viscous steps, {:.3g} J dissipated", finding,
                   record.relaxation_steps, record.dissipated_energy));
  record.stability = attempt.stability;
  return {};
}

}  // namespace brachium::fem
