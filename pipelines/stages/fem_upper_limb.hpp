#pragma once
/// The parts of fem.upper_limb: what it does, and its report.

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void add_upper_limb_stage(Catalogue& catalogue);
void fill_upper_limb_report(const ReportContext& context, report::Section& section);
std::string upper_limb_methods(const ReportContext& context);

}  // namespace brachium::pipelines
