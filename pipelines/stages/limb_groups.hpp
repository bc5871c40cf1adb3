#pragma once
/// Which lumped muscles of a scene a continuum muscle stands for, and the limb scaled to a subject.
///
/// Rule of grouping: a continuum muscle takes the lumped muscles whose strength group has its name, or those
/// that the option `group` names. Its activation is the mean of theirs, weighted by their strength F =
/// strength x F0. Muscles in no group are what the continuum model leaves out.
///
/// | symbol | meaning                                                                                     |
/// |--------|---------------------------------------------------------------------------------------------|
/// | s      | factor on all lengths: excursion of the groups' paths over that of the limb's tendon paths, |
/// |        | over the angles that both know, groups weighted by strength                                 |
/// | F      | strength of a group, sum of strength x F0                                                   |
/// | A      | mean cross-section of the belly, volume over length, after scaling                          |
///
/// Strength: sigma_max = F / A (`max_stress`), or radii by sqrt(F / (sigma_max A)) (`cross_section`).

#include <string>
#include <vector>

#include "data/model/scene.hpp"
#include "data/model/subject.hpp"
#include "pipelines/stage.hpp"
#include "pipelines/stages/limb_scene.hpp"
#include "pipelines/stages/moment_frames.hpp"

namespace brachium::pipelines {

struct MuscleGroup {
  std::string muscle;                ///< of the limb
  std::vector<std::string> members;  ///< of the scene
  std::vector<double> strength_n;    ///< F of each
  double sum_n() const;
};

struct Grouping {
  std::vector<MuscleGroup> groups;    ///< one a muscle of the limb, in its order
  std::vector<std::string> left_out;  ///< muscles of the scene over the coordinate that are in none
};

/// The option `group` of the stages that need it.
OptionSpec group_option();

/// Throws InputError: "missing-muscle" for a limb's muscle without members or a member that the scene lacks,
/// "contradiction" for a member of two groups.
Grouping group_muscles(const Options& options, const data::Scene& scene, const data::Coordinate& coordinate,
                       const data::Subject* subject, const std::vector<std::string>& muscles);

/// Mean activation of a group's members at the frames, weighted by strength; outside [0, 1] as activation_at does.
std::vector<double> group_activation(const CommonFrames& frames, const MuscleGroup& group,
                                     const data::SessionSource& source, std::size_t trial, bool clamp,
                                     std::size_t& brought);

struct LimbScaling {
  double length_factor = 1.0;
  data::Table table;  ///< by muscle: what was compared, and the factors
};

/// Scales the limb in place. `strength`: "max_stress", "cross_section" or "none". Throws
/// InputError("no-common-range") where limb and paths share no angles.
LimbScaling scale_limb(LimbScene& limb, const Grouping& grouping, const data::Scene& scene,
                       const data::Coordinate& coordinate, const std::string& strength);

}  // namespace brachium::pipelines
