#include "pipelines/run_records.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "data/io/atomic_file.hpp"
#include "pipelines/options.hpp"
#include "pipelines/version.hpp"

namespace brachium::pipelines {
namespace {

using nlohmann::json;

json to_json(const data::Diagnostic& d) {
  const char* severity = d.severity == data::Severity::error     ? "error"
                         : d.severity == data::Severity::warning ? "warning"
                                                                 : "note";
  json out{{"severity", severity}, {"code", d.code}, {"message", d.message}};
  if (!d.help.empty()) out["help"] = d.help;
  if (d.where) out["where"] = {{"file", d.where->file}, {"line", d.where->line}, {"column", d.where->column}};
  return out;
}

json to_json(const StageRecord& s) {
  json out{{"name", s.name},
           {"run", s.run},
           {"status", to_string(s.status)},
           {"reason", s.reason},
           {"seconds", s.seconds},
           {"started", s.started},
           {"ended", s.ended},
           {"output", s.output.filename().string()},
           {"reads", s.reads}};
  out["findings"] = json::array();
  for (const data::Diagnostic& d : s.findings) out["findings"].push_back(to_json(d));
  out["fingerprint"] = s.fingerprint.empty() ? json() : json(digest(s.fingerprint));
  return out;
}

json to_json(const ExpectationResult& r) {
  json out{{"name", r.expectation->name},
           {"place", place_text(*r.expectation)},
           {"wanted", wanted_text(*r.expectation)},
           {"checked", r.checked},
           {"passed", r.passed}};
  // JSON has no NaN: a number that is none is told by its text.
  if (r.found) out["found"] = std::isfinite(*r.found) ? json(*r.found) : json(fmt::format("{}", *r.found));
  if (!r.remark.empty()) out["remark"] = r.remark;
  return out;
}

std::string dump(const json& value) {
  return value.dump(2, ' ', false, json::error_handler_t::replace) + "\n";
}

StageStatus parse_status(const std::string& text) {
  for (const StageStatus status : {StageStatus::done, StageStatus::reused, StageStatus::failed}) {
    if (to_string(status) == text) return status;
  }
  return StageStatus::skipped;
}

}  // namespace

json result_json(const RunResult& result) {
  json out{{"outcome", to_string(result.outcome)},
           {"exit_code", exit_code(result.outcome)},
           {"title", result.definition->title},
           {"folder", result.folder.string()},
           {"report", (result.folder / "report.html").string()},
           {"verdict", result.verdict},
           {"started", result.started},
           {"ended", result.ended}};
  if (!result.failed_stage.empty()) out["failed_stage"] = result.failed_stage;
  for (const char* list : {"errors", "warnings", "stages", "expectations"}) out[list] = json::array();
  for (const data::Diagnostic& d : result.errors) out["errors"].push_back(to_json(d));
  for (const data::Diagnostic& d : result.definition->warnings) out["warnings"].push_back(to_json(d));
  for (const StageRecord& s : result.stages) out["stages"].push_back(to_json(s));
  for (const ExpectationResult& r : result.expectations) out["expectations"].push_back(to_json(r));
  return out;
}

json provenance_json(const RunResult& result) {
  const Definition& definition = *result.definition;
  utsname system{};
  json out{{"program", "brachium"}, {"version", program_version()}, {"built_with", build_versions()}};
  if (::uname(&system) == 0)
    out["machine"] = {{"system", fmt::format("{} {}", system.sysname, system.release)},
                      {"architecture", system.machine}};
  out["machine"]["cores"] = std::thread::hardware_concurrency();
  out["command_line"] = result.command_line;
  out["settings"] = definition.settings;
  for (const auto& [name, value] : definition.variables.members) out["variables"][name] = node_text(value);
  out["definition"] = definition.file.string();
  out["started"] = result.started;
  out["ended"] = result.ended;
  out["files"] = result.files;
  if (!definition.scene_file.empty()) out["scene"] = definition.scene_file.string();
  out["stages"] = json::array();
  for (const StageRecord& s : result.stages) {
    json stage = to_json(s);
    stage["made_from"] = s.fingerprint;
    out["stages"].push_back(std::move(stage));
  }
  return out;
}

void write_records(const RunResult& result) {
  io::write_text_atomically(result.folder / "provenance.json", dump(provenance_json(result)));
  io::write_text_atomically(result.folder / "result.json", dump(result_json(result)));
}

std::vector<StageRecord> read_stage_records(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(folder / "result.json", ignored)) {
    throw data::InputError("not-a-run",
                           fmt::format("`{}` is not a run folder: it has no result.json", folder.string()));
  }
  std::vector<StageRecord> records;
  try {
    const json result = json::parse(io::read_text(folder / "result.json"));
    for (const json& s : result.at("stages")) {
      StageRecord record;
      record.name = s.at("name");
      record.run = s.at("run");
      record.status = parse_status(s.at("status"));
      record.reason = s.at("reason");
      record.seconds = s.at("seconds");
      record.started = s.at("started");
      record.ended = s.at("ended");
      record.output = folder / s.at("output").get<std::string>();
      record.reads = s.at("reads");
      records.push_back(std::move(record));
    }
  } catch (const json::exception& damage) {
    throw data::InputError("not-a-run", fmt::format("`{}` cannot be read: {}",
                                                    (folder / "result.json").string(), damage.what()));
  }
  return records;
}

}  // namespace brachium::pipelines
