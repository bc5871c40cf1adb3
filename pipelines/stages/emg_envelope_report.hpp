#pragma once
/// The report's part of emg.envelope (emg_envelope.cpp): reads the tables and signals that the stage wrote.

#include <string>

#include "pipelines/report/build.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void fill_envelope_report(const ReportContext& context, report::Section& section);
std::string envelope_methods(const ReportContext& context);

}  // namespace brachium::pipelines
