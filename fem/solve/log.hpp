#pragma once
/// Convergence history as text: fixed columns, one row an iteration, a line that closes each step, one that
/// closes the whole.

#include <string>

#include "fem/solve/solve.hpp"

namespace brachium::fem {

/// Heading of the rows below.
std::string log_heading();
/// Rows of one step and its closing line.
std::string log_text(const StepRecord& step);
/// Everything: heading, steps, the step that failed, and the closing line with counts and times.
std::string log_text(const Summary& summary);

}  // namespace brachium::fem
