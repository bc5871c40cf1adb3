#include <fmt/format.h>

#include "data/io/atomic_file.hpp"
#include "pipelines/assemble_report.hpp"
#include "pipelines/report/html.hpp"
#include "pipelines/run_folder.hpp"
#include "pipelines/run_records.hpp"

namespace brachium::pipelines {

namespace fs = std::filesystem;

fs::path write_report_again(const Catalogue& catalogue, const fs::path& folder) {
  RunResult result;
  result.stages = read_stage_records(folder);
  result.folder = fs::absolute(folder).lexically_normal();
  const auto definition =
      std::make_shared<Definition>(read_definition(folder / "definition.toml", {}, catalogue));
  result.definition = definition;
  RunData data;
  for (const StageRecord& record : result.stages) {
    if (record.status == StageStatus::failed) result.failed_stage = record.name;
    if (record.status == StageStatus::done || record.status == StageStatus::reused)
      data[record.name] = load_stage(record.output, record.name);
    result.ended = std::max(result.ended, record.ended);
  }
  if (definition->session.extension() == ".h5") data[session_stage] = load_session(definition->session);
  for (const StageDefinition& stage : definition->stages) {
    for (const auto& [port, wires] : stage.inputs) {
      for (const Wire& wire : wires) {
        if (wire.stage.empty()) data["file:" + wire.file.string()] = load_subject(wire.file);
      }
    }
  }
  for (const Expectation& expectation : definition->expectations) {
    const auto found = data.find(expectation.stage);
    result.expectations.push_back(
        check_expectation(expectation, found == data.end() ? nullptr : &found->second));
  }
  const fs::path file = result.folder / "report.html";
  io::write_text_atomically(file, report::render_html(assemble_report(result, data)));
  return file;
}

}  // namespace brachium::pipelines
