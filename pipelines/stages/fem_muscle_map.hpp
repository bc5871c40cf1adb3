#pragma once
/// The parts of fem.muscle_map, and options that it shares with fem.upper_limb.

#include <optional>
#include <string>
#include <vector>

#include "fem/surrogate/samples.hpp"
#include "pipelines/stage.hpp"
#include "pipelines/stages/fem_mistakes.hpp"
#include "pipelines/stages/limb_groups.hpp"
#include "pipelines/stages/limb_scene.hpp"

namespace brachium::pipelines {

/// limb, variant, mesh, scale_to, strength, pre_stretch, max_stress_Pa, contact_tolerance_m, group, solver.
std::vector<OptionSpec> limb_option_specs();

/// The limb as the options say: read, scaled, with changed parameters; how muscles are grouped where a scene is
/// at hand. Cheap: muscles in situ are made stress-free once everything else has been checked.
struct PreparedLimb {
  LimbScene scene;
  std::optional<Grouping> grouping;
  std::optional<LimbScaling> scaling;
  fem::SolvedMuscleOptions solving;
  std::vector<std::string> log;  ///< how muscles in situ were made stress-free
};
PreparedLimb prepare_limb(const StageContext& context);
void make_stress_free(PreparedLimb& limb, const std::vector<std::string>& muscles,
                      const StageContext& context);

/// What can be said of a limb's options before anything runs: its file, parameters by muscle, scaling, solver.
/// The limb as its file has it where it can be read.
std::optional<LimbScene> check_limb(const CheckContext& context, Mistakes& mistakes);
/// Whether the scene's lumped muscles can be grouped to the limb's.
void check_groups(const CheckContext& context, const LimbScene& limb, Mistakes& mistakes);
/// Muscles that the option `muscles` chooses of the limb's, all where it is empty. InputError("no-match").
std::vector<std::string> chosen_muscles(const Options& options, const LimbScene& limb);

LimbScene limb_of_options(const Options& options);
/// By the options `coordinate` and `group` and the input `subject`, where there is one.
Grouping group_muscles(const StageContext& context, const std::vector<std::string>& muscles);

std::vector<fem::StatePoint> asked_states(const Options& options, const fem::AngleRange& range);

void add_muscle_map_stage(Catalogue& catalogue);
std::vector<data::Diagnostic> check_muscle_map(const CheckContext& context);
void run_muscle_map(const StageContext& context, StageOutput& out);
void fill_muscle_map_report(const ReportContext& context, report::Section& section);
std::string muscle_map_methods(const ReportContext& context);

}  // namespace brachium::pipelines
