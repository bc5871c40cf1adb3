#pragma once
/// A table as HTML.

#include <string>

#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// Columns with a numeric cell are right-aligned, heading included; the first cell of a row, where it is
/// text, is the row's heading. Throws std::logic_error where a row has more cells than the header.
std::string draw_grid(const Grid& grid);

}  // namespace brachium::pipelines::report
