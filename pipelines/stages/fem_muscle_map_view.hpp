#pragma once
/// The limb of a muscle map in space: muscles deformed, bones where the angle puts them.

#include "pipelines/report/document.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// One state for each pair of angle and activation that all muscles show; no states where there is none.
report::View3d limb_view(const StageData& map);

}  // namespace brachium::pipelines
