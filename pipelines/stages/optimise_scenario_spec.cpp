/// What optimise.scenario is asked with.

#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "pipelines/stages/optimise_common.hpp"
#include "pipelines/stages/optimise_scenario.hpp"

namespace brachium::pipelines {
namespace {

OptionSpec numbers_of(std::string key, std::string unit, std::string doc, Bounds bounds = {}) {
  OptionSpec spec = number_option(std::move(key), std::move(unit), 0.0, bounds, std::move(doc));
  spec.type = OptionType::numbers;
  spec.fallback.reset();
  return spec;
}

OptionSpec tables_of(std::string key, std::vector<OptionSpec> fields, std::string doc) {
  OptionSpec spec;
  spec.key = std::move(key);
  spec.type = OptionType::tables;
  spec.doc = std::move(doc);
  spec.fields = std::move(fields);
  spec.fallback = std::vector<Options>{};
  return spec;
}

OptionSpec required(OptionSpec spec) {
  spec.fallback.reset();
  return spec;
}

}  // namespace

void add_optimise_scenario(Catalogue& catalogue) {
  StageSpec spec;
  spec.name = "optimise.scenario";
  spec.summary =
      "static equilibrium of a joint with given or mapped muscle forces: angles, activations, load histories";
  spec.doc =
      "The equivalent static system of a joint: muscle forces over angle and activation and their lever arms "
      "are given "
      "as tables and polynomials of the angle, or come from muscle maps, and a load acts on the forearm. "
      "With several "
      "maps or lever arms the same questions are asked of each system, and answers stand side by side. "
      "Three questions are asked of it. Activation-driven (`equilibrium`): all angles at which given "
      "activations hold a load, with their stability. Position-driven (`position`, over time `motion`): the "
      "activation "
      "of one muscle that holds an angle. Force-driven (`history`): where a load history takes the joint, "
      "along stable branches, with jumps where one ends. That there is no solution in range is a "
      "result, with the nearest there is. Derivatives come from the implicit function theorem; iterations "
      "stop where the moment is below `relative_tolerance` times the sum of all moments' sizes.\n"
      "Flexion is positive in all results; a load above 0 extends. Source of the system and its scenarios: "
      "Valentin 2019, doi:10.18419/opus-10504, ch. 7.";
  spec.output = PortType::tables;
  OptionSpec activation = numbers_of("activation", "", "of every muscle, in their order", between(0, 1));
  OptionSpec of_table = numbers_of("activation", "", "activations of the force table", between(0, 1));
  of_table.fallback = std::vector<double>{0.0, 1.0};
  OptionSpec starts = numbers_of("start_deg", "deg",
                                 "starts of Newton's method whose iterations are shown (the published ones)");
  starts.fallback = std::vector<double>{80.0, 40.0, 120.0};
  const OptionSpec name = text_option("name", "", "name of the case; its number where absent");
  const OptionSpec load = number_option("load_N", "N", 0.0, {}, "load on the forearm, above 0 extends");
  OptionSpec loads = numbers_of("load_N", "N", "load at these times, or one at all of them");
  loads.fallback = std::vector<double>{0.0};
  OptionSpec arms = texts_option("lever_arm", {"virtual_work"}, "of the maps' muscles, one system each");
  arms.allowed = moment_methods();
  spec.inputs = {{"map", PortType::tables, "muscle maps instead of `muscle` (fem.muscle_map)", true, true}};
  spec.options = {
      tables_of(
          "muscle",
          {required(text_option("name", "", "name of the muscle")),
           required(
               choice_option("action", "flexor", {"flexor", "extensor"}, "which way it turns the joint")),
           numbers_of("angle_deg", "deg", "angles of the force table, at least 2"), of_table,
           numbers_of("force_N", "N", "tensions: at all angles for the first activation, then for the next"),
           numbers_of("lever_arm_mm", "mm",
                      "coefficients of the lever arm, l = c0 + c1 theta + c2 theta^2 + ..., theta in "
                      "degrees; above 0")},
          "the muscles, where no map is wired"),
      arms,
      choice_option("force_curve", "monotone", {"monotone", "cubic", "linear"},
                    "interpolation over the angle; over the activation linear, cubic from 3 activations on"),
      optional_number("load_arm_mm", "mm", above(0),
                      "distance of the load from the joint: its lever arm is this times the sine of the "
                      "angle; absent: that of the "
                      "maps' limb"),
      optional_number("lower_deg", "deg", {}, "range of angles; absent: that of the tables"),
      optional_number("upper_deg", "deg", {}, "range of angles; absent: that of the tables"),
      tables_of("equilibrium", {name, activation, load}, "activation-driven cases"),
      starts,
      tables_of("position",
                {name, required(number_option("angle_deg", "deg", 0.0, {}, "angle to be held")),
                 required(text_option("sought", "", "muscle whose activation is sought")), activation, load},
                "position-driven cases"),
      tables_of(
          "motion",
          {name, numbers_of("time_s", "s", "times of the knots"),
           numbers_of("angle_deg", "deg", "angle to be held at these times, linear in between"),
           required(text_option("sought", "", "muscle whose activation is sought")),
           numbers_of(
               "activation", "",
               "one for each muscle, or for each muscle one at every time; where the muscle sought begins",
               between(0, 1)),
           loads, integer_option("frames", 51, between(2, 1e6), "times that are computed")},
          "position-driven cases over time"),
      tables_of("history",
                {name, numbers_of("time_s", "s", "times of the load's knots"),
                 numbers_of("load_N", "N", "load at these times, linear in between"),
                 numbers_of("activation", "", "one for each muscle, or for each muscle one at every time",
                            between(0, 1)),
                 number_option("start_deg", "deg", 80.0, {}, "angle at the beginning"),
                 integer_option("frames", 201, between(2, 1e6), "times that are computed")},
                "force-driven cases"),
      number_option("relative_tolerance", "", 1e-6, above(0),
                    "of the moment, in the sum of the sizes of all moments")};
  spec.run = run_scenarios;
  spec.report = fill_scenario_report;
  spec.methods = scenario_methods;
  catalogue.add(std::move(spec));
}

}  // namespace brachium::pipelines
