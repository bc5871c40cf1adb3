#include "fem/solve/log.hpp"

#include <fmt/format.h>

namespace brachium::fem {
namespace {

std::string number(double v, const char* format) {
  return v == 0.0 ? "-" : fmt::format(fmt::runtime(format), v);
}

std::string row(const IterationRecord& r) {
  if (r.kind == "predictor") {
    return fmt::format("{:5} {:>4}  {:<12} {:>9} {:>9.2e} {:>9} {:>6} {:>9}  {:<18} {}\n", r.step, "-",
                       r.kind, "-", r.step_norm, "-", "-", "-", "-", r.note);
  }
  if (r.kind == "cut") {
    return fmt::format("{:5} {:>4}  {:<12} {:>9} {:>9} {:>9} {:>6} {:>9}  {:<18} {}\n", r.step, "-", r.kind,
                       number(r.relative_residual, "{:.2e}"), "-", "-", "-", "-",
                       r.worst_cell < 0 ? "-" : fmt::format("{} J {:.3g}", r.worst_cell, r.worst_jacobian),
                       r.note);
  }
  return fmt::format(
      "{:5} {:4}  {:<12} {:>9.2e} {:>9.2e} {:>9.2e} {:>6} {:>9}  {:<18} {}\n", r.step, r.iteration, r.kind,
      r.relative_residual, r.step_norm, r.energy_norm,
      r.line_search == 1.0 ? "-" : fmt::format("{:.3f}", r.line_search), number(r.worst_volume, "{:.2e}"),
      r.worst_cell < 0 ? "-" : fmt::format("{} J {:.3f}", r.worst_cell, r.worst_jacobian), r.note);
}

}  // namespace

std::string log_heading() {
  return fmt::format("{:>5} {:>4}  {:<12} {:>9} {:>9} {:>9} {:>6} {:>9}  {:<18} {}\n", "step", "iter", "kind",
                     "|r|/|r0|", "|du| m", "energy J", "search", "|J-1|", "worst cell", "note");
}

std::string log_text(const StepRecord& s) {
  std::string text;
  for (const IterationRecord& r : s.iterations) text += row(r);
  text += fmt::format("{:5}       `{}` at {:.4g}: {} newton, {} chord", s.step, s.phase, s.phase_time,
                      s.newton_iterations, s.chord_iterations);
  if (s.augmentations > 0) text += fmt::format(", {} augmentations", s.augmentations);
  if (s.cut_backs > 0) text += fmt::format(", cut {} times", s.cut_backs);
  if (s.relaxation_steps > 0)
    text += fmt::format(", {} viscous steps ({:.3g} J dissipated)", s.relaxation_steps, s.dissipated_energy);
  if (!s.stability.verdict.empty()) {
    text += fmt::format("; {}", s.stability.verdict);
    if (s.stability.negative_modes > 0)
      text += fmt::format(", {} negative modes", s.stability.negative_modes);
    if (!s.stability.method.empty()) text += fmt::format(" ({})", s.stability.method);
  }
  return text + "\n";
}

std::string log_text(const Summary& s) {
  std::string text = log_heading();
  for (const StepRecord& step : s.steps) text += log_text(step);
  if (!s.completed) text += log_text(s.failed);
  text += fmt::format(
      "{} in {:.2f} s: {} steps, {} newton and {} chord iterations, {} factorisations ({}, {}), {} "
      "unknowns\n",
      s.completed ? "completed" : "stopped", s.total_seconds, s.steps.size(), s.newton_iterations,
      s.chord_iterations, s.factorisations, s.linear_solver, s.ordering, s.unknowns);
  if (!s.completed) text += s.reason + "\n";
  return text;
}

}  // namespace brachium::fem
