#pragma once
/// Moved to its own chapter.

#include "fem/quantities/quantities.hpp"
