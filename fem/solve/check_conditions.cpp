/// Boundary conditions and load programme.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "fem/element/quadrature.hpp"
#include "fem/solve/guided_motion.hpp"
#include "fem/solve/problem_check.hpp"

namespace brachium::fem {
namespace {

std::vector<std::string> condition_names(const Problem& problem) {
  std::vector<std::string> names;
  for (const BoundaryCondition& c : problem.conditions) names.push_back(c.name);
  return names;
}

/// Values that are not finite, or mean nothing.
void check_values(const Problem& problem, const BoundaryCondition& c, Findings& found) {
  const auto bad = [&](const std::string& what, const std::string& help = "") {
    found.error("condition-value", fmt::format("`{}`: {}", c.name, what), help);
  };
  if (const auto* fixed = std::get_if<Fixed>(&c.kind)) {
    if (std::none_of(fixed->components.begin(), fixed->components.end(), [](bool b) { return b; }))
      bad("fixes no component");
  } else if (const auto* moved = std::get_if<PrescribedDisplacement>(&c.kind)) {
    if (moved->displacement_m.array().isNaN().all()) bad("prescribes no component");
    if (moved->displacement_m.array().isInf().any()) bad("an infinite displacement");
  } else if (const auto* field = std::get_if<PrescribedField>(&c.kind)) {
    const std::size_t points = condition_points(*problem.mesh, c.surface).size();
    if (field->displacement_m.cols() != static_cast<Eigen::Index>(points)) {
      bad(fmt::format("{} displacements for the {} points of `{}`", field->displacement_m.cols(), points,
                      c.surface));
    }
  } else if (const auto* rigid = std::get_if<RigidMotion>(&c.kind)) {
    if (!(rigid->translation_m.allFinite() && rigid->centre_m.allFinite() && std::isfinite(rigid->angle_rad)))
      bad("a value is not finite");
    if (!(rigid->axis.allFinite() && rigid->axis.norm() > 0.0)) bad("the axis of rotation has no direction");
  } else if (const auto* guided = std::get_if<GuidedMotion>(&c.kind)) {
    if (const std::string what = guided_motion_fault(*guided); !what.empty()) bad(what);
  } else if (const auto* traction = std::get_if<DeadTraction>(&c.kind)) {
    if (!traction->traction_pa.allFinite()) bad("the traction is not finite");
  } else if (const auto* pressure = std::get_if<FollowerPressure>(&c.kind)) {
    if (!std::isfinite(pressure->pressure_pa)) bad("the pressure is not finite");
  } else if (const auto* body = std::get_if<BodyForce>(&c.kind)) {
    const Eigen::Index points =
        static_cast<Eigen::Index>(cell_quadrature(problem.formulation).size()) * problem.mesh->cell_count();
    if (!body->force_n_m3.allFinite()) bad("the force is not finite");
    if (body->force_n_m3.cols() != 1 && body->force_n_m3.cols() != points) {
      bad(fmt::format("{} columns of force, one or {} (quadrature points) are needed",
                      body->force_n_m3.cols(), points));
    }
  }
}

}  // namespace

std::vector<std::vector<Hold>> check_conditions(const Problem& problem, Findings& found) {
  std::vector<std::vector<Hold>> holds(problem.conditions.size());
  std::set<std::string> seen;
  const std::size_t before = found.list.size();
  for (std::size_t i = 0; i < problem.conditions.size(); ++i) {
    const BoundaryCondition& c = problem.conditions[i];
    if (!seen.insert(c.name).second) {
      found.error("duplicate-condition", fmt::format("two boundary conditions are named `{}`", c.name),
                  "names are unique: phases move conditions by name");
    }
    try {
      if (std::holds_alternative<BodyForce>(c.kind)) {
        if (!c.surface.empty()) {
          found.error(
              "condition-value",
              fmt::format("`{}`: a body force acts on the whole body, not on `{}`", c.name, c.surface),
              "leave the surface empty");
        }
      } else if (is_constraint(c)) {
        if (condition_points(*problem.mesh, c.surface).empty()) {
          found.error("missing-surface",
                      fmt::format("`{}`: the surface `{}` has no points", c.name, c.surface), "");
          continue;
        }
      } else if (!moves_bodies_only(c)) {
        check_has_faces(*problem.mesh, c.surface);
      }
      check_values(problem, c, found);
      if (is_constraint(c)) holds[i] = holds_of(problem, static_cast<int>(i));
    } catch (const data::InputError& e) {
      for (data::Diagnostic d : e.diagnostics()) {
        d.message = fmt::format("`{}`: {}", c.name, d.message);
        found.list.push_back(std::move(d));
      }
    }
  }
  found.conditions_sound = found.conditions_sound && found.list.size() == before;
  return holds;
}

void check_programme(const Problem& problem, Findings& found) {
  const std::vector<std::string> names = condition_names(problem);
  const std::vector<std::string>& regions = problem.mesh->regions;
  const bool rates = std::any_of(problem.materials.begin(), problem.materials.end(),
                                 [](const RegionMaterial& m) { return is_rate_dependent(m.material); });
  if (problem.programme.empty())
    found.error("empty-programme", "the load programme has no phase", "give at least one phase");
  std::map<std::string, double> amplitude, activation;
  std::set<std::string> released;
  for (const Phase& phase : problem.programme) {
    bool changes = !phase.release.empty() || rates;
    const std::string in = fmt::format("phase `{}`", phase.name);
    for (const auto& [name, value] : phase.amplitude) {
      const auto which = std::find(names.begin(), names.end(), name);
      if (which == names.end()) {
        found.error("unknown-condition",
                    fmt::format("{} moves `{}`, which is no boundary condition", in, name),
                    data::suggest(name, names));
        changes = true;  // is meant to
        continue;
      }
      if (!has_amplitude(problem.conditions[static_cast<std::size_t>(which - names.begin())])) {
        found.error("no-amplitude",
                    fmt::format("{} moves `{}`, which only holds and has no amplitude", in, name),
                    "prescribe a displacement to move it, or release it");
      }
      if (!std::isfinite(value))
        found.error("condition-value", fmt::format("{}: the amplitude of `{}` is not finite", in, name), "");
      changes = changes || amplitude[name] != value;
      amplitude[name] = value;
    }
    for (const auto& [name, value] : phase.activation) {
      const auto which = std::find(regions.begin(), regions.end(), name);
      if (which == regions.end()) {
        found.error("unknown-region",
                    fmt::format("{} activates `{}`, which is no region of the mesh", in, name),
                    data::suggest(name, regions));
        changes = true;
        continue;
      }
      if (!(value >= 0.0 && value <= 1.0)) {
        found.error("activation-range",
                    fmt::format("{}: the activation of `{}` is {}, it must be in [0, 1]", in, name, value),
                    "");
      }
      const auto r = static_cast<std::size_t>(which - regions.begin());
      if (value > 0.0 && r < problem.materials.size() && !is_active(problem.materials[r].material)) {
        found.warning("inactive-region",
                      fmt::format("{} activates `{}`, whose law has no active part", in, name), "");
      }
      changes = changes || activation[name] != value;
      activation[name] = value;
    }
    for (const std::string& name : phase.release) {
      const auto which = std::find(names.begin(), names.end(), name);
      if (which == names.end()) {
        found.error("unknown-condition",
                    fmt::format("{} releases `{}`, which is no boundary condition", in, name),
                    data::suggest(name, names));
        found.conditions_sound = false;
      } else if (!is_constraint(problem.conditions[static_cast<std::size_t>(which - names.begin())])) {
        found.error("release-of-load", fmt::format("{} releases `{}`, which is a load", in, name),
                    "move its amplitude to 0 instead");
      } else if (!released.insert(name).second) {
        found.error("released-twice", fmt::format("{} releases `{}`, which holds no more", in, name), "");
      }
    }
    if (!changes)
      found.error("empty-phase", fmt::format("{} changes nothing", in),
                  "give it an amplitude, an activation or a release, or leave it out");
    if (phase.steps < 1)
      found.error("condition-value", fmt::format("{}: `steps` is {}, it must be at least 1", in, phase.steps),
                  "");
    if (!(phase.duration_s > 0.0) || std::isinf(phase.duration_s)) {
      found.error(
          "condition-value",
          fmt::format("{}: `duration_s` is {}, it must be finite and greater than 0", in, phase.duration_s),
          "");
    }
  }
}

}  // namespace brachium::fem
