#pragma once
/// A run as a report: verdict, findings, chain, each stage's chapter, methods, provenance.

#include <map>
#include <string>

#include "pipelines/report/document.hpp"
#include "pipelines/runner.hpp"

namespace brachium::pipelines {

/// Outputs of the stages that have one, by stage name; "session" for the recordings.
using RunData = std::map<std::string, StageData>;

/// The verdict of the last stage (in the order of the run) that states one in its attribute `verdict`.
std::string verdict_of(const RunResult& result, const RunData& data);

report::Document assemble_report(const RunResult& result, const RunData& data);

}  // namespace brachium::pipelines
