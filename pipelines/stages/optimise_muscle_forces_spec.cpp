/// What optimise.muscle_forces is asked with, and how it shows its result.

#include <fmt/format.h>

#include "pipelines/report/text.hpp"
#include "pipelines/stages/calibration_options.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"
#include "pipelines/stages/muscle_force_references.hpp"
#include "pipelines/stages/muscle_moment_references.hpp"
#include "pipelines/stages/optimise_muscle_forces.hpp"

namespace brachium::pipelines {
namespace {

/// Reference and continuum over the angle, one plot a muscle, at the activations that lists are given for.
report::PlotRow state_plots(const data::Table& forces, const std::string& axis, const std::string& ending) {
  report::PlotRow row;
  row.min_width_px = 420.0;
  const auto &muscle = forces.texts("muscle"), &set = forces.texts("set");
  std::vector<std::pair<std::string, std::string>> drawn;
  for (std::size_t i = 0; i < forces.rows(); ++i) {
    if (drawn.empty() || drawn.back().first != muscle[i])
      row.plots.push_back({muscle[i], "angle [deg]", axis});
    if (drawn.empty() || drawn.back() != std::pair(muscle[i], set[i])) {
      row.plots.back().series.push_back({set[i] + ", reference", {}, {}, report::Style::points});
      row.plots.back().series.push_back({set[i] + ", continuum", {}, {}, report::Style::points});
      drawn.emplace_back(muscle[i], set[i]);
    }
    auto& series = row.plots.back().series;
    report::Series &reference = series[series.size() - 2], &model = series.back();
    reference.x.push_back(forces.numbers("angle_deg")[i]);
    reference.y.push_back(forces.numbers("reference" + ending)[i]);
    model.x.push_back(forces.numbers("angle_deg")[i]);
    model.y.push_back(forces.numbers("continuum" + ending)[i]);
  }
  return row;
}

std::vector<OptionSpec> own_options() {
  return {
      texts_option("muscles", {}, "names or patterns; absent: all of the limb"),
      reference_option(),
      list_option("free",
                  {required_text("parameter", "name (fem/limb/body_parameters.hpp)"),
                   optional_text("muscle", "absent: of every muscle, each its own"),
                   optional_number("start", "SI", {}, "absent: the limb's"),
                   optional_number("lower", "SI", {}, "absent: what a muscle may plausibly be"),
                   optional_number("upper", "SI", {}, "absent: what a muscle may plausibly be")},
                  "parameters to fit"),
      list_option("hold",
                  {required_text("parameter", "name"), optional_text("muscle", "absent: of every muscle"),
                   required_number("value", "SI", {}, "instead of the limb's")},
                  "parameters that are held at a value"),
      choice_option("begin_at", "strap", {"strap", "limb"},
                    "where the continuum's fit begins: at the strap's result, or at the limb's values"),
      flag_option("geometry_alone", false,
                  "fit the continuum's geometry with the limb's law too, where parameters of the law are "
                  "free: shown beside"),
      choice_option("optimiser", "levenberg_marquardt", optimise::solver_names(),
                    "of the continuum's fit: own or GSL's Levenberg-Marquardt, or one of NLopt's"),
      integer_option("max_evaluations", 400, between(1, 1000000),
                     "of all states by the continuum: what bounds NLopt's solvers"),
      integer_option("strap_starts", 8, between(1, 1000), "starts of the strap's fit, between the bounds"),
      integer_option("max_iterations", 12, between(1, 200), "of the continuum's fit"),
      number_option("cost_tolerance", "1", 1e-4, above(0), "relative decrease below which it has converged")};
}

std::string methods(const ReportContext& context) {
  return "Parameters of the continuum muscles were fitted to reference forces or moments by " +
         report::in_words(context.output->attributes.at("solver")) +
         " between bounds, each set weighted by its own size; every state was solved for every trial of "
         "parameters. "
         "Intervals are 95 %, from the Jacobian and autocorrelated residuals.";
}

}  // namespace

void fill_muscle_forces_report(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  section.title += ": continuum muscles fitted to forces";
  report::GridOptions agreement;
  agreement.digits = 3;
  section.blocks.push_back(report::make_grid(output.tables.at("agreement"), agreement));
  report::Grid verdicts = verdict_grid(output.tables.at("verdicts"));
  verdicts.caption = "Parameters of the continuum";
  section.blocks.push_back(std::move(verdicts));
  if (output.tables.at("forces").rows() > 0)
    section.blocks.push_back(state_plots(output.tables.at("forces"), "force [N]", "_N"));
  if (output.tables.contains("moments"))
    section.blocks.push_back(state_plots(output.tables.at("moments"), "moment [N m]", "_N_m"));
  if (output.tables.at("strap_verdicts").rows() > 0) {
    report::Details strap{"The one-dimensional strap beside it", {{}}};
    report::Grid grid = verdict_grid(output.tables.at("strap_verdicts"));
    grid.caption = "Parameters of the strap";
    strap.content.front().blocks.push_back(std::move(grid));
    section.blocks.push_back(std::move(strap));
  }
}

void add_optimise_muscle_forces(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "optimise.muscle_forces";
  spec.summary = "named parameters of continuum muscles from forces at angles and activations";
  spec.doc =
      "Fits geometry, pre-stretch (which sets the rigid tendon's slack) and material of each continuum "
      "muscle of "
      "a limb "
      "to reference forces or moments, every state solved anew for every trial. They are listed, columns of "
      "a file, or the moments of "
      "the lumped muscles that a continuum muscle stands for (input `moments` with `activation`, "
      "`kinematics` and a limb "
      "scaled by `scale_to`). Sets (passive, maximal, samples) "
      "count "
      "alike whatever their size; agreement is told set by set. A one-dimensional strap with the same law is "
      "fitted first and shown beside, with all of these parameters free and with the geometry's alone: what "
      "the "
      "continuum has to earn its cost against. Every parameter gets a "
      "verdict: "
      "identified with its 95 % interval, at a bound, or not identified. A stage fem.muscle_map takes the "
      "result "
      "as its "
      "input `fitted`.";
  spec.output = PortType::tables;
  spec.inputs = {
      {"subject", PortType::subject, "calibrated subject that the limb is scaled to", true},
      {"moments", PortType::signals,
       "forces and moment arms of a subject's muscles (hill.moment), to be fitted", true},
      {"activation", PortType::signals, "activations by muscle that belong to `moments`", true},
      {"kinematics", PortType::signals, "joint angle that belongs to `moments` (limb.kinematics)", true}};
  spec.options = limb_option_specs();
  for (OptionSpec& o : moment_reference_options()) spec.options.push_back(std::move(o));
  for (OptionSpec& o : own_options()) spec.options.push_back(std::move(o));
  spec.run = run_muscle_forces;
  spec.check = check_muscle_forces;
  spec.report = fill_muscle_forces_report;
  spec.methods = methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
