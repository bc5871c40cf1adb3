#include "pipelines/report_study.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "pipelines/report/build.hpp"

namespace brachium::pipelines {
namespace {

using report::make_number_cell;
using report::make_text_cell;
using report::Tone;

report::Section recordings_section(const data::SessionInfo& session) {
  report::Section section;
  section.title = "Recordings";
  report::Grid texts;
  texts.header = {"what", "value"};
  if (!session.subject.empty())
    texts.rows.push_back({make_text_cell("subject"), make_text_cell(session.subject)});
  for (const auto& [name, value] : session.anthropometry)
    texts.rows.push_back({make_text_cell(name), make_number_cell(value)});
  for (const auto& [name, text] : session.attributes)
    texts.rows.push_back({make_text_cell(name), make_text_cell(text)});
  if (!texts.rows.empty()) section.blocks.emplace_back(std::move(texts));
  report::Grid trials;
  trials.header = {"trial", "kind", "signals", "duration [s]", "conditions"};
  for (const data::TrialInfo& trial : session.trials) {
    double duration = 0.0;
    for (const data::SignalInfo& signal : trial.signals) duration = std::max(duration, signal.duration_s());
    std::string conditions;
    for (const auto& [name, value] : trial.conditions)
      conditions += fmt::format("{}{} = {:.4g}", conditions.empty() ? "" : ", ", name, value);
    trials.rows.push_back({make_text_cell(trial.name), make_text_cell(data::to_string(trial.kind)),
                           make_text_cell(std::to_string(trial.signals.size())), make_number_cell(duration),
                           make_text_cell(conditions)});
  }
  section.blocks.emplace_back(std::move(trials));
  return section;
}

std::string drive_text(const data::MuscleDrive& drive) {
  if (drive.kind == data::MuscleDrive::Kind::rule)
    return fmt::format("{} {}", drive.rule, fmt::join(drive.muscles, ", "));
  if (drive.kind == data::MuscleDrive::Kind::undriven)
    return "undriven" + (drive.reason.empty() ? "" : ": " + drive.reason);
  std::string text;
  for (const auto& [channel, weight] : drive.channels)
    text += fmt::format("{}{:g} {}", text.empty() ? "" : " + ", weight, channel);
  return text;
}

report::Section scene_section(const data::Scene& scene) {
  report::Section section;
  section.title = "Scene";
  section.blocks.emplace_back(
      report::Paragraph{fmt::format("{} (`{}`).", scene.title, scene.file), Tone::plain});
  if (scene.body_mass_kg > 0.0) {
    section.blocks.emplace_back(report::Paragraph{
        fmt::format("Body mass {:.4g} kg: {}.", scene.body_mass_kg, scene.body_mass_source), Tone::plain});
  }
  report::Grid bodies;
  bodies.caption = "What the limb carries";
  bodies.header = {"body", "coordinate", "mass [kg]", "from the joint [m]", "inertia [kg m^2]", "source"};
  for (const data::Segment& s : scene.segments) {
    bodies.rows.push_back({make_text_cell(s.name), make_text_cell(s.coordinate), make_number_cell(s.mass_kg),
                           make_number_cell(s.centre_of_mass_m), make_number_cell(s.inertia_kg_m2),
                           make_text_cell(s.source)});
  }
  for (const data::Load& load : scene.loads) {
    bodies.rows.push_back(
        {make_text_cell(load.name), make_text_cell(load.coordinate),
         load.mass_condition.empty() ? make_number_cell(load.mass_kg)
                                     : make_text_cell("of the trial: " + load.mass_condition),
         make_number_cell(load.distance_m), make_text_cell(""), make_text_cell(load.source)});
  }
  if (!bodies.rows.empty()) section.blocks.emplace_back(std::move(bodies));
  report::Grid muscles;
  muscles.caption = "Muscles";
  muscles.header = {"muscle", "driven by", "F0 [N]", "optimal fibre length [m]", "tendon slack length [m]",
                    "source"};
  for (const data::SceneMuscle& m : scene.muscles) {
    const bool undriven = m.drive.kind == data::MuscleDrive::Kind::undriven;
    muscles.rows.push_back({make_text_cell(m.name),
                            make_text_cell(drive_text(m.drive), undriven ? Tone::warning : Tone::plain),
                            make_number_cell(m.parameters.max_isometric_force_N),
                            make_number_cell(m.parameters.optimal_fibre_length_m),
                            make_number_cell(m.parameters.tendon_slack_length_m), make_text_cell(m.source)});
  }
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
  return text + result.ended;
}

void add_study_sections(const Definition& definition, const RunData& data, report::Document& document) {
  if (const auto session = data.find(session_stage); session != data.end()) {
    document.sections.push_back(recordings_section(session->second.signals->info()));
  }
  if (definition.scene) document.sections.push_back(scene_section(*definition.scene));
}

}  // namespace brachium::pipelines
