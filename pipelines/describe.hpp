#pragma once
/// The catalogue in words: one stage, the list of all, the manual, and definitions to start from.

#include <string>
#include <vector>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// What a stage does, its inputs and its options, for a terminal.
std::string explain_stage(const StageSpec& stage);
/// One line per stage.
std::string stage_list(const Catalogue& catalogue);
/// Every stage as Markdown.
std::string manual(const Catalogue& catalogue);

std::vector<std::string> template_names();
/// A definition to start from: the template's stages wired, every option with its default as a comment.
/// Throws InputError("unknown-template"), and std::logic_error where the catalogue lacks one of its stages.
std::string render_template(const std::string& name, const std::string& title, const Catalogue& catalogue);

}  // namespace brachium::pipelines
