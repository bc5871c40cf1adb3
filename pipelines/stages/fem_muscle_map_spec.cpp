/// What fem.muscle_map is asked with.

#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"

namespace brachium::pipelines {
namespace {

OptionSpec list_of_numbers(std::string key, std::string unit, std::vector<double> fallback, Bounds bounds,
                           std::string doc) {
  OptionSpec spec = number_option(std::move(key), std::move(unit), 0.0, bounds, std::move(doc));
  spec.type = OptionType::numbers;
  spec.fallback = std::move(fallback);
  return spec;
}

}  // namespace

void add_muscle_map_stage(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "fem.muscle_map";
  spec.summary = "continuum muscles of a limb over angle and activation, and surrogates of them";
  spec.doc =
      "Solves each muscle of a limb (bones, hinge, parametric muscles; a TOML file) at many joint angles and "
      "activations: force, moment by virtual work, lever arms by tendon displacement (TDM), by the resultant "
      "(VRLA) and "
      "by its line of action (VRLA+), wrench, contact force and pressure, distribution of fibre stretch, "
      "stability. "
      "States are asked for as a grid (`angle_deg` with `activation`), as a regular sparse grid "
      "(`sparse_level`), or one "
      "by one (`state`); the passive states at their angles are added, since their lengths give the TDM "
      "lever arms.\n"
      "Muscles and rays of states are solved in parallel, each from its nearest known state. Every solved "
      "state is kept, "
      "so that a run that was stopped goes on, and a grid that grew solves only what is new. States that "
      "failed or are "
      "unstable are named, and no surrogate is made over them. Contact is built only with the bones that a "
      "muscle can "
      "reach: the log and the table `muscles` say which.\n"
      "Sources: Valentin 2019, doi:10.18419/opus-10504, ch. 7; An et al. 1984, doi:10.1115/1.3138494 (TDM).";
  spec.output = PortType::tables;
  spec.inputs = {{"subject", PortType::subject, "calibrated subject that the limb is scaled to", true},
                 {"fitted", PortType::tables, "parameters from optimise.muscle_forces", true}};
  spec.options = limb_option_specs();
  const std::vector<OptionSpec> own{
      texts_option("muscles", {}, "names or patterns; absent: all of the limb"),
      list_of_numbers("angle_deg", "deg", {}, {}, "angles of the grid"),
      list_of_numbers("activation", "1", {}, between(0, 1), "activations of the grid"),
      optional_number("sparse_level", "1", between(1, 6),
                      "level of a regular sparse grid over the limb's whole range"),
      list_option("state",
                  {required_number("angle_deg", "deg", {}, "joint angle"),
                   required_number("activation", "1", between(0, 1), "of the muscle")},
                  "states one by one"),
      choice_option(
          "surrogate", "hermite",
          {"hermite", "cubic", "quintic", "sparse_included", "sparse_modified", "none"},
          "Hermite interpolation by the exact slopes of force and moment, splines through a grid, or "
          "sparse-grid splines with or without states on the boundary"),
      list_of_numbers("show_activation", "1", {0.0, 1.0}, between(0, 1),
                      "activations whose states are drawn in the report's 3D view"),
      optional_text("coordinate", "joint coordinate of the scene, where the limb is scaled to a subject")};
  spec.options.insert(spec.options.end(), own.begin(), own.end());
  spec.run = run_muscle_map;
  spec.check = check_muscle_map;
  spec.report = fill_muscle_map_report;
  spec.methods = muscle_map_methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
