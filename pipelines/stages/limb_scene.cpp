#include "pipelines/stages/limb_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fem/material/parameter_sets.hpp"
#include "pipelines/stages/limb_scene_parts.hpp"

namespace brachium::pipelines {
namespace limb_parts {

double millimetres(io::TomlTable& table, const std::string& key, bool may_be_zero,
                   std::optional<double> fallback) {
  if (fallback && !table.has(key)) return *fallback;
  const double value = table.require_number(key);
  if (std::isnan(value) || (may_be_zero ? value >= 0.0 : value > 0.0)) return 1e-3 * value;
  table.error(
      "out-of-range",
      fmt::format("`{}` must be {}, not {}", key, may_be_zero ? "0 or greater" : "greater than 0", value),
      key);
  return std::numeric_limits<double>::quiet_NaN();
}

std::optional<Eigen::VectorXd> places(io::TomlTable& table, const std::string& key, Eigen::Index count,
                                      bool required) {
  if (required && !table.has(key)) table.error("missing-key", fmt::format("`{}` is missing", key));
  const auto values = table.numbers(key);
  if (!values) return std::nullopt;
  if (static_cast<Eigen::Index>(values->size()) != count) {
    table.error("wrong-size", fmt::format("`{}` has {} numbers, not {}", key, values->size(), count), key);
    return std::nullopt;
  }
  return 1e-3 * Eigen::Map<const Eigen::VectorXd>(values->data(), count);
}

void check_unique(const std::string& kind, const std::string& name, std::vector<std::string>& seen,
                  io::TomlTable& table) {
  if (name.empty()) return;
  if (std::find(seen.begin(), seen.end(), name) != seen.end())
    table.error("duplicate-" + kind, fmt::format("{} `{}` is defined twice", kind, name), "name",
                "names are unique in a scene");
  seen.push_back(name);
}

}  // namespace limb_parts

namespace {

using io::TomlTable;
using limb_parts::Draft;
using limb_parts::millimetres;
using limb_parts::places;

constexpr double degree = std::numbers::pi / 180.0;

/// Hinge and humerus in the bones' coordinates, and from them the way to the arm's frame.
void read_frame(TomlTable& table, Draft& draft) {
  const auto direction = [&](const std::string& key, const Eigen::Vector3d& usual) {
    const auto given = places(table, key, 3, false);
    if (!given) return usual;
    if (given->norm() > 0.0) return Eigen::Vector3d(given->normalized());
    table.error("out-of-range", fmt::format("`{}` must not be zero", key), key);
    return usual;
  };
  const auto centre = places(table, "hinge_centre_mm", 3, false);
  const Eigen::Vector3d axis = direction("hinge_axis", Eigen::Vector3d::UnitZ());
  const Eigen::Vector3d proximal = direction("proximal_direction", Eigen::Vector3d::UnitY());
  const Eigen::Vector3d anterior = proximal.cross(axis);
  if (!(anterior.norm() > 0.5)) {
    table.error("out-of-range", "`hinge_axis` and `proximal_direction` are nearly parallel", "hinge_axis",
                "the axis runs across the arm");
    return;
  }
  Eigen::Matrix3d rows;
  rows << anterior.normalized().transpose(), axis.cross(anterior).normalized().transpose(), axis.transpose();
  draft.to_arm.linear() = rows;
  draft.to_arm.translation() =
      centre ? Eigen::Vector3d(-rows * Eigen::Vector3d(*centre)) : Eigen::Vector3d::Zero();
}

void read_header(TomlTable& root, Draft& draft) {
  auto table = root.table("limb");
  if (!table) {
    if (!root.has("limb")) root.error("missing-key", "the table [limb] is missing");
    return;
  }
  LimbScene& scene = draft.scene;
  scene.title = table->require_text("title");
  table->require_text("source");
  if (!table->has("range_deg")) table->error("missing-key", "`range_deg` is missing in [limb]");
  if (const auto range = table->numbers("range_deg")) {
    if (range->size() == 2 && (*range)[0] < (*range)[1]) {
      scene.range = {(*range)[0] * degree, (*range)[1] * degree};
    } else {
      table->error("out-of-range", "`range_deg` must be two increasing angles", "range_deg");
    }
  }
  scene.forearm_length_m = millimetres(*table, "forearm_length_mm", false, 0.0);
  read_frame(*table, draft);
  table->finish();
  if (auto load = root.table("load")) {
    scene.load_arm_m = millimetres(*load, "arm_mm", false);
    load->finish();
  }
}

void read_path(TomlTable& table, fem::CableGeometry& cable, bool has_origin) {
  if (const auto at = places(table, "origin_mm", 2, has_origin)) cable.origin_m = *at;
  if (auto insertion = table.table("insertion")) {
    cable.distance_m = millimetres(*insertion, "distance_mm", false);
    cable.offset_rad = insertion->require_number("ahead_deg") * degree;
    insertion->finish();
  } else if (!table.has("insertion")) {
    table.error("missing-key", "`insertion` is missing");
  }
  if (auto obstacle = table.table("obstacle")) {
    if (const auto at = places(*obstacle, "centre_mm", 2)) cable.obstacle_m = *at;
    cable.radius_m = millimetres(*obstacle, "radius_mm", false);
    const std::string side = obstacle->require_text("side");
    const std::vector<std::string> sides{"anterior", "posterior"};
    if (!side.empty() && side != sides[0] && side != sides[1])
      obstacle->error("unknown-value", fmt::format("a path cannot pass on the side `{}`", side), "side",
                      data::suggest(side, sides));
    cable.anterior = side != "posterior";
    obstacle->finish();
  } else if (!table.has("obstacle")) {
    table.error("missing-key", "`obstacle` is missing", {},
                "what the tendon runs around: a circle of small radius where there is nothing");
  }
}

void read_belly(TomlTable& table, fem::MuscleBody& body) {
  auto belly = table.table("belly");
  if (!belly) {
    if (!table.has("belly")) table.error("missing-key", "`belly` is missing");
    return;
  }
  body.belly_length_m = millimetres(*belly, "length_mm", false);
  if (!belly->has("radii_mm")) belly->error("missing-key", "`radii_mm` is missing");
  if (const auto radii = belly->numbers("radii_mm")) {
    if (radii->size() < 3 || *std::min_element(radii->begin(), radii->end()) <= 0.0)
      belly->error("out-of-range", "`radii_mm` must be three radii or more, each above 0", "radii_mm",
                   "at even places from the proximal to the distal end");
    for (const double r : *radii) body.profile_m.push_back(1e-3 * r);
  }
  body.flatness = belly->positive("flatness", 1.0);
  if (auto sheets = belly->table("aponeurosis")) {
    fem::Aponeurosis& a = body.aponeurosis;
    const auto share = [&](const char* key, double usual) {
      const double value = sheets->number(key).value_or(usual);
      if (value > 0.0 && value <= 0.9) return value;
      sheets->error("out-of-range", fmt::format("`{}` must be above 0 and at most 0.9, not {}", key, value),
                    key);
      return usual;
    };
    if (!sheets->has("thickness_norm"))
      sheets->error("missing-key", "`thickness_norm` is missing in `aponeurosis`");
    a.thickness_norm = share("thickness_norm", 0.1);
    a.origin_norm = share("origin_norm", a.origin_norm);
    a.insertion_norm = share("insertion_norm", a.insertion_norm);
    if (a.origin_norm + a.insertion_norm > 1.0)
      sheets->error("out-of-range",
                    "`origin_norm` and `insertion_norm` together must not exceed 1: the sheets overlap",
                    "insertion_norm");
    sheets->finish();
  }
  belly->finish();
}

/// Tendons are meshed in the muscle-tendon complex only; the rigid tendon is what the path leaves.
void read_tendons(TomlTable& table, LimbVariant variant, fem::MuscleBody& body) {
  auto tendons = table.table("tendons");
  if (!tendons) {
    if (!table.has("tendons") && variant == LimbVariant::mtc)
      table.error("missing-key",
                  fmt::format("muscle `{}` has no `tendons`, which the variant mtc meshes", body.name));
    return;
  }
  const double origin = millimetres(*tendons, "origin_mm", true),
               insertion = millimetres(*tendons, "insertion_mm", true),
               transition = millimetres(*tendons, "transition_mm", true, 0.0);
  const auto pre_stretch = tendons->number("pre_stretch");
  tendons->finish();
  if (variant != LimbVariant::mtc) return;
  body.tendon_origin_m = origin;
  body.tendon_insertion_m = insertion;
  body.transition_m = transition;
  if (pre_stretch) body.pre_stretch = *pre_stretch;
}

void read_material(TomlTable& table, fem::MuscleBody& body) {
  auto material = table.table("material");
  if (!material) {
    if (!table.has("material")) table.error("missing-key", "`material` is missing");
    return;
  }
  const std::string set = material->require_text("set");
  if (!set.empty()) {
    try {
      body.material = fem::muscle_tendon_named(set);
    } catch (const data::InputError& e) {
      const data::Diagnostic& d = e.diagnostics().front();
      material->error(d.code, d.message, "set", d.help);
    }
  }
  body.bulk_modulus_pa = material->positive("bulk_modulus_Pa");
  if (material->has("max_stress_Pa")) body.material.max_stress_pa = material->positive("max_stress_Pa");
  if (material->has("optimal_stretch"))
    body.material.force_length.optimal_stretch = material->positive("optimal_stretch");
  material->finish();
}

void read_muscle(TomlTable& table, const fem::LimbMesh& mesh, std::vector<std::string>& seen, Draft& draft) {
  const std::size_t before = draft.diagnostics.size();
  LimbMuscle muscle;
  fem::MuscleBody& body = muscle.body;
  body.name = table.require_text("name");
  limb_parts::check_unique("muscle", body.name, seen, table);
  muscle.source = table.require_text("source");
  const std::string action = table.require_text("action");
  const std::vector<std::string> actions{"flexor", "extensor"};
  if (!action.empty() && action != actions[0] && action != actions[1])
    table.error("unknown-value", fmt::format("muscle `{}` cannot be a `{}`", body.name, action), "action",
                data::suggest(action, actions));
  muscle.flexor = action != "extensor";
  body.pre_stretch = table.require_number("pre_stretch");
  read_path(table, body.cable, !table.has("mesh"));
  if (table.has("mesh")) {
    for (const char* key : {"belly", "tendons"}) {
      if (table.has(key))
        table.error("contradiction", fmt::format("muscle `{}` has a `mesh` and `{}`", body.name, key), key,
                    "a mesh shows both; its tendons are regions named in `mesh.tendons`");
      table.know(key);
    }
  } else {
    read_belly(table, body);
    read_tendons(table, draft.scene.variant, body);
  }
  read_material(table, body);
  body.standoff_m = millimetres(table, "standoff_mm", true, 0.0);
  body.fibres = table.text("fibres").value_or("harmonic");
  // A flexor is shortest in full flexion, an extensor in full extension.
  body.reference_rad = muscle.flexor ? draft.scene.range.upper_rad : draft.scene.range.lower_rad;
  body.belly_cells = mesh.belly_cells;
  body.section.core_cells = mesh.core_cells;
  body.section.ring_cells = mesh.ring_cells;
  if (table.has("mesh") && draft.diagnostics.size() == before)
    limb_parts::read_muscle_mesh(table, draft, muscle);
  table.know("mesh");
  table.finish();
  if (draft.diagnostics.size() == before && draft.scene.range.lower_rad < draft.scene.range.upper_rad) {
    try {
      fem::check(body, draft.scene.range);
    } catch (const data::InputError& e) {
      for (const data::Diagnostic& d : e.diagnostics()) table.error(d.code, d.message, "name", d.help);
    }
  }
  draft.scene.muscles.push_back(std::move(muscle));
}

}  // namespace

LimbVariant parse_limb_variant(const std::string& name) {
  if (name == "rigid_tendon") return LimbVariant::rigid_tendon;
  if (name == "mtc") return LimbVariant::mtc;
  const std::vector<std::string> known{"rigid_tendon", "mtc"};
  throw data::InputError("unknown-value", fmt::format("there is no variant `{}` of the limb", name),
                         data::suggest(name, known));
}

std::string to_string(LimbVariant variant) {
  return variant == LimbVariant::mtc ? "mtc" : "rigid_tendon";
}

const LimbMuscle& LimbScene::muscle(const std::string& name) const {
  for (const LimbMuscle& m : muscles)
    if (m.body.name == name) return m;
  throw data::InputError("missing-muscle", fmt::format("the limb `{}` has no muscle `{}`", title, name),
                         data::suggest(name, muscle_names()));
}

std::vector<std::string> LimbScene::muscle_names() const {
  std::vector<std::string> names;
  for (const LimbMuscle& m : muscles) names.push_back(m.body.name);
  return names;
}

namespace {

LimbScene limb_of(const io::TomlNode& tree, const std::string& file_name, const std::filesystem::path& folder,
                  LimbVariant variant, const fem::LimbMesh& mesh) {
  Draft draft;
  draft.folder = folder;
  draft.scene.file = file_name;
  draft.scene.variant = variant;
  TomlTable root(tree, draft.diagnostics);
  read_header(root, draft);
  limb_parts::read_bones(root, draft);
  std::vector<std::string> seen;
  if (!root.has("muscle")) root.error("missing-key", "the limb has no [[muscle]]");
  for (TomlTable& muscle : root.tables("muscle")) read_muscle(muscle, mesh, seen, draft);
  root.finish();
  io::raise_if_errors(draft.diagnostics);
  return std::move(draft.scene);
}

}  // namespace

LimbScene parse_limb(const std::string& text, const std::string& file_name,
                     const std::filesystem::path& folder, LimbVariant variant, const fem::LimbMesh& mesh) {
  return limb_of(io::parse_toml(text, file_name), file_name, folder, variant, mesh);
}

LimbScene read_limb(const std::filesystem::path& file, LimbVariant variant, const fem::LimbMesh& mesh) {
  return limb_of(io::read_toml(file), file.string(), file.parent_path(), variant, mesh);
}

}  // namespace brachium::pipelines
