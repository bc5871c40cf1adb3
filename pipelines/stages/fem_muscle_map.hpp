#pragma once
/// The parts of fem.muscle_map, and options that it shares with fem.upper_limb.

#include <optional>
#include <string>
#include <vector>

#include "fem/surrogate/samples.hpp"
#include "pipelines/stage.hpp"
#include "pipelines/stages/limb_groups.hpp"
#include "pipelines/stages/limb_scene.hpp"

namespace brachium::pipelines {

/// limb, variant, mesh, scale_to, strength, pre_stretch, max_stress_Pa, contact_tolerance_m, group, solver.
std::vector<OptionSpec> limb_option_specs();

/// The limb as the options say: read, scaled, with changed parameters, its muscles stress-free; how muscles are grouped where a scene
/// is at hand.
struct PreparedLimb {
  LimbScene scene;
  std::optional<Grouping> grouping;
  std::optional<LimbScaling> scaling;
  fem::SolvedMuscleOptions solving;
  std::vector<std::string> log;  ///< how muscles in situ were made stress-free
};
PreparedLimb prepare_limb(const StageContext& context);

std::vector<fem::StatePoint> asked_states(const Options& options, const fem::AngleRange& range);

void add_muscle_map_stage(Catalogue& catalogue);
void run_muscle_map(const StageContext& context, StageOutput& out);
void fill_muscle_map_report(const ReportContext& context, report::Section& section);
std::string muscle_map_methods(const ReportContext& context);

}  // namespace brachium::pipelines
