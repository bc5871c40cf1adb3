#include "fem/solve/solve.hpp"

#include <algorithm>

#include "fem/solve/stepping.hpp"

namespace brachium::fem {
namespace {

void check(const SolveOptions& o, std::vector<data::Diagnostic>& found) {
  const auto wrong = [&](bool bad, const std::string& name, const std::string& range) {
    if (bad)
      found.push_back(
          {data::Severity::error, "bad-option", "`" + name + "` must be " + range, std::nullopt, ""});
  };
  wrong(!(o.relative_residual > 0.0) || !(o.relative_residual < 1.0), "relative_residual", "in (0, 1)");
  wrong(!(o.relative_step > 0.0), "relative_step", "greater than 0");
  wrong(o.max_iterations < 1, "max_iterations", "at least 1");
  wrong(!(o.smallest_step > 0.0) || !(o.smallest_step <= 1.0), "smallest_step", "in (0, 1]");
  wrong(!(o.largest_step >= o.smallest_step) || !(o.largest_step <= 1.0), "largest_step",
        "in [smallest_step, 1]");
  wrong(!(o.volume_tolerance > 0.0), "volume_tolerance", "greater than 0");
  wrong(!(o.penalty_pa >= 0.0) || o.penalty_pa > 1e300, "penalty_pa", "0 (chosen) or a finite stiffness");
  const auto one_of = [&](const std::string& value, const std::string& name,
                          const std::vector<std::string>& known) {
    if (std::find(known.begin(), known.end(), value) != known.end()) return;
    found.push_back({data::Severity::error, "bad-option", "`" + name + "` cannot be `" + value + "`",
                     std::nullopt, data::suggest(value, known)});
  };
  one_of(o.stability, "stability", {"every_state", "phase_ends", "off"});
  one_of(o.on_instability, "on_instability", {"relax", "report", "fail"});
  one_of(o.ordering, "ordering", {"automatic", "metis", "amd"});
  one_of(o.linear_solver, "linear_solver", symmetric_solver_names());
}

}  // namespace

Summary solve(const Problem& problem, const SolveOptions& options, const Observer& observer,
              const Progress& progress, const SolveState* restart) {
  std::vector<data::Diagnostic> found = check(problem);
  check(options, found);
  std::vector<data::Diagnostic> errors, others;
  for (const data::Diagnostic& d : found)
    (d.severity == data::Severity::error ? errors : others).push_back(d);
  if (!errors.empty()) throw data::InputError(errors);
  Summary summary = Stepper(problem, options, observer, progress).run(restart);
  summary.diagnostics.insert(summary.diagnostics.begin(), others.begin(), others.end());
  return summary;
}

}  // namespace brachium::fem
