#pragma once
/// The report of optimise.scenario.

#include <string>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void fill_scenario_report(const ReportContext& context, report::Section& section);
std::string scenario_methods(const ReportContext& context);

}  // namespace brachium::pipelines
