#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <optional>

#include "data/io/scene_parts.hpp"
#include "data/limb/drive.hpp"
#include "data/limb/muscle_path.hpp"

namespace brachium::io::detail {
namespace {

using data::Diagnostic;
using data::PathGeometry;
using data::Severity;

constexpr double radian = std::numbers::pi / 180.0;

data::MuscleParameters read_parameters(TomlTable& table, const std::string& owner) {
  data::MuscleParameters p;
  DomainReader domain{table, owner};
  p.max_isometric_force_N = domain.positive("max_isometric_force_N");
  p.optimal_fibre_length_m = domain.positive("optimal_fibre_length_m");
  p.tendon_slack_length_m = domain.non_negative("tendon_slack_length_m");
  const double pennation = domain.non_negative("pennation_at_optimal_deg", 0.0);
  if (pennation >= 90.0) {
    table.error("out-of-range",
                fmt::format("`pennation_at_optimal_deg` of {} must be below 90, not {}", owner, pennation),
                "pennation_at_optimal_deg");
  }
  p.pennation_at_optimal_rad = pennation * radian;
  p.max_contraction_velocity = domain.positive("max_contraction_velocity", p.max_contraction_velocity);
  p.fibre_damping = domain.non_negative("fibre_damping", p.fibre_damping);
  p.strength = domain.positive("strength", p.strength);
  table.finish();
  return p;
}

data::ActivationParameters read_activation(TomlTable& table, const std::string& owner) {
  data::ActivationParameters a;
  DomainReader domain{table, owner};
  a.delay_s = domain.non_negative("delay_s", a.delay_s);
  a.time_constant_1_s = domain.positive("time_constant_1_s", a.time_constant_1_s);
  a.time_constant_2_s = domain.positive("time_constant_2_s", a.time_constant_2_s);
  a.shape = table.number("shape").value_or(a.shape);
  // Exponential law -3 < A <= 0 (0: linear), piecewise law 0 < A <= 0.12; which one it is, the stage says.
  if (!(a.shape > -3.0 && a.shape <= 0.12)) {
    table.error("out-of-range",
                fmt::format("`shape` of {} must be above -3 and at most 0.12, not {}", owner, a.shape),
                "shape");
  }
  table.finish();
  return a;
}

// One column of a geometry table and what it is converted by.
struct CsvColumn {
  const char* name;
  double to_si;
  std::vector<double> PathGeometry::*values;
};

constexpr double milli = 1e-3;
const std::vector<CsvColumn> csv_columns{{"angle_deg", radian, &PathGeometry::angle_rad},
                                         {"angle_rad", 1.0, &PathGeometry::angle_rad},
                                         {"length_m", 1.0, &PathGeometry::length_m},
                                         {"length_mm", milli, &PathGeometry::length_m},
                                         {"moment_arm_m", 1.0, &PathGeometry::moment_arm_m},
                                         {"moment_arm_mm", milli, &PathGeometry::moment_arm_m}};

std::vector<std::string> cells_of(std::string line) {
  if (!line.empty() && line.back() == '\r') line.pop_back();
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) {
    const auto first = cell.find_first_not_of(" \t");
    const auto last = cell.find_last_not_of(" \t");
    cell = first == std::string::npos ? std::string{} : cell.substr(first, last - first + 1);
  }
  return cells;
}

// A comma-separated table with one header row of the names above; lines that are empty or start with # are
// passed over.
void read_csv(const std::filesystem::path& file, TomlTable& table, PathGeometry& geometry,
              std::vector<Diagnostic>& diagnostics) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(file, ignored)) {
    table.error("missing-file", fmt::format("cannot read the geometry table `{}`", file.string()), "csv",
                "the path is relative to the scene's folder");
    return;
  }
  const auto mistake = [&](const char* code, int line, std::string message, std::string help = {}) {
    diagnostics.push_back({Severity::error, code, std::move(message),
                           data::SourceSpan{file.string(), line, 0, 1, {}}, std::move(help)});
  };
  std::vector<const CsvColumn*> columns;
  std::string text;
  for (int line = 1; std::getline(stream, text); ++line) {
    if (line == 1 && text.rfind("\xEF\xBB\xBF", 0) == 0) text.erase(0, 3);
    const std::vector<std::string> cells = cells_of(text);
    if ((cells.size() == 1 && cells[0].empty()) || (!cells[0].empty() && cells[0][0] == '#')) continue;
    if (columns.empty()) {
      std::vector<std::string> known;
      for (const CsvColumn& c : csv_columns) known.emplace_back(c.name);
      for (const std::string& cell : cells) {
        const auto at = std::find(known.begin(), known.end(), cell);
        if (at == known.end()) {
          mistake("unknown-column", line, fmt::format("`{}` is not a column of a geometry table", cell),
                  data::suggest(cell, known));
          return;
        }
        const CsvColumn* column = &csv_columns[static_cast<std::size_t>(at - known.begin())];
        for (const CsvColumn* other : columns) {
          if (other->values == column->values) {
            mistake("contradiction", line,
                    fmt::format("columns `{}` and `{}` give the same quantity", other->name, column->name));
            return;
          }
        }
        columns.push_back(column);
      }
      continue;
    }
    if (cells.size() != columns.size()) {
      mistake("truncated", line,
              fmt::format("a row of {} cells under {} columns", cells.size(), columns.size()));
      return;
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
      double value = 0.0;
      const char* end = cells[c].data() + cells[c].size();
      const auto [stop, status] = std::from_chars(cells[c].data(), end, value);
      if (status != std::errc{} || stop != end || !std::isfinite(value)) {
        mistake("not-a-number", line,
                fmt::format("`{}` in column `{}` is not a finite number", cells[c], columns[c]->name));
        return;
      }
      (geometry.*(columns[c]->values)).push_back(value * columns[c]->to_si);
    }
  }
  if (geometry.angle_rad.empty()) {
    mistake("empty-file", 0, fmt::format("the geometry table `{}` has no angles", file.string()),
            "a header row with `angle_deg` and `length_m` or `moment_arm_m`, then one row an angle");
  }
}

PathGeometry read_geometry(TomlTable& table, const std::string& owner, SceneDraft& draft) {
  PathGeometry g;
  DomainReader domain{table, owner};
  std::vector<std::string> known;
  for (const auto& c : draft.scene.coordinates) known.push_back(c.name);
  if (const auto name = table.text("coordinate")) {
    g.coordinate = *name;
    if (std::find(known.begin(), known.end(), *name) == known.end()) {
      table.error("unknown-coordinate",
                  fmt::format("{} crosses coordinate `{}`, which the scene does not have", owner, *name),
                  "coordinate", data::suggest(*name, known));
    }
  } else if (known.size() == 1) {
    g.coordinate = known.front();
  } else if (!table.has("coordinate")) {
    table.error("missing-key", fmt::format("`coordinate` is missing in the geometry of {}", owner));
  }
  const bool polynomial = table.has("length_polynomial_m") || table.has("moment_arm_polynomial_m");
  const bool tabulated = table.has("angle_deg") || table.has("length_m") || table.has("moment_arm_m");
  const bool csv = table.has("csv");
  if (polynomial + tabulated + csv != 1) {
    table.error(polynomial + tabulated + csv == 0 ? "missing-key" : "contradiction",
                fmt::format("the geometry of {} must be given in one way", owner), {},
                "`length_polynomial_m` and `moment_arm_polynomial_m` (powers of rad), or `angle_deg` with "
                "`length_m` and "
                "`moment_arm_m`, or `csv`");
  }
  if (const auto length = table.numbers("length_polynomial_m")) g.length_m = *length;
  if (const auto arm = table.numbers("moment_arm_polynomial_m")) g.moment_arm_m = *arm;
  const auto angle = table.numbers("angle_deg");
  const auto length = table.numbers("length_m");
  const auto arm = table.numbers("moment_arm_m");
  const auto file = table.text("csv");
  g.kind = polynomial ? PathGeometry::Kind::polynomial : PathGeometry::Kind::table;
  if (tabulated && !polynomial) {
    if (!table.has("angle_deg"))
      table.error("missing-key", fmt::format("the geometry table of {} needs `angle_deg`", owner));
    for (const double a : angle.value_or(std::vector<double>{})) g.angle_rad.push_back(a * radian);
    g.length_m = length.value_or(std::vector<double>{});
    g.moment_arm_m = arm.value_or(std::vector<double>{});
  }
  if (file && !polynomial && !tabulated) read_csv(draft.folder / *file, table, g, draft.diagnostics);
  if (table.has("reference_length_m") || table.has("reference_angle_deg")) {
    g.reference_length_m = domain.positive("reference_length_m");
    g.reference_angle_rad = table.require_number("reference_angle_deg") * radian;
  }
  g.consistency_tolerance_m = domain.positive("consistency_tolerance_m", g.consistency_tolerance_m);
  table.finish();
  return g;
}

data::MuscleDrive read_drive(TomlTable& table, const std::string& owner) {
  data::MuscleDrive d;
  int ways = 0;
  if (auto channels = table.table("channels")) {
    ++ways;
    d.kind = data::MuscleDrive::Kind::channels;
    for (const auto& [channel, node] : channels->node().members) {
      if (const auto weight = channels->number(channel)) d.channels[channel] = *weight;
    }
    if (channels->node().members.empty())
      table.error("missing-key", fmt::format("the drive of {} names no channel", owner), "channels");
  }
  for (const char* rule : {"same_as", "mean_of"}) {
    if (const auto muscles = table.texts(rule)) {
      ++ways;
      d.kind = data::MuscleDrive::Kind::rule;
      d.rule = rule;
      d.muscles = *muscles;
    }
  }
  if (const auto reason = table.text("none")) {
    ++ways;
    d.kind = data::MuscleDrive::Kind::undriven;
    d.reason = *reason;
    if (reason->empty())
      table.error("out-of-range", fmt::format("`none` of {} must say why the muscle has no drive", owner),
                  "none");
  }
  table.finish();
  const bool any = table.has("channels") || table.has("same_as") || table.has("mean_of") || table.has("none");
  if (ways > 1 || !any) {
    table.error(
        ways > 1 ? "contradiction" : "missing-key",
        fmt::format("the drive of {} must be given in one way", owner), {},
        "`channels = { name = weight }`, `same_as = \"MUSCLE\"`, `mean_of = [...]`, or `none = \"why\"`");
  }
  return d;
}

// The place in the file of a channel or muscle that a drive names.
data::SourceSpan place_of(const TomlNode& muscle, const std::string& item) {
  const TomlNode* drive = muscle.find("drive");
  if (!drive) return muscle.where;
  for (const auto& [key, value] : drive->members) {
    if (key == item) return value.key_where;
    if (value.kind == TomlNode::Kind::text && value.text == item) return value.where;
    for (const TomlNode& entry : value.items) {
      if (entry.text == item) return entry.where;
    }
    for (const auto& [channel, weight] : value.members) {
      if (channel == item) return weight.key_where;
    }
  }
  return drive->where;
}

}  // namespace

void read_muscles(TomlTable& root, SceneDraft& draft, std::span<const std::string> channels) {
  std::vector<TomlTable> tables = root.tables("muscle");
  std::vector<std::string> seen;
  for (TomlTable& table : tables) {
    data::SceneMuscle m;
    m.name = table.require_text("name");
    const std::string owner = fmt::format("muscle `{}`", m.name);
    check_unique("muscle", m.name, seen, table);
    m.group = table.text("group").value_or(m.name);
    m.source = table.require_text("source");
    const auto part = [&](const char* key) -> std::optional<TomlTable> {
      auto sub = table.table(key);
      if (!sub && !table.has(key))
        table.error("missing-key", fmt::format("`{}` is missing in {}", key, owner));
      if (!sub) return std::nullopt;
      return TomlTable(sub->node(), draft.diagnostics, fmt::format("`{}` of {}", key, owner));
    };
    if (auto p = part("parameters")) m.parameters = read_parameters(*p, owner);
    if (auto a = table.table("activation")) m.activation = read_activation(*a, owner);
    if (auto g = part("geometry")) {
      const std::size_t before = draft.diagnostics.size();
      m.path = read_geometry(*g, owner, draft);
      const auto coordinate =
          std::find_if(draft.scene.coordinates.begin(), draft.scene.coordinates.end(),
                       [&](const data::Coordinate& c) { return c.name == m.path.coordinate; });
      // A geometry that could not be read cannot be checked further; nor one over a range that is itself
      // wrong.
      if (draft.diagnostics.size() == before && coordinate != draft.scene.coordinates.end() &&
          coordinate->lower_rad < coordinate->upper_rad) {
        try {
          const limb::MusclePath check(m.name, m.path, *coordinate);
        } catch (const data::InputError& e) {
          for (Diagnostic d : e.diagnostics()) {
            d.where = g->node().where;
            draft.diagnostics.push_back(std::move(d));
          }
        }
      }
    }
    if (auto d = part("drive")) m.drive = read_drive(*d, owner);
    table.finish();
    draft.scene.muscles.push_back(std::move(m));
  }
  // Drives refer to each other, so they are checked once all muscles are known.
  const std::vector<std::string> named = limb::named_channels(draft.scene);
  for (const auto& mistake :
       limb::drive_mistakes(draft.scene, channels.empty() ? std::span<const std::string>(named) : channels)) {
    Diagnostic d = mistake.finding;
    d.where = place_of(tables[mistake.muscle].node(), mistake.item);
    draft.diagnostics.push_back(std::move(d));
  }
}

}  // namespace brachium::io::detail
