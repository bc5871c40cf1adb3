/// Options that say which continuum limb is meant, and the limb they make.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fem/surrogate/sparse_grid.hpp"
#include "pipelines/stages/fem_muscle_map.hpp"
#include "pipelines/stages/fem_option_kinds.hpp"
#include "pipelines/stages/fem_options.hpp"
#include "pipelines/stages/limb_fitted.hpp"
#include "pipelines/stages/model_options.hpp"

namespace brachium::pipelines {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

fem::LimbMesh mesh_of(const Options& options) {
  fem::LimbMesh mesh;
  if (const Options* o = options.maybe_table("mesh")) {
    mesh.belly_cells = static_cast<int>(o->integer("belly_cells"));
    mesh.core_cells = static_cast<int>(o->integer("core_cells"));
    mesh.ring_cells = static_cast<int>(o->integer("ring_cells"));
  }
  return mesh;
}

/// Parameters by muscle's name, "*" for all.
void change(const std::map<std::string, double>& values, LimbScene& limb, const std::string& what,
            double& (*of)(fem::MuscleBody&)) {
  if (const auto all = values.find("*"); all != values.end()) {
    for (LimbMuscle& m : limb.muscles) of(m.body) = all->second;
  }
  for (const auto& [name, value] : values) {
    if (name == "*") continue;
    limb.muscle(name);  // throws where there is none
    for (LimbMuscle& m : limb.muscles) {
      if (m.body.name != name) continue;
      of(m.body) = value;
      try {
        fem::check(m.body, limb.range);
      } catch (const data::InputError& e) {
        throw data::InputError(
            e.diagnostics().front().code,
            fmt::format("`{}` of muscle `{}`: {}", what, name, e.diagnostics().front().message),
            e.diagnostics().front().help);
      }
    }
  }
}

std::vector<fem::StatePoint> listed_states(const Options& options) {
  const std::vector<double>&angles = options.numbers("angle_deg"),
        &activations = options.numbers("activation");
  std::vector<fem::StatePoint> states;
  for (const double angle : angles) {
    for (const double a : activations) states.push_back({angle * degree, a});
  }
  return states;
}

}  // namespace

std::vector<OptionSpec> limb_option_specs() {
  OptionSpec limb = required_text("limb", "the limb: bones, hinge, muscles (pipelines/README.md, `A limb`)");
  limb.is_file = true;
  limb.files_within = files_of_limb;
  const fem::LimbMesh d;
  const fem::SolvedMuscleOptions s;
  return {limb,
          choice_option("variant", "rigid_tendon", {"rigid_tendon", "mtc"},
                        "tendons inextensible, or meshed (muscle-tendon complex)"),
          table_option("mesh",
                       {integer_option("belly_cells", d.belly_cells, between(2, 200), "along the belly"),
                        integer_option("core_cells", d.core_cells, between(1, 20),
                                       "on a side of the core of the cross-section"),
                        integer_option("ring_cells", d.ring_cells, between(1, 20), "rings around the core")},
                       "how finely muscles are meshed"),
          choice_option(
              "scale_to", "none", {"none", "subject"},
              "`subject`: all lengths by the excursion of the scene's muscle paths over that of the limb's "
              "tendon paths, and strength as `strength` says"),
          choice_option(
              "strength", "max_stress", {"max_stress", "cross_section", "none"},
              "where the limb is scaled: which parameter takes a group's strength times maximal isometric "
              "force over the mean cross-section of the belly"),
          map_option("pre_stretch", above(0), "by muscle, instead of the limb's"),
          map_option("max_stress_Pa", above(0), "by muscle, instead of the limb's or the scaled one"),
          group_option(),
          number_option("contact_tolerance_m", "m", s.contact_tolerance_m, at_least(0),
                        "greatest penetration of a bone, by multipliers; 0: what the penalty leaves"),
          number_option("step_deg", "deg", 11.5, above(0), "load steps to begin with, of the angle"),
          number_option("step_activation", "1", s.step_activation, above(0), "load steps to begin with"),
          solver_option()};
}

LimbScene limb_of_options(const Options& options) {
  return read_limb(options.text("limb"), parse_limb_variant(options.text("variant")), mesh_of(options));
}

Grouping group_muscles(const StageContext& context, const std::vector<std::string>& muscles) {
  const data::Scene& scene = context.need_scene();
  const StageData* with = context.maybe_input("subject");
  return group_muscles(*context.options, scene,
                       coordinate_of(scene, context.options->maybe_text("coordinate").value_or("")),
                       with ? &subject_of(*with) : nullptr, muscles);
}

void make_stress_free(PreparedLimb& limb, const std::vector<std::string>& muscles,
                      const StageContext& context) {
  for (LimbMuscle& m : limb.scene.muscles) {
    if (std::find(muscles.begin(), muscles.end(), m.body.name) == muscles.end()) continue;
    const std::optional<std::string> line = make_stress_free(m, limb.scene, limb.solving);
    if (!line) continue;
    limb.log.push_back(*line);
    if (context.say) context.say(*line);
  }
}

PreparedLimb prepare_limb(const StageContext& context) {
  const Options& options = *context.options;
  PreparedLimb out;
  out.scene = limb_of_options(options);
  if (options.text("scale_to") == "subject") {
    const data::Scene& scene = context.need_scene();
    const data::Coordinate& coordinate = coordinate_of(scene, options.maybe_text("coordinate").value_or(""));
    out.grouping = group_muscles(context, out.scene.muscle_names());
    out.scaling = scale_limb(out.scene, *out.grouping, scene, coordinate, options.text("strength"));
  }
  if (const StageData* fitted = context.maybe_input("fitted")) apply_fitted(*fitted, out.scene);
  change(options.number_map("pre_stretch"), out.scene, "pre_stretch",
         [](fem::MuscleBody& b) -> double& { return b.pre_stretch; });
  change(options.number_map("max_stress_Pa"), out.scene, "max_stress_Pa",
         [](fem::MuscleBody& b) -> double& { return b.material.max_stress_pa; });
  out.solving.solve = solve_options(options, 1);
  out.solving.step_rad = options.number("step_deg") * degree;
  out.solving.step_activation = options.number("step_activation");
  out.solving.contact_tolerance_m = options.number("contact_tolerance_m");
  return out;
}

std::vector<fem::StatePoint> asked_states(const Options& options, const fem::AngleRange& range) {
  const bool grid = !options.numbers("angle_deg").empty() || !options.numbers("activation").empty();
  const bool sparse = options.maybe_number("sparse_level").has_value();
  const std::vector<Options>& listed = options.tables("state");
  if (int(grid) + int(sparse) + int(!listed.empty()) != 1)
    throw data::InputError(
        "contradiction",
        "a muscle map takes one of `angle_deg` with `activation`, `sparse_level`, and `state`",
        "say which states are to be solved");
  if (grid) {
    if (options.numbers("angle_deg").empty() || options.numbers("activation").empty())
      throw data::InputError("missing-key", "`angle_deg` and `activation` belong together",
                             "a grid needs both");
    return listed_states(options);
  }
  std::vector<fem::StatePoint> states;
  for (const Options& o : listed) states.push_back({o.number("angle_deg") * degree, o.number("activation")});
  if (!sparse) return states;
  const fem::StateBounds bounds{range.lower_rad, range.upper_rad, 0.0, 1.0};
  const auto boundary = options.text("surrogate") == "sparse_modified" ? fem::SparseBoundary::modified
                                                                       : fem::SparseBoundary::included;
  const fem::SparseGrid points =
      fem::SparseGrid::regular(boundary, static_cast<int>(*options.maybe_number("sparse_level")));
  for (const fem::SparseIndex& p : points.points()) states.push_back(fem::state_of(p, bounds));
  return states;
}

}  // namespace brachium::pipelines
