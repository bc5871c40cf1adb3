#pragma once
#include "pipelines/report/document.hpp"

namespace brachium::tests {

/// A spindle of two regions along x that shortens, swells and bends over `states` states; a field that
/// varies, one with a peak at a clamp, and one without values in the second region. `around` x `along`
/// quadrilaterals.
pipelines::report::View3d sample_view(int around = 24, int along = 40, int states = 9);

}  // namespace brachium::tests
