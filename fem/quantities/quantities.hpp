#pragma once
/// What is read off a solved state: the whole chapter.

#include "fem/quantities/cell_state.hpp"
#include "fem/quantities/displacement_at.hpp"
#include "fem/quantities/point_fields.hpp"
#include "fem/quantities/section.hpp"
#include "fem/quantities/stress_wrench.hpp"
#include "fem/quantities/to_points.hpp"
#include "fem/quantities/volumes.hpp"
#include "fem/quantities/wrench.hpp"
