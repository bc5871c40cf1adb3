#include "pipelines/inspect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "data/io/scene_file.hpp"
#include "data/io/session_description.hpp"
#include "data/io/stage_file.hpp"
#include "data/io/subject_file.hpp"
#include "data/io/toml.hpp"
#include "pipelines/definition.hpp"
#include "pipelines/run_records.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;

std::string signals_text(const data::SessionInfo& session) {
  std::string out;
  if (!session.subject.empty()) out += fmt::format("subject {}\n", session.subject);
  for (const auto& [name, value] : session.anthropometry) out += fmt::format("{} = {:g}\n", name, value);
  for (const auto& [name, text] : session.attributes) out += fmt::format("{}: {}\n", name, text);
  for (const data::TrialInfo& trial : session.trials) {
    out += fmt::format("trial {} ({})", trial.name, data::to_string(trial.kind));
    for (const auto& [name, value] : trial.conditions) out += fmt::format(", {} = {:g}", name, value);
    out += "\n";
    for (const data::SignalInfo& s : trial.signals) {
      out += fmt::format("  {:<24} {:<20} {:>10} samples at {:g} Hz from {:g} s [{}]{}\n", s.name,
                         data::to_string(s.quantity), s.count, s.rate_hz, s.start_time_s, s.unit,
                         s.muscle.empty() ? "" : " " + s.muscle);
    }
  }
  return out;
}

std::string table_text(const std::string& name, const data::Table& table) {
  constexpr std::size_t shown = 40;
  std::string out = fmt::format("table {}{} ({} rows)\n", name, table.title.empty() ? "" : ": " + table.title,
                                table.rows());
  std::vector<std::vector<std::string>> columns;
  for (const data::Column& c : table.columns) {
    std::vector<std::string> cells{c.name + (c.unit.empty() || c.unit == "1" ? "" : " [" + c.unit + "]")};
    for (std::size_t r = 0; r < std::min(shown, table.rows()); ++r) {
      if (const auto* numbers = std::get_if<std::vector<double>>(&c.values)) {
        cells.push_back(fmt::format("{:.5g}", (*numbers)[r]));
      } else {
        cells.push_back(std::get<std::vector<std::string>>(c.values)[r]);
      }
    }
    columns.push_back(std::move(cells));
  }
  for (std::size_t r = 0; !columns.empty() && r < columns.front().size(); ++r) {
    std::string line = " ";
    for (const auto& cells : columns) {
      std::size_t width = 0;
      for (const std::string& cell : cells) width = std::max(width, cell.size());
      line += fmt::format(" {:<{}}", cells[r], width);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  if (table.rows() > shown) out += fmt::format("  ... {} more rows\n", table.rows() - shown);
  return out;
}

std::string subject_text(const data::Subject& subject) {
  std::string out = fmt::format("subject {}: {} muscles\n", subject.name, subject.muscles.size());
  for (const auto& [key, value] : subject.statistics) out += fmt::format("  {} = {:.5g}\n", key, value);
  for (const data::ParameterVerdict& v : subject.verdicts) {
    out += fmt::format("  {:<12} {:<28} {:>12.5g} -> {:>12.5g} {:<6} [{:.4g}, {:.4g}]  {} {}\n", v.muscle,
                       v.parameter, v.start, v.fitted, v.unit, v.lower, v.upper, v.verdict, v.remark);
  }
  return out;
}

std::string hdf5_text(const fs::path& file) {
  const io::SessionFile signals(file);
  std::string out = signals_text(signals.info());
  if (!io::read_fingerprint(file)) return "session " + file.string() + "\n" + out;
  const io::StageFileContent content = io::read_stage_content(file);
  out = "stage output " + file.string() + "\n" + out;
  for (const auto& [part, value] : content.fingerprint) out += fmt::format("made from {}: {}\n", part, value);
  for (const auto& [key, text] : content.attributes) out += fmt::format("{}: {}\n", key, text);
  for (const auto& [name, table] : content.tables) out += table_text(name, table);
  if (content.subject) out += subject_text(*content.subject);
  return out + data::render(content.diagnostics);
}

std::string scene_text(const data::Scene& scene) {
  std::string out = fmt::format("scene {}\n", scene.title);
  if (!scene.wanted.empty()) out += fmt::format("wanted: {}\n", fmt::join(scene.wanted, ", "));
  for (const data::Coordinate& c : scene.coordinates)
    out += fmt::format("coordinate {} from {:.4g} to {:.4g} rad\n", c.name, c.lower_rad, c.upper_rad);
  for (const data::Segment& s : scene.segments)
    out += fmt::format("segment {}: {:.4g} kg at {:.4g} m, {:.4g} kg m^2\n", s.name, s.mass_kg,
                       s.centre_of_mass_m, s.inertia_kg_m2);
  for (const data::Load& l : scene.loads) out += fmt::format("load {} at {:.4g} m\n", l.name, l.distance_m);
  for (const data::SceneMuscle& m : scene.muscles) {
    out += fmt::format("muscle {:<12} F0 {:.4g} N, optimal fibre length {:.4g} m, slack length {:.4g} m\n",
                       m.name, m.parameters.max_isometric_force_N, m.parameters.optimal_fibre_length_m,
                       m.parameters.tendon_slack_length_m);
  }
  return out + data::render(scene.notes);
}

std::string definition_text(const Definition& d) {
  std::string out = fmt::format("pipeline {}\n", d.title);
  if (!d.session.empty()) out += fmt::format("session {}\n", d.session.string());
  if (!d.scene_file.empty()) out += fmt::format("scene {}\n", d.scene_file.string());
  for (const std::size_t i : d.order) {
    const StageDefinition& s = d.stages[i];
    out += fmt::format("{:02} {} ({})", s.number, s.name, s.spec->name);
    for (const auto& [port, wires] : s.inputs) {
      for (const Wire& wire : wires)
        out += fmt::format("  {} <- {}", port, wire.stage.empty() ? wire.file.string() : wire.stage);
    }
    out += "\n";
  }
  return out;
}

std::string run_text(const fs::path& folder) {
  std::string out = "run " + folder.string() + "\n";
  for (const StageRecord& s : read_stage_records(folder)) {
    out += fmt::format("{:<20} {:<24} {:<8} {:>8.2f} s  {}\n", s.name, s.run, to_string(s.status), s.seconds,
                       s.reason);
  }
  return out;
}

}  // namespace

std::string inspect(const fs::path& file, const Catalogue& catalogue) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) return run_text(file);
  if (file.extension() == ".h5" || file.extension() == ".hdf5") return hdf5_text(file);
  if (file.extension() == ".toml") {
    const io::TomlNode root = io::read_toml(file);
    if (root.find("pipeline") || root.find("stage"))
      return definition_text(read_definition(file, {}, catalogue));
    if (root.find("session") || root.find("trial")) {
      const io::SessionDescription d = io::read_session_description(file);
      std::string out = fmt::format("session description, recordings in {}\n", d.recordings.string());
      data::SessionInfo session = d.session;
      for (const io::TrialDescription& trial : d.trials) session.trials.push_back(trial.info);
      return out + signals_text(session);
    }
    if (root.find("scene") || root.find("coordinate") || root.find("segment"))
      return scene_text(io::read_scene(file));
    return subject_text(io::read_subject(file));
  }
  if (!fs::exists(file, ignored))
    throw data::InputError("missing-file", fmt::format("cannot read `{}`", file.string()), "check the path");
  throw data::InputError("unknown-file", fmt::format("`{}` is none of this program's files", file.string()),
                         "sessions and outputs end in .h5; subjects, scenes, descriptions and definitions in "
                         ".toml; a run is a folder");
}

}  // namespace brachium::pipelines
