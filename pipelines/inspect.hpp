#pragma once
/// Files of the program in words: what `brachium inspect` prints.

#include <filesystem>
#include <string>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// A session, a stage's output, a run folder, a subject, a scene, a session description or a definition.
/// Throws InputError("unknown-file") for anything else, and the mistakes of the file itself.
std::string inspect(const std::filesystem::path& file, const Catalogue& catalogue);

/// Differences of two runs: options, stages, tables (largest difference of each number column), verdicts.
/// Empty if there are none. Throws InputError("not-a-run").
std::string compare_runs(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace brachium::pipelines
