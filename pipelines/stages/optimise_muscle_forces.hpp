#pragma once
/// The parts of optimise.muscle_forces.

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void add_optimise_muscle_forces(Catalogue& catalogue);
std::vector<data::Diagnostic> check_muscle_forces(const CheckContext& context);
void run_muscle_forces(const StageContext& context, StageOutput& out);
void fill_muscle_forces_report(const ReportContext& context, report::Section& section);

}  // namespace brachium::pipelines
