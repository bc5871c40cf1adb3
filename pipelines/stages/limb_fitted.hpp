#pragma once
/// Fitted parameters as a table that other stages apply to a limb.

#include "pipelines/stage.hpp"
#include "pipelines/stages/limb_scene.hpp"

namespace brachium::pipelines {

/// Rows of the table `fitted`: muscle, parameter (fem/limb/body_parameters.hpp), unit, value.
data::Table fitted_table(const std::vector<fem::MuscleBody>& bodies,
                         const std::vector<std::string>& parameters);

/// Sets them. Muscles of the table that the limb lacks are refused, as are bodies that cannot be built.
/// Throws InputError("missing-table") where the stage left no such table.
void apply_fitted(const StageData& fitted, LimbScene& limb);

}  // namespace brachium::pipelines
