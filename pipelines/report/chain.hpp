#pragma once
/// The chain of stages as a picture: a box for each stage with its run, time and status, arrows from what it
/// reads.

#include <string>
#include <vector>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// An SVG picture; empty for an empty chain. Short chains run from left to right, long ones from top to
/// bottom. Errors: layout_chain's.
std::string draw_chain(const std::vector<ChainNode>& nodes);

}  // namespace brachium::pipelines::report
