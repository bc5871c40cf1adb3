/// Boundary conditions and load programme of fem.solve.

#include <fmt/format.h>

#include <numbers>

#include "pipelines/stages/fem_problem.hpp"

namespace brachium::pipelines {
namespace {

/// One entry of `boundary`.
class ConditionReader {
 public:
  ConditionReader(const Options& entry, Mistakes& mistakes)
      : entry_(entry),
        kind_(entry.text("kind")),
        owner_(fmt::format("boundary `{}` (kind {})", entry.text("name"), kind_)),
        mistakes_(mistakes) {}

  fem::BoundaryCondition read() {
    fem::BoundaryCondition condition{entry_.text("name"), entry_.maybe_text("surface").value_or(""), {}};
    if (kind_ == "fixed")
      condition.kind = fixed();
    else if (kind_ == "displacement")
      condition.kind = displacement();
    else if (kind_ == "rigid_motion")
      condition.kind = rigid_motion();
    else if (kind_ == "symmetry")
      condition.kind = fem::SymmetryPlane{};
    else if (kind_ == "traction" || kind_ == "force")
      condition.kind =
          fem::DeadTraction{vector(kind_ == "force" ? "force_n" : "traction_pa"), kind_ == "force"};
    else if (kind_ == "pressure")
      condition.kind = pressure();
    else
      condition.kind = fem::BodyForce{vector("force_n_m3")};
    mistakes_.only_keys(entry_, keys_, owner_);
    surface();
    return condition;
  }

 private:
  void surface() {
    if (kind_ == "weight" && entry_.has("surface"))
      mistakes_.error(entry_, "unused-option", owner_ + " acts on the whole body: it takes no `surface`");
    if (kind_ != "weight" && kind_ != "rigid_motion") mistakes_.need(entry_, "surface", owner_);
  }

  Eigen::Vector3d vector(const std::string& key) {
    keys_.push_back(key);
    mistakes_.need(entry_, key, owner_);
    return vector_of(entry_, key);
  }

  fem::Fixed fixed() {
    keys_.push_back("components");
    fem::Fixed fixed;
    if (!entry_.has("components")) return fixed;
    fixed.components = {false, false, false};
    for (const std::string& c : entry_.texts("components"))
      fixed.components[static_cast<std::size_t>(c[0] - 'x')] = true;
    return fixed;
  }

  fem::PrescribedDisplacement displacement() {
    const char* const names[] = {"x_m", "y_m", "z_m"};
    fem::PrescribedDisplacement d;
    bool any = false;
    for (int a = 0; a < 3; ++a) {
      keys_.push_back(names[a]);
      if (const auto value = entry_.maybe_number(names[a])) d.displacement_m[a] = *value;
      any = any || entry_.has(names[a]);
    }
    if (!any) mistakes_.error(entry_, "missing-option", owner_ + " needs at least one of x_m, y_m, z_m");
    return d;
  }

  fem::RigidMotion rigid_motion() {
    keys_.insert(keys_.end(), {"translation_m", "centre_m", "axis", "angle_deg"});
    fem::RigidMotion motion;
    motion.translation_m = vector_of(entry_, "translation_m");
    if (entry_.has("angle_deg")) {
      motion.angle_rad = entry_.number("angle_deg") * std::numbers::pi / 180.0;
      mistakes_.need(entry_, "centre_m", owner_);
      mistakes_.need(entry_, "axis", owner_);
      motion.centre_m = vector_of(entry_, "centre_m");
      if (entry_.has("axis")) motion.axis = vector_of(entry_, "axis");
    } else if (!entry_.has("translation_m")) {
      mistakes_.error(entry_, "missing-option",
                      owner_ + " needs `translation_m`, or `angle_deg` with `centre_m` and `axis`");
    } else {
      for (const std::string key : {"centre_m", "axis"}) {
        if (entry_.has(key))
          mistakes_.error(entry_, "unused-option",
                          fmt::format("{} has no use for `{}` without an angle", owner_, key),
                          "give `angle_deg` beside it");
      }
    }
    return motion;
  }

  fem::FollowerPressure pressure() {
    keys_.push_back("pressure_pa");
    mistakes_.need(entry_, "pressure_pa", owner_);
    return {entry_.maybe_number("pressure_pa").value_or(0.0)};
  }

  const Options& entry_;
  const std::string kind_, owner_;
  Mistakes& mistakes_;
  std::vector<std::string> keys_{"name", "surface", "kind"};
};

}  // namespace

std::vector<fem::BoundaryCondition> fem_conditions(const Options& options, Mistakes& mistakes) {
  std::vector<fem::BoundaryCondition> conditions;
  for (const Options& entry : options.tables("boundary"))
    conditions.push_back(ConditionReader(entry, mistakes).read());
  return conditions;
}

std::vector<fem::Phase> fem_programme(const Options& options, const data::Mesh& mesh,
                                      const std::vector<fem::RegionMaterial>& materials, Mistakes& mistakes) {
  std::vector<fem::Phase> programme;
  const bool known = materials.size() == mesh.regions.size();
  for (const Options& entry : options.tables("phase")) {
    fem::Phase phase;
    phase.name = entry.text("name");
    const auto& amplitude = entry.number_map("amplitude");
    for (const auto& [name, value] : amplitude) {
      if (name != "*") phase.amplitude[name] = value;
    }
    if (amplitude.contains("*"))
      mistakes.error(
          entry, "missing-option",
          fmt::format("phase `{}`: `amplitude` needs the names of the conditions it moves", phase.name),
          "amplitude = { pull = 1.0 }");
    const auto& activation = entry.number_map("activation");
    if (const auto all = activation.find("*"); all != activation.end() && known) {
      for (std::size_t r = 0; r < mesh.regions.size(); ++r) {
        if (fem::is_active(materials[r].material)) phase.activation[mesh.regions[r]] = all->second;
      }
      if (phase.activation.empty())
        mistakes.error(
            entry, "passive-material",
            fmt::format("phase `{}` sets `activation`, but no region has an active law", phase.name));
    }
    for (const auto& [region, value] : activation) {
      if (region != "*") phase.activation[region] = value;
    }
    phase.release = entry.texts("release");
    phase.steps = static_cast<int>(entry.integer("steps"));
    phase.duration_s = entry.number("duration_s");
    programme.push_back(std::move(phase));
  }
  return programme;
}

}  // namespace brachium::pipelines
