#include "fem/solve/relaxation.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "fem/solve/growing_mode.hpp"
#include "fem/solve/predictor.hpp"
#include "fem/solve/stability.hpp"

namespace brachium::fem {
namespace {

constexpr double first_dt = 0.1, smallest_dt = 1e-5, largest_dt = 1e8;  // s of pseudo-time
constexpr int most_finishes = 12, steps_between_finishes = 10;

Configuration at_rest(Configuration c) {
  c.dofs_before.resize(0);
  c.inverse_dt = 0.0;
  c.viscosity_pa_s = 0.0;
  return c;
}

}  // namespace

bool Relaxer::disturb(Configuration& configuration, const LoadPoint& load) {
  const auto mode = growing_mode(equations_, factor_, at_rest(configuration), load);
  if (mode) equations_.add(*mode, 0.01 * equations_.cell_size_m(), configuration.dofs);
  return mode.has_value();
}

bool Relaxer::move_held(Configuration& configuration, const LoadPoint& from, const LoadPoint& to,
                        double inverse_dt) {
  Configuration viscous = at_rest(configuration);
  viscous.dofs_before = viscous.dofs;
  viscous.inverse_dt = inverse_dt;
  viscous.viscosity_pa_s = equations_.stiffness_pa();
  viscous.activation = from.activation;
  if (!factor_.make(equations_, viscous, from).empty()) return false;
  Eigen::MatrixXd pressure;
  if (!predict(equations_, factor_, from, to, viscous, pressure)) return false;
  if (!equations_.evaluate(viscous, to).valid()) return false;
  configuration.dofs = viscous.dofs;
  return true;
}

Relaxation Relaxer::run(Configuration& configuration, const LoadPoint& from, const LoadPoint& to,
                        bool disturbed, int step, std::vector<IterationRecord>& records) {
  Relaxation result;
  if (equations_.rate_dependent()) {
    result.reason = "viscous continuation would change the rates that a rate-dependent law asks for";
    return result;
  }
  Configuration now = at_rest(configuration);
  if (disturbed) {
    if (!disturb(now, to)) {
      result.reason = "no direction was found along which the energy falls";
      return result;
    }
  } else if (!move_held(now, from, to, 1.0 / first_dt)) {
    result.reason = "the held parts of the body could not be moved to the new load without inverting a cell";
    return result;
  }
  NewtonSettings flow = options_;
  flow.relative_residual = 1e-5;
  flow.relative_step = 1e-3;
  flow.max_iterations = 6;
  flow.max_chord_iterations = 12;
  flow.augment = false;  // once a step instead: inside, viscosity over penalty would slow Newton down
  double dt = first_dt, growth = 2.0;
  int finishes = 0, next_finish = 0;
  std::string last_trouble;
  const auto count = [&](const NewtonOutcome& o) {
    result.newton += o.newton;
    result.chord += o.chord;
    result.augmentations += o.augmentations;
  };
  while (result.steps < options_.max_relaxation_steps) {
    ++result.steps;
    Configuration next = now;
    next.dofs_before = now.dofs;
    next.inverse_dt = 1.0 / dt;
    next.viscosity_pa_s = equations_.stiffness_pa();
    factor_.forget();
    NewtonOutcome outcome = Newton(equations_, factor_, flow, "relax ").run(next, to, step, records);
    count(outcome);
    const auto modes = factor_.negative_modes();
    if (!outcome.converged || (modes && modes->count > 0)) {
      last_trouble = outcome.converged ? fmt::format("{} negative modes of the viscous tangent", modes->count)
                                       : outcome.reason;
      dt *= 0.3;
      growth = 1.3;
      if (dt < smallest_dt) {
        result.reason = fmt::format("the viscous flow could not go on: {}", last_trouble);
        return result;
      }
      continue;
    }
    next = at_rest(std::move(next));
    Configuration probe = next;
    const Evaluation still = equations_.evaluate(probe, to);
    result.dissipated_energy += -still.residual.dot(equations_.unknowns().restrict(next.dofs - now.dofs));
    now = std::move(next);
    if (equations_.augmented()) {
      now.multiplier = equations_.assembly().pressures(now);
      ++result.augmentations;
    }
    const bool slow = dt >= 1e3 && still.relative <= 1e-2;
    // A passage near a vanished equilibrium looks like rest: what the flow is solved to follows the residual
    // it flows by.
    flow.relative_residual = std::clamp(1e-2 * still.relative, options_.relative_residual, 1e-5);
    if ((slow || still.relative <= 1e-4) && result.steps >= next_finish) {
      // At rest, or nearly: without viscosity.
      Configuration end = now;
      std::vector<IterationRecord> tail;
      NewtonSettings plain = options_;
      plain.max_iterations = 8;
      factor_.forget();
      NewtonOutcome finish = Newton(equations_, factor_, plain).run(end, to, step, tail);
      count(finish);
      records.insert(records.end(), tail.begin(), tail.end());
      if (finish.converged) {
        const Stability verdict = check_stability(equations_, factor_, options_, end, to);
        if (verdict.negative_modes == 0) {
          result.reached = true;
          result.stability = verdict;
          result.last = std::move(finish.last);
          configuration = std::move(end);
          return result;
        }
        last_trouble = fmt::format("came to rest in a state with {} negative modes", verdict.negative_modes);
        now = end;
        if (!disturb(now, to)) {
          result.reason = last_trouble + ", and no direction was found along which the energy falls";
          return result;
        }
        dt = std::min(dt, 10.0);
      } else {
        last_trouble = finish.reason;
      }
      ++finishes;
      next_finish = result.steps + steps_between_finishes * finishes;
      if (finishes >= most_finishes) {
        result.reason = fmt::format("no stable state was found in {} attempts: {}", finishes, last_trouble);
        return result;
      }
    }
    dt = std::min(largest_dt, dt * (outcome.newton <= 3 ? growth : 1.0));
    growth = std::min(4.0, growth * 1.2);
  }
  result.reason = fmt::format("the body still flowed after {} viscous steps{}{}", result.steps,
                              last_trouble.empty() ? "" : "; last trouble: ", last_trouble);
  return result;
}

}  // namespace brachium::fem
