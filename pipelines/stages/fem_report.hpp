#pragma once
/// Chapter and methods text of fem.solve.

#include <string>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void fem_chapter(const ReportContext& context, report::Section& section);
std::string fem_methods(const ReportContext& context);

}  // namespace brachium::pipelines
