/// The report's chapter of fem.upper_limb.

#include <fmt/format.h>

#include "pipelines/stages/common.hpp"
#include "pipelines/stages/fem_limb_map.hpp"
#include "pipelines/stages/fem_upper_limb.hpp"

namespace brachium::pipelines {

void fill_upper_limb_report(const ReportContext& context, report::Section& section) {
  const StageData& output = *context.output;
  section.title += ": continuum muscles over the trials";
  section.blocks.push_back(
      report::Paragraph{fmt::format("Forces and moments by {}; moments by {}.", output.attributes.at("rung"),
                                    moment_method_words(context.options->text("lever_arm")))});
  section.blocks.push_back(report::make_grid(output.tables.at("groups")));
  std::vector<std::string> trials;
  for (const data::TrialInfo& t : output.signals->info().trials) trials.push_back(t.name);
  section.blocks.push_back(trial_plots(*output.signals, trials, data::Quantity::activation, "activation"));
  section.blocks.push_back(trial_plots(*output.signals, trials, data::Quantity::muscle_force, "force"));
  section.blocks.push_back(trial_plots(*output.signals, trials, data::Quantity::joint_moment, "moment"));
  report::Section folded;
  folded.blocks.push_back(
      trial_plots(*output.signals, trials, data::Quantity::moment_arm, "lever arm", "mm"));
  report::GridOptions grid;
  grid.digits = 3;
  grid.units = {{"mean_arm_m", "mm"}};
  folded.blocks.push_back(report::make_grid(output.tables.at("muscles"), grid));
  section.blocks.push_back(report::Details{"lever arms, and figures of every muscle and trial", {folded}});
}

std::string upper_limb_methods(const ReportContext& context) {
  return fmt::format(
      "Continuum muscles were driven by the strength-weighted mean activations of the lumped muscles they "
      "stand for, at the "
      "recorded joint angles, quasi-statically (no force-velocity relation); moments by {}.",
      moment_method_words(context.options->text("lever_arm")));
}

}  // namespace brachium::pipelines
