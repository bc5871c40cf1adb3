#include "pipelines/assemble_report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <thread>

#include "pipelines/report/build.hpp"
#include "pipelines/report/findings.hpp"
#include "pipelines/report_study.hpp"
#include "pipelines/version.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using report::Tone;

Tone parse_tone(const std::string& text) {
  if (text == "good") return Tone::good;
  if (text == "warning") return Tone::warning;
  if (text == "bad") return Tone::bad;
  return Tone::plain;
}

std::string sentence(const std::string& text) {
  return text.ends_with('.') ? text : text + ".";
}

/// The last stage that states a verdict.
const StageData* verdict_stage(const RunResult& result, const RunData& data) {
  for (auto record = result.stages.rbegin(); record != result.stages.rend(); ++record) {
    const auto found = data.find(record->name);
    if (found != data.end() && found->second.attributes.contains("verdict")) return &found->second;
  }
  return nullptr;
}

std::size_t missed(const RunResult& result) {
  std::size_t count = 0;
  for (const ExpectationResult& r : result.expectations) count += r.checked && !r.passed;
  return count;
}

Tone tone_of_status(const StageRecord& record, const RunData& data) {
  if (record.status == StageStatus::failed) return Tone::bad;
  if (record.status == StageStatus::skipped) return Tone::plain;
  const auto found = data.find(record.name);
  if (found == data.end()) return Tone::plain;
  Tone tone = Tone::good;
  for (const Diagnostic& d : found->second.diagnostics) {
    if (d.severity == data::Severity::warning && tone == Tone::good) tone = Tone::warning;
    if (d.severity == data::Severity::error) tone = Tone::bad;
  }
  return tone;
}

void add_findings(const RunResult& result, const RunData& data, report::Document& document) {
  for (const Diagnostic& d : result.errors) document.findings.push_back(report::make_finding(d));
  for (const ExpectationResult& r : result.expectations) {
    if (!r.checked || r.passed) continue;
    document.findings.push_back(
        {fmt::format("Expected `{}` to be {}, found {}.", place_text(*r.expectation),
                     wanted_text(*r.expectation), r.found ? fmt::format("{:.6g}", *r.found) : r.remark),
         Tone::bad});
  }
  for (const Diagnostic& d : result.definition->warnings)
    document.findings.push_back(report::make_finding(d));
  for (const StageRecord& record : result.stages) {
    const auto found = data.find(record.name);
    if (found == data.end()) continue;
    for (report::Paragraph& finding : report::make_findings(record.name, found->second.diagnostics))
      document.findings.push_back(std::move(finding));
  }
}

ReportContext context_of(const StageDefinition& stage, const Definition& definition, const RunData& data) {
  ReportContext context;
  context.name = stage.name;
  context.options = &stage.options;
  context.output = &data.at(stage.name);
  context.scene = definition.scene ? &*definition.scene : nullptr;
  for (const auto& [port, wires] : stage.inputs) {
    for (const Wire& wire : wires) {
      const auto found = data.find(wire.stage.empty() ? "file:" + wire.file.string() : wire.stage);
      if (found != data.end()) context.inputs[port].push_back(&found->second);
    }
  }
  return context;
}

/// A stage without a chapter of its own: its tables and texts.
void plain_chapter(const StageData& output, report::Section& section) {
  for (const auto& [name, table] : output.tables) {
    report::Grid grid = report::make_grid(table);
    if (grid.caption.empty()) grid.caption = name;
    section.blocks.emplace_back(std::move(grid));
  }
  report::Grid texts;
  for (const auto& [key, text] : output.attributes)
    texts.rows.push_back({report::make_text_cell(key), report::make_text_cell(text)});
  if (!texts.rows.empty()) {
    texts.header = {"what", "value"};
    section.blocks.emplace_back(std::move(texts));
  }
}

report::Section stage_section(const StageRecord& record, const StageDefinition& stage,
                              const ReportContext& context) {
  report::Section section;
  section.title = stage.name;
  section.anchor = "stage-" + stage.name;
  section.blocks.emplace_back(
      report::Paragraph{fmt::format("`{}`: {}", record.run, sentence(stage.spec->summary)), Tone::plain});
  try {
    if (stage.spec->report) {
      stage.spec->report(context, section);
    } else {
      plain_chapter(*context.output, section);
    }
  } catch (const std::exception& failure) {
    // The results stand; only their picture is missing, and that is said where it would be.
    section.blocks.emplace_back(
        report::Paragraph{fmt::format("This chapter could not be drawn: {}", failure.what()), Tone::bad});
  }
  return section;
}

void add_methods(const StageDefinition& stage, const ReportContext& context, report::Document& document) {
  if (!stage.spec->methods) return;
  try {
    document.methods.push_back(stage.spec->methods(context));
  } catch (const std::exception& failure) {
    document.methods.push_back(
        fmt::format("The methods of stage `{}` could not be written: {}", stage.name, failure.what()));
  }
}

report::Section expectation_section(const RunResult& result) {
  report::Section section;
  section.title = "Expected numbers";
  report::Grid grid;
  grid.header = {"number", "wanted", "found", "verdict"};
  for (const ExpectationResult& r : result.expectations) {
    const Tone tone = !r.checked ? Tone::plain : r.passed ? Tone::good : Tone::bad;
    grid.rows.push_back({report::make_text_cell(place_text(*r.expectation)),
                         report::make_text_cell(wanted_text(*r.expectation)),
                         report::make_text_cell(r.found ? fmt::format("{:.6g}", *r.found) : "-"),
                         report::make_text_cell(!r.checked         ? "not checked: " + r.remark
                                                : r.passed         ? "ok"
                                                : r.remark.empty() ? "missed"
                                                                   : r.remark,
                                                tone)});
  }
  section.blocks.emplace_back(std::move(grid));
  return section;
}

void add_provenance(const RunResult& result, report::Document& document) {
  const Definition& definition = *result.definition;
  const auto add = [&](const std::string& label, const std::string& value) {
    document.provenance.emplace_back(label, value);
  };
  add("program", "Brachium " + program_version());
  for (const auto& [name, version] : build_versions()) add(name, version);
  add("cores", std::to_string(std::thread::hardware_concurrency()));
  add("definition", definition.file.string());
  if (!definition.settings.empty()) add("settings", fmt::format("{}", fmt::join(definition.settings, "; ")));
  if (!result.command_line.empty())
    add("command line", fmt::format("{}", fmt::join(result.command_line, " ")));
  add("run folder", result.folder.string());
  if (!result.started.empty()) add("started", result.started);  // a report drawn again knows the end alone
  add("ended", result.ended);
  for (const auto& [file, digest] : result.files)
    add("SHA-256 of " + std::filesystem::path(file).filename().string(), digest);
  for (const StageRecord& s : result.stages) {
    add("stage " + s.name,
        fmt::format("{}{}{}{}", to_string(s.status), s.reason.empty() ? "" : fmt::format(" ({})", s.reason),
                    s.started.empty() ? "" : ", computed " + s.started,
                    s.seconds > 0.0 ? " in " + report::duration(s.seconds) : ""));
  }
}

}  // namespace

std::string verdict_of(const RunResult& result, const RunData& data) {
  if (!result.failed_stage.empty()) {
    const std::string why = result.errors.empty() ? "" : ": " + result.errors.front().message;
    return result.outcome == Outcome::interrupted
               ? fmt::format("Stopped in stage `{}`", result.failed_stage)
               : fmt::format("Stage `{}` failed{}", result.failed_stage, why);
  }
  const StageData* stage = verdict_stage(result, data);
  return stage ? stage->attributes.at("verdict") : "";
}

report::Document assemble_report(const RunResult& result, const RunData& data) {
  const Definition& definition = *result.definition;
  report::Document document;
  document.title = definition.title;
  document.subtitle = study_subtitle(result, data);
  document.verdict = verdict_of(result, data);
  if (!result.failed_stage.empty()) {
    document.verdict_tone = Tone::bad;
  } else if (const StageData* stage = verdict_stage(result, data);
             stage && stage->attributes.contains("verdict_tone")) {
    document.verdict_tone = parse_tone(stage->attributes.at("verdict_tone"));
  }
  if (const std::size_t count = missed(result); count > 0) {
    document.verdict += fmt::format("{}{} of {} expected numbers missed",
                                    document.verdict.empty() ? "" : " · ", count, result.expectations.size());
    document.verdict_tone = Tone::bad;
  }
  if (document.verdict.empty()) document.verdict = fmt::format("{} stages done", result.stages.size());
  add_findings(result, data, document);
  add_assumptions(data, document);
  for (const StageRecord& record : result.stages) {
    document.chain.push_back({record.name, record.run, record.seconds, to_string(record.status),
                              tone_of_status(record, data), record.reads});
  }
  add_study_sections(definition, data, document);
  for (const StageRecord& record : result.stages) {
    const StageDefinition* stage = definition.find(record.name);
    if (!stage || !data.contains(record.name)) continue;
    const ReportContext context = context_of(*stage, definition, data);
    document.sections.push_back(stage_section(record, *stage, context));
    add_methods(*stage, context, document);
  }
  if (!result.expectations.empty()) document.sections.push_back(expectation_section(result));
  add_provenance(result, document);
  return document;
}

}  // namespace brachium::pipelines
