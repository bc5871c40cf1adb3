#pragma once
/// Stages that ask questions of models.

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

void add_optimise_calibrate(Catalogue& catalogue);
void add_optimise_cross_validate(Catalogue& catalogue);
void add_optimise_scenario(Catalogue& catalogue);
void add_optimise_muscle_forces(Catalogue& catalogue);

}  // namespace brachium::pipelines
