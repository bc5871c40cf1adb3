#pragma once
/// Diagnostics as findings that can be read: one line for what happened once, one line for what happened to
/// many. A calibration repeated over folds warns of the same parameter in each; forty lines hide the one that
/// matters.

#include <span>
#include <string>
#include <vector>

#include "data/model/error.hpp"
#include "pipelines/report/document.hpp"

namespace brachium::pipelines::report {

/// The findings of one stage. Diagnostics of one code and severity become one finding if there are at least
/// three of them, or two that differ only in the trials left out ("without `a`: ..."): the finding counts
/// them and names what they are about (the first thing in backticks), its details hold one line for each of
/// those. Nothing is lost: what was said once stays whole, and order is kept.
std::vector<Paragraph> make_findings(const std::string& stage, std::span<const data::Diagnostic> diagnostics);

}  // namespace brachium::pipelines::report
