#pragma once
/// What a run leaves beside the outputs of its stages: result.json and provenance.json.

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pipelines/runner.hpp"

namespace brachium::pipelines {

/// Outcome, stages with reasons and times, findings, expected numbers: what `--json` prints.
nlohmann::json result_json(const RunResult& result);

/// Program, libraries, machine, files with their digests, options as run.
nlohmann::json provenance_json(const RunResult& result);

/// Both, atomically. Throws InputError("write-failed", ...).
void write_records(const RunResult& result);

/// Stages of a stored result.json, for a report that is written again. Throws InputError("not-a-run").
std::vector<StageRecord> read_stage_records(const std::filesystem::path& folder);

}  // namespace brachium::pipelines
