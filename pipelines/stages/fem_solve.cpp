/// fem.solve: a quasi-static boundary-value problem of muscle and tendon tissue, from its definition to
/// forces and fields.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "fem/assembly/discretisation.hpp"
#include "fem/quantities/quantities.hpp"
#include "fem/solve/solve.hpp"
#include "pipelines/fingerprint.hpp"
#include "pipelines/report/text.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_checkpoint.hpp"
#include "pipelines/stages/fem_field_files.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/fem_options.hpp"
#include "pipelines/stages/fem_problem.hpp"
#include "pipelines/stages/fem_quantities.hpp"
#include "pipelines/stages/fem_report.hpp"
#include "pipelines/stages/fem_surface.hpp"
#include "pipelines/stages/fem_upper_limb.hpp"

namespace brachium::pipelines {
namespace {

data::Table step_row(int state, const fem::StepRecord& r) {
  TableBuilder t("Accepted states");
  t.number("state", "1")
      .text("phase")
      .number("phase_time", "1")
      .number("newton", "1")
      .number("chord", "1")
      .number("augmentations", "1")
      .number("relaxations", "1")
      .number("cut_backs", "1")
      .number("relative_residual", "1")
      .number("energy_J", "J")
      .number("volume_m3", "m3")
      .number("worst_volume", "1")
      .number("smallest_J", "1")
      .number("smallest_J_cell", "1")
      .text("stability")
      .number("negative_modes", "1")
      .text("method")
      .number("time_s", "s");
  t.row({static_cast<double>(state), r.phase, r.phase_time, static_cast<double>(r.newton_iterations),
         static_cast<double>(r.chord_iterations), static_cast<double>(r.augmentations),
         static_cast<double>(r.relaxation_steps), static_cast<double>(r.cut_backs), r.relative_residual,
         r.energy, r.volume, r.worst_volume, r.smallest_jacobian,
         static_cast<double>(r.smallest_jacobian_cell), r.stability.verdict,
         static_cast<double>(r.stability.negative_modes), r.stability.method, r.seconds});
  return t.take();
}

data::Table iteration_rows(int state, const fem::StepRecord& record) {
  TableBuilder t("Iterations");
  t.number("state", "1")
      .number("iteration", "1")
      .text("kind")
      .text("note")
      .number("residual_N", "N")
      .number("relative_residual", "1")
      .number("step_norm", "1")
      .number("energy_norm", "1")
      .number("line_search", "1")
      .number("smallest_J", "1")
      .number("smallest_J_cell", "1");
  for (const fem::IterationRecord& i : record.iterations)
    t.row({static_cast<double>(state), static_cast<double>(i.iteration), i.kind, i.note, i.residual_norm,
           i.relative_residual, i.step_norm, i.energy_norm, i.line_search, i.worst_jacobian,
           static_cast<double>(i.worst_cell)});
  return t.take();
}

/// What a solve was made from, but for how it is solved: other tolerances may go on from the same states.
std::string problem_digest(const StageContext& context) {
  Fingerprint parts = context.made_from;
  for (const std::string key : {"option.solver", "option.save_fields", "failed", "trials"}) parts.erase(key);
  return digest(parts);
}

/// Phases follow each other, each of length 1: 1.5 is the middle of the second.
double programme_time(const fem::Problem& problem, const fem::StepRecord& record) {
  const auto phase = std::find_if(problem.programme.begin(), problem.programme.end(),
                                  [&](const fem::Phase& p) { return p.name == record.phase; });
  return static_cast<double>(phase - problem.programme.begin()) + record.phase_time;
}

/// Where there are no fibres, what is said of fibres has no value.
fem::PointFields known_fields(fem::PointFields fields) {
  for (Eigen::Index k = 0; k < fields.fibre.cols(); ++k) {
    if (fields.fibre.col(k).squaredNorm() > 0.0) continue;
    fields.fibre_stretch[k] = fields.fibre_stress_pa[k] = fields.active_stress_pa[k] = std::nan("");
  }
  return fields;
}

data::Table figures(const fem::Summary& s, const fem::Problem& problem) {
  TableBuilder t("The solve");
  t.number("cells", "1")
      .number("points", "1")
      .number("unknowns", "1")
      .number("states", "1")
      .number("newton_iterations", "1")
      .number("chord_iterations", "1")
      .number("factorisations", "1")
      .number("augmentations", "1")
      .number("relaxation_steps", "1")
      .number("factor_nonzeros", "1")
      .number("factor_flops", "1")
      .number("assembly_s", "s")
      .number("analyse_s", "s")
      .number("factor_s", "s")
      .number("solve_s", "s")
      .number("total_s", "s");
  t.row({static_cast<double>(problem.mesh->cell_count()), static_cast<double>(problem.mesh->point_count()),
         static_cast<double>(s.unknowns), static_cast<double>(s.steps.size()),
         static_cast<double>(s.newton_iterations), static_cast<double>(s.chord_iterations),
         static_cast<double>(s.factorisations), static_cast<double>(s.augmentations),
         static_cast<double>(s.relaxation_steps), s.factor_nonzeros, s.factor_flops, s.assembly_seconds,
         s.analyse_seconds, s.factor_seconds, s.solve_seconds, s.total_seconds});
  return t.take();
}

/// The line a reader remembers.
void say_verdict(const fem::Problem& problem, StageOutput& out) {
  const data::Table& steps = out.tables.at("steps");
  long unstable = 0;
  for (const std::string& verdict : steps.texts("stability")) unstable += verdict == "unstable";
  std::string text = fmt::format("{} states of {} phases solved", steps.rows(), problem.programme.size());
  const data::Table& quantities = out.tables.at("quantities");
  for (const data::Column& column : quantities.columns) {
    if (!column.name.ends_with("_N") || column.name.ends_with("_x_N") || column.name.ends_with("_y_N") ||
        column.name.ends_with("_z_N"))
      continue;
    const std::string name = column.name.substr(0, column.name.size() - 2);
    const std::vector<double>& force = quantities.numbers(column.name);
    const auto most = static_cast<std::size_t>(std::max_element(force.begin(), force.end()) - force.begin());
    text += fmt::format("; force at {} up to {} (in `{}`)", report::in_words(name),
                        report::quantity(force[most], "N"), quantities.texts("phase")[most]);
    break;
  }
  out.attributes["verdict"] = unstable > 0 ? fmt::format("{}; {} of them UNSTABLE", text, unstable) : text;
  out.attributes["verdict_tone"] = unstable > 0 ? "warning" : "good";
}

/// Statistics of the fibre field, region by region.
void say_fibres(const data::Table& f, const StageContext& context) {
  if (!context.say) return;
  for (std::size_t k = 0; k < f.rows(); ++k)
    context.say(fmt::format(
        "fibres of `{}`: mean direction ({:.3g}, {:.3g}, {:.3g}), angles to it {:.3g} to {:.3g} deg, rms "
        "{:.3g}",
        f.texts("region")[k], f.numbers("mean_x")[k], f.numbers("mean_y")[k], f.numbers("mean_z")[k],
        f.numbers("angle_min_deg")[k], f.numbers("angle_max_deg")[k], f.numbers("angle_rms_deg")[k]));
}

void run(const StageContext& context, StageOutput& out) {
  const Options& options = *context.options;
  if (context.progress) context.progress(0.0, "problem");
  const FemProblem built = build_fem_problem(options);
  const fem::Problem& problem = built.problem;
  const data::Mesh& mesh = *problem.mesh;
  const fem::Discretisation discretisation(problem.mesh, problem.formulation);
  say_fibres(built.directions, context);
  const FemQuantities quantities(options, problem, discretisation);
  const FemSurface surface(mesh);
  const std::string save = context.beside.empty() ? std::string("none") : options.text("save_fields");
  FemCheckpoints checkpoints(context.beside.empty()
                                 ? std::filesystem::path()
                                 : std::filesystem::path(context.beside.string() + ".restart"),
                             problem_digest(context));

  std::map<std::string, data::Table> rows;
  int states = 0;
  for (const FemTables& earlier : checkpoints.rows()) {
    for (const auto& [name, table] : earlier) append_rows(rows[name], table);
    ++states;
  }
  if (checkpoints.last()) {
    const std::string where =
        fmt::format("phase `{}`, {:.4g} of it",
                    problem.programme.at(static_cast<std::size_t>(checkpoints.last()->phase)).name,
                    checkpoints.last()->phase_time);
    out.note("restarted",
             fmt::format("went on from the last state of an earlier run: {} states were there, up to {}",
                         states, where));
    if (context.say) context.say(fmt::format("goes on from state {} of an earlier run, {}", states, where));
  }
  const auto observe = [&](const fem::AcceptedState& accepted) {
    ++states;
    const fem::PointFields at_quadrature =
        known_fields(fem::point_fields(problem, discretisation, accepted.state.configuration));
    const auto at_points = fields_at_points(problem, discretisation, at_quadrature);
    FemTables added;
    added["quantities"] = quantities.row(states, accepted, at_quadrature);
    added["steps"] = step_row(states, accepted.record);
    added["iterations"] = iteration_rows(states, accepted.record);
    added["surface_states"] = surface.state(states, accepted.state.configuration, at_points);
    if (wants_fields(save, accepted.record))
      added["fields"] =
          field_rows(programme_time(problem, accepted.record), mesh, accepted.state.configuration, at_points);
    checkpoints.keep(accepted.state, added);
    for (const auto& [name, table] : added) append_rows(rows[name], table);
  };
  const auto progress = [&](double fraction, const std::string& what) {
    if (context.progress) context.progress(fraction, what);
  };
  const fem::Summary summary = fem::solve(problem, solve_options(options, context.threads), observe, progress,
                                          checkpoints.last() ? &*checkpoints.last() : nullptr);

  out.diagnostics.insert(out.diagnostics.end(), built.notes.begin(), built.notes.end());
  out.diagnostics.insert(out.diagnostics.end(), summary.diagnostics.begin(), summary.diagnostics.end());
  out.tables = std::move(rows);
  if (!summary.completed && !summary.failed.iterations.empty())
    append_rows(out.tables["iterations"], iteration_rows(states + 1, summary.failed));
  out.tables["solve"] = figures(summary, problem);
  out.tables["mesh_quality"] = built.quality;
  out.tables["materials"] = built.materials;
  if (built.directions.rows() > 0) out.tables["fibres"] = built.directions;
  for (auto& [name, table] : surface.tables()) out.tables[name] = std::move(table);
  out.attributes["mesh"] = built.mesh_source;
  out.attributes["cell_type"] = data::to_string(mesh.type);
  out.attributes["regions"] = fmt::format("{}", fmt::join(mesh.regions, "\n"));
  out.attributes["completed"] = summary.completed ? "yes" : "no";
  if (const auto fields = out.tables.find("fields"); fields != out.tables.end()) {
    out.files = write_fields(context.beside, save, mesh, fields->second);
    out.tables.erase(fields);
  }
  if (summary.completed) {
    say_verdict(problem, out);
    checkpoints.remove();
    return;
  }
  out.attributes["failure"] = summary.reason;
  out.failure = states == 0 ? fmt::format("no state was reached: {}", summary.reason)
                            : fmt::format(
                                  "{}; the last of {} converged states is kept, and a run with other solver "
                                  "options goes on from it",
                                  summary.reason, states);
}

}  // namespace

void add_fem_stages(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "fem.solve";
  spec.summary = "a quasi-static boundary-value problem of muscle and tendon tissue at finite strain";
  spec.doc =
      "Any body (a mesh file or a generator), a material for every named region, a fibre field, conditions "
      "on named surfaces, and a load programme of phases "
      "(stretch, then activate, then release). Incompressible tissue exactly, or by a bulk modulus. Newton's "
      "method with a consistent tangent and adaptive steps; "
      "the stability of every accepted state is tested, and unstable equilibria are reported as such.\n"
      "Every mistake of the definition is reported at once, before anything is solved. Each accepted state "
      "is kept, so that a solve that was killed or that failed "
      "goes on from the last one when the same stage runs again. Leaves tables (quantities, steps, "
      "iterations, the surface by state), and the fields of states for ParaView.\n"
      "Sources: Holzapfel 2000, Nonlinear Solid Mechanics, ISBN 978-0-471-82319-3; Simo, Taylor & Pister "
      "1985, doi:10.1016/0045-7825(85)90033-7 (condensed pressure); "
      "Simo & Taylor 1991, doi:10.1016/0045-7825(91)90100-K (augmented Lagrange).";
  spec.options = fem_option_specs();
  spec.output = PortType::tables;
  spec.run = run;
  spec.check = [](const CheckContext& context) -> std::vector<data::Diagnostic> {
    try {
      build_fem_problem(*context.options);
      return {};
    } catch (const data::InputError& e) {
      return e.diagnostics();
    }
  };
  spec.report = fem_chapter;
  spec.methods = fem_methods;
  catalogue.add(std::move(spec));
  add_muscle_map_stage(catalogue);
  add_upper_limb_stage(catalogue);
}

}  // namespace brachium::pipelines
