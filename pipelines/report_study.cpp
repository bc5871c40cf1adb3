#include "pipelines/report_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "pipelines/report/build.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines {
namespace {

using report::make_number_cell;
using report::make_text_cell;
using report::Tone;

constexpr std::string_view kAssumption = "assumption_";

/// "1.247" and "load mass [kg]" as "load mass 1.247 kg".
std::string condition_text(const std::string& name, double value) {
  const std::string label = report::label_of_name(name);
  const std::size_t open = label.rfind(" [");
  if (open == std::string::npos) return fmt::format("{} {:.4g}", label, value);
  return fmt::format("{} {:.4g} {}", label.substr(0, open), value,
                     label.substr(open + 2, label.size() - open - 3));
}

std::string date_text(std::string stamp) {  // 2026-01-31T12:00:00Z
  if (stamp.size() != 20 || stamp[10] != 'T') return stamp;
  return stamp.substr(0, 10) + " " + stamp.substr(11, 5) + " UTC";
}

report::Section recordings_section(const data::SessionInfo& session) {
  report::Section section;
  section.title = "Recordings";
  report::Grid texts;
  texts.header = {"what", "value"};
  if (!session.subject.empty())
    texts.rows.push_back({make_text_cell("subject"), make_text_cell(session.subject)});
  for (const auto& [name, value] : session.anthropometry)
    texts.rows.push_back(
        {make_text_cell(report::label_of_name(name)), make_text_cell(report::significant(value, 4))});
  for (const auto& [name, text] : session.attributes) {
    if (name.starts_with(kAssumption)) {
      section.blocks.emplace_back(report::Paragraph{
          "Assumed (" + report::in_words(name.substr(kAssumption.size())) + "): " + text, Tone::warning});
    } else {
      texts.rows.push_back({make_text_cell(report::in_words(name)), make_text_cell(text)});
    }
  }
  if (!texts.rows.empty()) section.blocks.emplace_back(std::move(texts));
  report::Grid trials;
  trials.header = {"trial", "kind", "signals", "duration [s]", "conditions"};
  for (const data::TrialInfo& trial : session.trials) {
    double duration = 0.0;
    for (const data::SignalInfo& signal : trial.signals) duration = std::max(duration, signal.duration_s());
    std::string conditions;
    for (const auto& [name, value] : trial.conditions)
      conditions += (conditions.empty() ? "" : ", ") + condition_text(name, value);
    trials.rows.push_back({make_text_cell(trial.name), make_text_cell(data::to_string(trial.kind)),
                           make_text_cell(std::to_string(trial.signals.size())), make_number_cell(duration),
                           make_text_cell(conditions)});
  }
  section.blocks.emplace_back(std::move(trials));
  return section;
}

report::Cell fixed_cell(double value, int decimals) {
  return {.text = report::fixed(value, decimals), .numeric = true};
}

std::string drive_text(const data::MuscleDrive& drive) {
  if (drive.kind == data::MuscleDrive::Kind::rule)
    return fmt::format("{} {}", report::in_words(drive.rule), fmt::join(drive.muscles, ", "));
  if (drive.kind == data::MuscleDrive::Kind::undriven)
    return "undriven" + (drive.reason.empty() ? "" : ": " + drive.reason);
  std::string text;
  for (const auto& [channel, weight] : drive.channels)
    text += fmt::format("{}{}{}", text.empty() ? "" : " + ",
                        weight == 1.0 ? "" : fmt::format("{:g} ", weight), channel);
  return text;
}

report::Section scene_section(const data::Scene& scene) {
  report::Section section;
  section.title = "Scene";
  section.blocks.emplace_back(report::Paragraph{
      fmt::format("{} (`{}`).", scene.title, std::filesystem::path(scene.file).filename().string()),
      Tone::plain});
  if (scene.body_mass_kg > 0.0) {
    section.blocks.emplace_back(
        report::Paragraph{fmt::format("Body mass {:.4g} kg: {}.", scene.body_mass_kg, scene.body_mass_source),
                          scene.body_mass_source.starts_with("assumed") ? Tone::warning : Tone::plain});
  }
  report::Grid bodies;
  bodies.caption = "What the limb carries";
  bodies.header = {
      "body", "coordinate", "mass [kg]", "centre of mass from the joint [m]", "inertia [kg m^2]", "source"};
  for (const data::Segment& s : scene.segments) {
    bodies.rows.push_back({make_text_cell(s.name), make_text_cell(s.coordinate), make_number_cell(s.mass_kg),
                           make_number_cell(s.centre_of_mass_m), make_number_cell(s.inertia_kg_m2),
                           make_text_cell(s.source)});
  }
  for (const data::Load& load : scene.loads) {
    bodies.rows.push_back(
        {make_text_cell(load.name), make_text_cell(load.coordinate),
         load.mass_condition.empty() ? make_number_cell(load.mass_kg) : make_text_cell("of the trial"),
         make_number_cell(load.distance_m), make_text_cell("point mass"), make_text_cell(load.source)});
  }
  if (!bodies.rows.empty()) section.blocks.emplace_back(std::move(bodies));
  report::Grid muscles;
  muscles.caption = "Muscles";
  muscles.header = {"muscle", "driven by", "max. isometric force [N]", "optimal fibre length [m]",
                    "tendon slack length [m]"};
  std::vector<std::pair<std::string, std::vector<std::string>>> sources;  // what, of which muscles
  for (const data::SceneMuscle& m : scene.muscles) {
    const bool undriven = m.drive.kind == data::MuscleDrive::Kind::undriven;
    muscles.rows.push_back({make_text_cell(m.name),
                            make_text_cell(drive_text(m.drive), undriven ? Tone::warning : Tone::plain),
                            fixed_cell(m.parameters.max_isometric_force_N, 1),
                            fixed_cell(m.parameters.optimal_fibre_length_m, 4),
                            fixed_cell(m.parameters.tendon_slack_length_m, 4)});
    if (m.source.empty()) continue;
    auto known =
        std::find_if(sources.begin(), sources.end(), [&](const auto& s) { return s.first == m.source; });
    if (known == sources.end()) known = sources.insert(sources.end(), {m.source, {}});
    known->second.push_back(m.name);
  }
  for (const auto& [source, of] : sources)
    muscles.notes.push_back(fmt::format("{}: {}.", fmt::join(of, ", "), source));
  if (!muscles.rows.empty()) section.blocks.emplace_back(std::move(muscles));
  return section;
}

}  // namespace

std::string study_subtitle(const RunResult& result, const RunData& data) {
  std::string text;
  if (const auto session = data.find(session_stage); session != data.end()) {
    const data::SessionInfo& info = session->second.signals->info();
    if (!info.subject.empty()) text = "subject " + info.subject + ", ";
    text += fmt::format("{} trials, ", info.trials.size());
  }
  return text + date_text(result.ended);
}

void add_assumptions(const RunData& data, report::Document& document) {
  const auto session = data.find(session_stage);
  if (session == data.end()) return;
  std::vector<report::Paragraph> assumptions;
  for (const auto& [name, text] : session->second.signals->info().attributes) {
    if (name.starts_with(kAssumption)) assumptions.push_back({"Assumed: " + text, Tone::warning});
  }
  document.findings.insert(document.findings.begin(), assumptions.begin(), assumptions.end());
}

void add_study_sections(const Definition& definition, const RunData& data, report::Document& document) {
  if (const auto session = data.find(session_stage); session != data.end()) {
    document.sections.push_back(recordings_section(session->second.signals->info()));
  }
  if (definition.scene) document.sections.push_back(scene_section(*definition.scene));
}

}  // namespace brachium::pipelines
