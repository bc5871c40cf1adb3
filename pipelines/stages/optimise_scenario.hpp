#pragma once
/// The parts of optimise.scenario: what it does, and its report.

#include <memory>
#include <string>
#include <vector>

#include "fem/surrogate/surrogate_model.hpp"
#include "optimise/scenario.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// One equivalent static system: "given forces", or a map and a lever arm, "rigid_tendon: virtual work".
struct ScenarioSystem {
  std::string name;
  std::shared_ptr<const fem::SurrogateModel> model;
  optimise::StaticSystem system;  ///< refers to the model
};

/// Throws InputError: "contradiction" or "missing-key" where not exactly one of `muscle` and the input `map` is given.
std::vector<ScenarioSystem> scenario_systems(const StageContext& context);

void run_scenarios(const StageContext& context, StageOutput& out);
void fill_scenario_report(const ReportContext& context, report::Section& section);
std::string scenario_methods(const ReportContext& context);

}  // namespace brachium::pipelines
