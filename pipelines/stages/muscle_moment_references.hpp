#pragma once
/// Moments of a subject's lumped muscles as references for the continuum muscles that stand for them.
///
/// | symbol | meaning                                                                       | unit |
/// |--------|-------------------------------------------------------------------------------|------|
/// | M_g    | sum of F r over the members of a group (hill.moment), flexion positive        | N m  |
/// | a_g    | mean of their activations, weighted by strength                               | 1    |
///
/// Frames are many and alike, and every reference costs a solved state: the plane of angle and activation is cut into
/// cells, and a cell that frames visit gives one reference, the frame nearest to the mean of its frames.

#include <vector>

#include "fem/limb/muscle_body.hpp"
#include "optimise/muscle_force_fit.hpp"
#include "pipelines/stage.hpp"
#include "pipelines/stages/limb_groups.hpp"

namespace brachium::pipelines {

/// moment_angle_cell_deg, moment_activation_cell.
std::vector<OptionSpec> moment_reference_options();

/// From the inputs `moments`, `activation` and `kinematics` over the trials of the stage, inside `range`; set `moments`.
/// Throws InputError("no-references") where no frame lies in range, ("unknown-signal") where `moments` has no forces by
/// muscle: a total cannot be told apart.
std::vector<optimise::ReferenceForce> moment_references(const StageContext& context, const MuscleGroup& group,
                                                        const fem::AngleRange& range);

}  // namespace brachium::pipelines
