#pragma once
/// The parts of optimise.scenario: what it does, and its report.

#include <string>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void run_scenarios(const StageContext& context, StageOutput& out);
void fill_scenario_report(const ReportContext& context, report::Section& section);
std::string scenario_methods(const ReportContext& context);

}  // namespace brachium::pipelines
