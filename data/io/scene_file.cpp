#include "data/io/scene_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>

#include "data/io/scene_parts.hpp"

namespace brachium::io {
namespace detail {

double DomainReader::check(const std::string& key, bool strictly, double value) {
  if (std::isnan(value)) return value;  // missing or of the wrong type: reported already
  if (strictly ? value > 0.0 : value >= 0.0) return value;
  table.error("out-of-range",
              fmt::format("`{}` of {} must be {}, not {}", key, owner,
                          strictly ? "greater than 0" : "0 or greater", value),
              key);
  return std::numeric_limits<double>::quiet_NaN();
}

void check_unique(const std::string& kind, const std::string& name, std::vector<std::string>& seen,
                  TomlTable& table) {
  if (name.empty()) return;
  if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
    table.error("duplicate-" + kind, fmt::format("{} `{}` is defined twice", kind, name), "name",
                "names are unique in a scene");
  }
  seen.push_back(name);
}

}  // namespace detail

namespace {

using data::InputError;
using detail::check_unique;
using detail::DomainReader;
using detail::SceneDraft;

constexpr double radian = std::numbers::pi / 180.0;
constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> names_of(const std::vector<data::Coordinate>& coordinates) {
  std::vector<std::string> names;
  for (const auto& c : coordinates) names.push_back(c.name);
  return names;
}

void read_header(TomlTable& root, SceneDraft& draft) {
  auto table = root.table("scene");
  if (!table) {
    if (!root.has("scene")) root.error("missing-key", "the table [scene] is missing");
    return;
  }
  data::Scene& scene = draft.scene;
  DomainReader domain{*table, "the scene"};
  scene.title = table->require_text("title");
  if (!table->has("wanted")) {
    table->error("missing-key", "`wanted` is missing in `scene`", {},
                 "name the wanted quantities, e.g. [\"elbow_flexion.moment\"]");
  }
  scene.wanted = table->texts("wanted").value_or(std::vector<std::string>{});
  if (table->has("wanted") && scene.wanted.empty()) {
    table->error("out-of-range", "`wanted` must name at least one quantity", "wanted");
  }
  if (table->has("body_mass_kg")) {
    scene.body_mass_kg = domain.positive("body_mass_kg");
    scene.body_mass_source = table->require_text("body_mass_source");
  } else if (const auto source = table->text("body_mass_source")) {
    table->error("missing-key", "`body_mass_source` is given, but `body_mass_kg` is not", "body_mass_source");
  }
  scene.body_mass_relative_sd = domain.non_negative("body_mass_relative_sd", 0.0);
  scene.upper_arm_inclination_rad = table->number("upper_arm_inclination_deg").value_or(0.0) * radian;
  table->finish();
}

void read_coordinates(TomlTable& root, SceneDraft& draft) {
  std::vector<TomlTable> tables = root.tables("coordinate");
  if (!root.has("coordinate")) root.error("missing-key", "the scene has no [[coordinate]]");
  std::vector<std::string> seen;
  for (TomlTable& table : tables) {
    data::Coordinate c;
    c.name = table.require_text("name");
    DomainReader domain{table, fmt::format("coordinate `{}`", c.name)};
    check_unique("coordinate", c.name, seen, table);
    if (!table.has("range_deg"))
      table.error("missing-key", fmt::format("`range_deg` is missing in coordinate `{}`", c.name));
    if (const auto range = table.numbers("range_deg")) {
      if (range->size() != 2 || !((*range)[0] < (*range)[1])) {
        table.error("out-of-range",
                    fmt::format("`range_deg` of coordinate `{}` must be two increasing angles", c.name),
                    "range_deg");
      } else {
        c.lower_rad = (*range)[0] * radian;
        c.upper_rad = (*range)[1] * radian;
      }
    }
    c.angle_signal = table.text("angle_signal").value_or(c.name);
    if (const auto parent = table.text("parent")) {
      c.parent = *parent;
      c.distance_from_parent_m = domain.positive("distance_from_parent_m");
      // A parent stands before its child: then a chain cannot close on itself.
      const auto known = names_of(draft.scene.coordinates);
      if (std::find(known.begin(), known.end(), *parent) == known.end()) {
        table.error("unknown-coordinate",
                    fmt::format("coordinate `{}` has the parent `{}`, which is not defined before it", c.name,
                                *parent),
                    "parent", data::suggest(*parent, known));
      }
    } else if (table.number("distance_from_parent_m")) {
      table.error("missing-key",
                  fmt::format("`distance_from_parent_m` of coordinate `{}` needs a `parent`", c.name),
                  "distance_from_parent_m");
    }
    table.finish();
    draft.scene.coordinates.push_back(std::move(c));
  }
}

// The coordinate a segment, load or muscle belongs to; the only one where it is not named.
std::string coordinate_of(TomlTable& table, const std::string& owner, const SceneDraft& draft) {
  const auto known = names_of(draft.scene.coordinates);
  const auto name = table.text("coordinate");
  if (!name) {
    if (known.size() == 1) return known.front();
    if (!table.has("coordinate")) {
      table.error("missing-key", fmt::format("`coordinate` is missing in {}", owner), {},
                  data::suggest("", known));
    }
    return {};
  }
  if (std::find(known.begin(), known.end(), *name) == known.end()) {
    table.error("unknown-coordinate",
                fmt::format("{} refers to coordinate `{}`, which the scene does not have", owner, *name),
                "coordinate", data::suggest(*name, known));
  }
  return *name;
}

// Exactly one of several keys; returns the one that is there, or an empty text with an error.
std::string exactly_one(TomlTable& table, const std::string& owner, const std::vector<std::string>& keys) {
  std::string found, list;
  int count = 0;
  for (const std::string& key : keys) {
    list += (list.empty() ? "`" : " or `") + key + "`";
    if (!table.has(key)) continue;
    if (++count == 1) found = key;
  }
  if (count == 1) return found;
  table.error(count == 0 ? "missing-key" : "contradiction",
              fmt::format("{} {} {}", owner, count == 0 ? "needs" : "takes only one of", list), found);
  for (const std::string& key : keys) {
    if (count > 1 && table.has(key)) table.number(key);
  }
  return {};
}

void read_segments(TomlTable& root, SceneDraft& draft) {
  std::vector<std::string> seen;
  for (TomlTable& table : root.tables("segment")) {
    data::Segment s;
    s.name = table.require_text("name");
    const std::string owner = fmt::format("segment `{}`", s.name);
    DomainReader domain{table, owner};
    check_unique("segment", s.name, seen, table);
    s.coordinate = coordinate_of(table, owner, draft);
    s.source = table.require_text("source");

    const std::string mass = exactly_one(table, owner, {"mass_kg", "mass_fraction_of_body"});
    if (mass == "mass_kg") s.mass_kg = domain.positive("mass_kg");
    if (mass == "mass_fraction_of_body") {
      s.body_mass_fraction = domain.positive("mass_fraction_of_body");
      if (!(draft.scene.body_mass_kg > 0.0)) {
        table.error("missing-key",
                    fmt::format("{} takes its mass from the body mass, which [scene] does not give", owner),
                    "mass_fraction_of_body", "add `body_mass_kg` and `body_mass_source` to [scene]");
      }
      s.mass_kg = s.body_mass_fraction * draft.scene.body_mass_kg;
    }
    s.mass_relative_sd = domain.non_negative("mass_relative_sd", 0.0);

    // Fractions are of the segment's own length, measured from its proximal end, which lies `offset_m` from
    // the joint.
    const double offset = domain.non_negative("offset_m", 0.0);
    const double length = table.has("length_m") ? domain.positive("length_m") : not_given;
    const auto of_length = [&](const std::string& key) {
      const double fraction = domain.positive(key);
      if (!table.has("length_m")) {
        table.error("missing-key", fmt::format("`{}` of {} needs `length_m`", key, owner), key);
      }
      return fraction * length;
    };
    const std::string centre = exactly_one(table, owner, {"centre_of_mass_m", "centre_of_mass_fraction"});
    if (centre == "centre_of_mass_m") s.centre_of_mass_m = offset + domain.positive("centre_of_mass_m");
    if (centre == "centre_of_mass_fraction")
      s.centre_of_mass_m = offset + of_length("centre_of_mass_fraction");
    s.centre_of_mass_sd_m = domain.non_negative("centre_of_mass_sd_m", 0.0);

    const std::string inertia =
        exactly_one(table, owner, {"inertia_kg_m2", "radius_of_gyration_m", "radius_of_gyration_fraction"});
    if (inertia == "inertia_kg_m2") s.inertia_kg_m2 = domain.non_negative("inertia_kg_m2");
    if (inertia == "radius_of_gyration_m" || inertia == "radius_of_gyration_fraction") {
      const double k = inertia == "radius_of_gyration_m" ? domain.positive(inertia) : of_length(inertia);
      s.inertia_kg_m2 = s.mass_kg * k * k;
    }
    s.inertia_relative_sd = domain.non_negative("inertia_relative_sd", 0.0);
    table.finish();
    draft.scene.segments.push_back(std::move(s));
  }
}

void read_loads(TomlTable& root, SceneDraft& draft) {
  std::vector<std::string> seen;
  for (TomlTable& table : root.tables("load")) {
    data::Load l;
    l.name = table.require_text("name");
    const std::string owner = fmt::format("load `{}`", l.name);
    DomainReader domain{table, owner};
    check_unique("load", l.name, seen, table);
    l.coordinate = coordinate_of(table, owner, draft);
    l.source = table.require_text("source");
    if (table.has("mass_kg") == table.has("mass_condition")) {
      table.error(table.has("mass_kg") ? "contradiction" : "missing-key",
                  fmt::format("{} {} `mass_kg` or `mass_condition`", owner,
                              table.has("mass_kg") ? "takes only one of" : "needs"),
                  {}, "a fixed mass, or the trial condition it is read from");
      table.number("mass_kg");
      table.text("mass_condition");
    } else if (table.has("mass_kg")) {
      l.mass_kg = domain.non_negative("mass_kg");
    } else {
      l.mass_condition = table.require_text("mass_condition");
    }
    l.mass_relative_sd = domain.non_negative("mass_relative_sd", 0.0);
    l.distance_m = domain.positive("distance_m");
    l.distance_sd_m = domain.non_negative("distance_sd_m", 0.0);
    table.finish();
    draft.scene.loads.push_back(std::move(l));
  }
}

// `wanted` names: coordinate.moment, coordinate.angle, muscle.force, ...
void check_wanted(TomlTable& root, SceneDraft& draft) {
  const data::Scene& scene = draft.scene;
  std::vector<std::string> known;
  for (const auto& c : scene.coordinates) {
    for (const char* what : {"moment", "angle"}) known.push_back(fmt::format("{}.{}", c.name, what));
  }
  for (const auto& m : scene.muscles) {
    for (const char* what : {"force", "moment", "activation"})
      known.push_back(fmt::format("{}.{}", m.name, what));
  }
  const TomlNode* header = root.node().find("scene");
  const TomlNode* list = header ? header->find("wanted") : nullptr;
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < scene.wanted.size(); ++i) {
    const std::string& wanted = scene.wanted[i];
    if (std::find(known.begin(), known.end(), wanted) != known.end()) continue;
    data::Diagnostic d{data::Severity::error, "unknown-quantity",
                       fmt::format("`{}` is not a quantity this scene can give", wanted), std::nullopt,
                       data::suggest(wanted, known)};
    if (list) d.where = i < list->items.size() ? list->items[i].where : list->where;
    draft.diagnostics.push_back(std::move(d));
  }
}

}  // namespace

data::Scene parse_scene(const std::string& text, const std::string& file_name,
                        const std::filesystem::path& folder, std::span<const std::string> channels) {
  const TomlNode tree = parse_toml(text, file_name);
  SceneDraft draft;
  draft.folder = folder;
  draft.scene.file = file_name;
  TomlTable root(tree, draft.diagnostics, "a scene");
  read_header(root, draft);
  read_coordinates(root, draft);
  read_segments(root, draft);
  read_loads(root, draft);
  detail::read_muscles(root, draft, channels);
  check_wanted(root, draft);
  root.finish();
  raise_if_errors(draft.diagnostics);
  detail::leave_out_unwanted(draft.scene);
  draft.scene.notes.insert(draft.scene.notes.begin(), draft.diagnostics.begin(), draft.diagnostics.end());
  return std::move(draft.scene);
}

data::Scene read_scene(const std::filesystem::path& file, std::span<const std::string> channels) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code ignored;
  if (!stream || std::filesystem::is_directory(file, ignored)) {
    throw InputError("missing-file", fmt::format("cannot read the scene `{}`", file.string()),
                     "check the path");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  return parse_scene(text.str(), file.string(), file.parent_path(), channels);
}

}  // namespace brachium::io
