#pragma once
/// The report of pipelines.compare.

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void fill_compare_report(const ReportContext& context, report::Section& section);
std::string compare_methods(const ReportContext& context);

}  // namespace brachium::pipelines
