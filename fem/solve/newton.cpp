#include "fem/solve/newton.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace brachium::fem {
namespace {

constexpr double chord_limit = 0.7;  // contraction from which on a factor is given up
constexpr int most_trials = 8;
constexpr double least_part = 1e-3;

}  // namespace

double Newton::step_scale(const Configuration& configuration) const {
  const auto u = equations_.displacements(configuration.dofs);
  return std::max(u.norm(), 1e-3 * equations_.cell_size_m() * std::sqrt(static_cast<double>(u.size())));
}

bool Newton::arrived(const Point& p) const {
  if (augmenting() && p.evaluation.sums.worst_volume > settings_.volume_tolerance) return false;
  return p.evaluation.relative <= std::max(settings_.relative_residual, p.evaluation.rounding);
}

bool Newton::chord_pays(const Point& p, double contraction) const {
  if (!settings_.chord || !(contraction < chord_limit) || outcome_.chord >= settings_.max_chord_iterations)
    return false;
  if (augmenting() && contraction <= 1.1 * fresh_contraction_) return true;
  const double left = std::log(std::min(settings_.relative_residual / p.evaluation.relative, 0.5)) /
                      std::log(std::max(contraction, 1e-12));
  return left <= 2.0 * factor_.cost_ratio();
}

/// p, Δp, and the multiplier that gives the configuration this pressure.
void Newton::set_pressure(Point& p, Eigen::MatrixXd pressure) {
  const Eigen::MatrixXd volumetric = equations_.volumetric_pressure(p.configuration);
  p.pressure = std::move(pressure);
  p.excess = volumetric;
  if (!augmenting()) p.excess -= p.pressure;
  if (multiplier_.size() > 0) p.excess += multiplier_;
  p.configuration.multiplier = p.pressure - volumetric;
}

void Newton::correct(Point& p) {
  p.correction = -p.evaluation.residual;
  if (equations_.condensed()) {
    const Eigen::VectorXd defect = factor_.coupling(equations_, p.excess);
    p.correction -= defect;
    // What is left of the residual once the pressure follows the volume.
    p.evaluation.relative = std::max(p.evaluation.relative, p.correction.norm() / p.evaluation.reference);
  }
  factor_.solve(p.correction);
  p.length = equations_.displacement_norm(p.correction);
}

/// Empty, or why there is none. The correction is the new factor's.
std::string Newton::new_factor(Point& p, const LoadPoint& load) {
  if (std::string trouble = factor_.make(equations_, p.configuration, load); !trouble.empty()) return trouble;
  ++outcome_.newton;
  secant_.clear();
  correct(p);
  return std::isfinite(p.length) ? "" : "the tangent's factor gave a step that is not finite";
}

Newton::Point Newton::move(const Point& from, const Eigen::VectorXd& step, double part,
                           const LoadPoint& load) {
  Point p;
  p.part = part;
  p.configuration = from.configuration;
  p.configuration.dofs += part * equations_.unknowns().extend(step);
  if (equations_.condensed()) {
    set_pressure(p, from.pressure + part * (from.excess + factor_.pressure_change(equations_, step)));
    if (!p.pressure.allFinite() || !p.excess.allFinite())
      p.configuration.multiplier.setZero();  // the evaluation names the cell
  }
  p.evaluation = equations_.evaluate(p.configuration, load);
  if (p.evaluation.valid()) correct(p);
  return p;
}

/// From a new factor's correction; a point that is not valid, or not nearer, where no damping helps.
Newton::Point Newton::damped(const Point& from, const LoadPoint& load) {
  double part = 1.0;
  Point best;
  for (int trial = 0; trial < most_trials && part >= least_part; ++trial) {
    Point p = move(from, from.correction, part, load);
    if (!p.evaluation.valid()) {
      if (!best.evaluation.valid() || best.correction.size() == 0) best = std::move(p);
      part *= 0.5;
      continue;
    }
    if (p.length <= (1.0 - 0.25 * part) * from.length || arrived(p)) return p;
    const double curved = (p.correction - (1.0 - part) * from.correction).norm();
    const double proposed = part * part * from.correction.norm() / (2.0 * curved);
    if (best.correction.size() == 0 || p.length < best.length) best = std::move(p);
    part = std::clamp(proposed, 0.1 * part, 0.5 * part);
  }
  return best;
}

void Newton::record(const std::string& kind, const Point& from, const Point& to, int step,
                    std::vector<IterationRecord>& records) const {
  IterationRecord r;
  r.step = step;
  r.iteration = outcome_.newton + outcome_.chord;
  r.kind = prefix_ + kind;
  r.residual_norm = to.evaluation.residual_norm;
  r.relative_residual = to.evaluation.relative;
  r.step_norm = from.length;
  r.energy_norm = std::abs(from.correction.dot(from.evaluation.residual));
  r.line_search = to.part;
  r.worst_volume = to.evaluation.sums.worst_volume;
  r.worst_cell = to.evaluation.sums.smallest_jacobian_cell;
  r.worst_jacobian = to.evaluation.sums.smallest_jacobian;
  records.push_back(r);
}

NewtonOutcome Newton::run(Configuration& configuration, const LoadPoint& load, int step,
                          std::vector<IterationRecord>& records, Eigen::MatrixXd pressure) {
  outcome_ = {};
  fresh_contraction_ = 0.0;
  secant_ = Secant(equations_.displacement_unknowns());
  Point now;
  now.configuration = configuration;
  multiplier_.resize(0, 0);
  if (!augmenting()) multiplier_ = configuration.multiplier;
  if (equations_.condensed()) {
    if (pressure.size() == 0) pressure = equations_.assembly().pressures(now.configuration);
    set_pressure(now, std::move(pressure));
  }
  now.evaluation = equations_.evaluate(now.configuration, load);
  const auto end = [&](const std::string& reason) {
    outcome_.converged = reason.empty();
    outcome_.reason = reason;
    configuration = std::move(now.configuration);
    if (equations_.condensed() && !augmenting()) {
      configuration.multiplier = multiplier_;
      if (outcome_.converged)
        now.evaluation = equations_.evaluate(configuration, load);  // at U'(θ) + m itself
    }
    outcome_.last = std::move(now.evaluation);
    return std::move(outcome_);
  };
  if (!now.evaluation.valid()) {
    const AssemblyFailure failure = *now.evaluation.sums.failure;
    now.evaluation.sums.smallest_jacobian = failure.jacobian;
    now.evaluation.sums.smallest_jacobian_cell = failure.cell;
    return end(fmt::format("cell {} has J = {:.3g} where the step begins", failure.cell, failure.jacobian));
  }
  bool fresh = false;                              // the factor is of this point
  bool keep = settings_.chord && factor_.ready();  // the factor may serve once more
  int stalled = 0;
  if (factor_.ready()) correct(now);
  while (true) {
    if (arrived(now) && factor_.ready() &&
        now.length <= settings_.relative_step * step_scale(now.configuration))
      return end("");
    if (!keep && !fresh) {
      if (outcome_.newton >= settings_.max_iterations) {
        return end(fmt::format("{} Newton iterations left a relative residual of {:.3g}", outcome_.newton,
                               now.evaluation.relative));
      }
      if (std::string trouble = new_factor(now, load); !trouble.empty()) return end(trouble);
      fresh = true;
      continue;
    }
    Point next;
    if (fresh) {
      next = damped(now, load);
      record("newton", now, next, step, records);
      if (!next.evaluation.valid()) {
        const AssemblyFailure failure = *next.evaluation.sums.failure;
        return end(fmt::format("cell {} inverts (J = {:.3g}) however short the Newton step", failure.cell,
                               failure.jacobian));
      }
    } else {
      ++outcome_.chord;
      const Eigen::VectorXd direction = augmenting() ? now.correction : secant_.step(now.correction);
      next = move(now, direction, 1.0, load);
      const bool nearer = next.evaluation.valid() && (next.length < now.length || arrived(next));
      if (!nearer) next.part = 0.0;
      record("chord", now, next, step, records);
      if (!nearer) {
        keep = false;
        continue;
      }
      secant_.taken(direction);
    }
    const double contraction = next.length / now.length;
    if (augmenting()) ++outcome_.augmentations;
    if (fresh && next.part == 1.0) {
      secant_.taken(now.correction);
      fresh_contraction_ = contraction;
    }
    stalled = contraction > 0.99 ? stalled + 1 : 0;
    keep = next.part == 1.0 && (chord_pays(next, contraction) || (arrived(next) && contraction < 1.0));
    fresh = false;
    now = std::move(next);
    if (stalled >= 5)
      return end(fmt::format("stalled at a relative residual of {:.3g}", now.evaluation.relative));
  }
}

}  // namespace brachium::fem
