#include "pipelines/stages/fem_problem.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "fem/fibre/tissue.hpp"
#include "fem/mesh/quality.hpp"
#include "pipelines/stages/fem_mesh.hpp"
#include "pipelines/stages/fem_quantities.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;

class Builder {
 public:
  explicit Builder(const Options& options) : options_(options) {}

  FemProblem build() {
    out_.problem.formulation = fem::formulation_named(options_.text("element"));
    guarded([&] {
      FemMesh body = fem_mesh(options_.table("mesh"), out_.problem.formulation);
      out_.mesh_source = body.source;
      out_.notes = std::move(body.notes);
      out_.problem.mesh = std::make_shared<data::Mesh>(std::move(body.mesh));
    });
    if (!out_.problem.mesh) {
      // Nothing can be said of regions and surfaces; what concerns neither is still looked at.
      conditions();
      throw InputError(std::move(mistakes_));
    }
    const std::vector<Diagnostic> broken = fem::check_quality(*out_.problem.mesh);
    mistakes_.insert(mistakes_.end(), broken.begin(), broken.end());
    if (broken.empty())
      out_.quality = fem::quality_table(*out_.problem.mesh, fem::cell_quality(*out_.problem.mesh));
    guarded([&] {
      out_.problem.materials = fem_materials(options_, *out_.problem.mesh, mistakes_, out_.materials);
    });
    const bool cells = out_.problem.mesh->type == fem::cell_type(out_.problem.formulation);
    if (!cells) {
      mistakes_.push_back({Severity::error, "cell-type-mismatch",
                           fmt::format("the mesh has {} cells, the element {} needs {}",
                                       data::to_string(out_.problem.mesh->type), options_.text("element"),
                                       data::to_string(fem::cell_type(out_.problem.formulation))),
                           std::nullopt,
                           "choose an element for these cells, or set `elevate = true` in `mesh`"});
    } else if (broken.empty()) {
      guarded([&] { tissue(); });
    }
    conditions();
    programme();
    check_outputs(options_, *out_.problem.mesh, mistakes_);
    if (mistakes_.empty()) {
      for (Diagnostic& d : fem::check(out_.problem)) {  // notes come with the solve
        if (d.severity == Severity::error) mistakes_.push_back(std::move(d));
      }
    }
    if (!mistakes_.empty()) throw InputError(std::move(mistakes_));
    return std::move(out_);
  }

 private:
  void guarded(const auto& work) {
    try {
      work();
    } catch (const InputError& e) {
      mistakes_.insert(mistakes_.end(), e.diagnostics().begin(), e.diagnostics().end());
    }
  }

  void error(const char* code, std::string message, std::string help = {}) {
    mistakes_.push_back({Severity::error, code, std::move(message), std::nullopt, std::move(help)});
  }

  static Eigen::Vector3d vector(const Options& o, const std::string& key) {
    const std::vector<double>& v = o.numbers(key);
    return {v[0], v[1], v[2]};
  }
  Eigen::Vector3d need_vector(const Options& o, const std::string& key, const std::string& owner) {
    if (o.has(key)) return vector(o, key);
    error("missing-option", fmt::format("{} needs `{}`", owner, key));
    return Eigen::Vector3d::Zero();
  }
  std::string need_text(const Options& o, const std::string& key, const std::string& owner) {
    if (const auto text = o.maybe_text(key)) return *text;
    error("missing-option", fmt::format("{} needs `{}`", owner, key));
    return {};
  }

  // ---------------------------------------------------------------- fibres and blending

  void tissue() {
    fem::TissueRules rules;
    const std::size_t before = mistakes_.size();
    const data::Mesh& mesh = *out_.problem.mesh;
    int k = 0;
    for (const Options& entry : options_.tables("fibre")) {
      const std::string kind = entry.text("kind"),
                        owner = fmt::format("entry {} of `fibre` (kind {})", ++k, kind);
      guarded([&] {
        fem::FibreRule rule;
        if (entry.has("regions")) rule.regions = regions_of(entry, mesh, owner);
        std::vector<std::string> keys{"regions", "kind"};
        if (kind == "constant") {
          keys.push_back("direction");
          rule.source = fem::ConstantFibres{need_vector(entry, "direction", owner)};
        } else if (kind == "mesh_field") {
          keys.push_back("field");
          rule.source = fem::MeshFieldFibres{need_text(entry, "field", owner)};
        } else if (kind == "mesh_lines") {
          keys.push_back("axis");
          const std::string axis = need_text(entry, "axis", owner);
          rule.source = fem::MeshLineFibres{axis == "second" ? 1 : axis == "third" ? 2 : 0};
        } else {
          keys.insert(keys.end(), {"origin", "insertion", "pennation_deg", "pennation_axis"});
          fem::HarmonicFibres harmonic{
              need_text(entry, "origin", owner), need_text(entry, "insertion", owner), {}};
          if (entry.has("pennation_deg") || entry.has("pennation_axis")) {
            if (!entry.has("pennation_deg"))
              error("missing-option", owner + " needs `pennation_deg` beside `pennation_axis`");
            harmonic.pennation =
                fem::Pennation{entry.maybe_number("pennation_deg").value_or(0.0) * std::numbers::pi / 180.0,
                               need_vector(entry, "pennation_axis", owner)};
          }
          rule.source = std::move(harmonic);
        }
        only_keys(entry, keys, owner, mistakes_);
        rules.fibres.push_back(std::move(rule));
      });
    }
    k = 0;
    for (const Options& entry : options_.tables("blend")) {
      const std::string owner = fmt::format("entry {} of `blend`", ++k);
      guarded([&] {
        fem::FractionRule rule;
        if (entry.has("regions")) rule.regions = regions_of(entry, mesh, owner);
        if (entry.has("value") == entry.has("field"))
          error("missing-option", owner + " needs either `value` or `field`");
        if (const auto field = entry.maybe_text("field"))
          rule.source = *field;
        else
          rule.source = entry.maybe_number("value").value_or(0.0);
        (entry.text("of") == "muscle" ? rules.muscle : rules.soft_tissue).push_back(std::move(rule));
      });
    }
    if (mistakes_.size() != before) return;
    fem::Tissue built = fem::build_tissue(mesh, out_.problem.formulation, rules);
    out_.problem.tissue = std::move(built.field);
    out_.directions = std::move(built.directions);
  }

  // ---------------------------------------------------------------- boundary conditions

  void conditions() {
    for (const Options& entry : options_.tables("boundary")) {
      const std::string kind = entry.text("kind"),
                        owner = fmt::format("boundary `{}` (kind {})", entry.text("name"), kind);
      fem::BoundaryCondition condition;
      condition.name = entry.text("name");
      std::vector<std::string> keys{"name", "surface", "kind"};
      const auto allow = [&](std::initializer_list<const char*> more) {
        keys.insert(keys.end(), more.begin(), more.end());
      };
      if (kind == "fixed") {
        allow({"components"});
        fem::Fixed fixed;
        if (entry.has("components")) {
          fixed.components = {false, false, false};
          for (const std::string& c : entry.texts("components"))
            fixed.components[static_cast<std::size_t>(c[0] - 'x')] = true;
        }
        condition.kind = fixed;
      } else if (kind == "displacement") {
        allow({"x_m", "y_m", "z_m"});
        fem::PrescribedDisplacement d;
        const char* const names[] = {"x_m", "y_m", "z_m"};
        bool any = false;
        for (int a = 0; a < 3; ++a) {
          if (const auto value = entry.maybe_number(names[a])) d.displacement_m[a] = *value;
          any = any || entry.has(names[a]);
        }
        if (!any) error("missing-option", owner + " needs at least one of x_m, y_m, z_m");
        condition.kind = d;
      } else if (kind == "rigid_motion") {
        allow({"translation_m", "centre_m", "axis", "angle_deg"});
        fem::RigidMotion motion;
        if (entry.has("translation_m")) motion.translation_m = vector(entry, "translation_m");
        if (entry.has("angle_deg")) {
          motion.angle_rad = entry.number("angle_deg") * std::numbers::pi / 180.0;
          motion.centre_m = need_vector(entry, "centre_m", owner);
          motion.axis = need_vector(entry, "axis", owner);
        } else if (!entry.has("translation_m")) {
          error("missing-option",
                owner + " needs `translation_m`, or `angle_deg` with `centre_m` and `axis`");
        }
        condition.kind = motion;
      } else if (kind == "symmetry") {
        condition.kind = fem::SymmetryPlane{};
      } else if (kind == "traction") {
        allow({"traction_pa"});
        condition.kind = fem::DeadTraction{need_vector(entry, "traction_pa", owner), false};
      } else if (kind == "force") {
        allow({"force_n"});
        condition.kind = fem::DeadTraction{need_vector(entry, "force_n", owner), true};
      } else if (kind == "pressure") {
        allow({"pressure_pa"});
        if (!entry.has("pressure_pa")) error("missing-option", owner + " needs `pressure_pa`");
        condition.kind = fem::FollowerPressure{entry.maybe_number("pressure_pa").value_or(0.0)};
      } else {
        allow({"force_n_m3"});
        condition.kind = fem::BodyForce{need_vector(entry, "force_n_m3", owner)};
      }
      only_keys(entry, keys, owner, mistakes_);
      if ((kind == "weight") == entry.has("surface"))
        error("missing-option", kind == "weight" ? owner + " acts on the whole body: it takes no `surface`"
                                                 : owner + " needs `surface`");
      condition.surface = entry.maybe_text("surface").value_or("");
      out_.problem.conditions.push_back(std::move(condition));
    }
  }

  // ---------------------------------------------------------------- load programme

  void programme() {
    const data::Mesh& mesh = *out_.problem.mesh;
    for (const Options& entry : options_.tables("phase")) {
      fem::Phase phase;
      phase.name = entry.text("name");
      for (const auto& [name, value] : entry.number_map("amplitude")) {
        if (name != "*") {
          phase.amplitude[name] = value;
          continue;
        }
        error("missing-option",
              fmt::format("phase `{}`: `amplitude` needs the names of the conditions it moves", phase.name),
              "amplitude = { pull = 1.0 }");
      }
      const auto& activation = entry.number_map("activation");
      if (const auto all = activation.find("*"); all != activation.end()) {
        bool any = false;
        for (std::size_t r = 0; r < mesh.regions.size() && r < out_.problem.materials.size(); ++r) {
          if (!fem::is_active(out_.problem.materials[r].material)) continue;
          phase.activation[mesh.regions[r]] = all->second;
          any = true;
        }
        if (!any && out_.problem.materials.size() == mesh.regions.size())
          error("passive-material",
                fmt::format("phase `{}` sets an activation, but no region has an active law", phase.name));
      }
      for (const auto& [region, value] : activation) {
        if (region != "*") phase.activation[region] = value;
      }
      phase.release = entry.texts("release");
      phase.steps = static_cast<int>(entry.integer("steps"));
      phase.duration_s = entry.number("duration_s");
      out_.problem.programme.push_back(std::move(phase));
    }
  }

  const Options& options_;
  FemProblem out_;
  std::vector<Diagnostic> mistakes_;
};

}  // namespace

std::vector<std::string> regions_of(const Options& entry, const data::Mesh& mesh, const std::string& what) {
  if (!entry.has("regions")) return mesh.regions;
  try {
    return data::match_names(entry.texts("regions"), mesh.regions, "region of the mesh");
  } catch (const InputError& e) {
    std::vector<Diagnostic> named = e.diagnostics();
    for (Diagnostic& d : named) {
      d.code = "missing-region";
      d.message = what + ": " + d.message;
    }
    throw InputError(std::move(named));
  }
}

void only_keys(const Options& entry, const std::vector<std::string>& allowed, const std::string& owner,
               std::vector<Diagnostic>& mistakes) {
  for (const auto& [key, value] : entry.values()) {
    if (std::find(allowed.begin(), allowed.end(), key) != allowed.end()) continue;
    mistakes.push_back({Severity::error, "unused-option", fmt::format("{} has no use for `{}`", owner, key),
                        std::nullopt, fmt::format("it takes {}", fmt::join(allowed, ", "))});
  }
}

FemProblem build_fem_problem(const Options& options) {
  return Builder(options).build();
}

}  // namespace brachium::pipelines
