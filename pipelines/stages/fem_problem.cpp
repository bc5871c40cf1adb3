#include "pipelines/stages/fem_problem.hpp"

#include <fmt/format.h>

#include "fem/assembly/discretisation.hpp"
#include "fem/mesh/quality.hpp"
#include "fem/solve/equations.hpp"
#include "fem/solve/problem_check.hpp"
#include "pipelines/stages/fem_mesh.hpp"
#include "pipelines/stages/fem_quantities.hpp"

namespace brachium::pipelines {
namespace {

using data::Diagnostic;
using data::InputError;

class Builder {
 public:
  explicit Builder(const Options& options) : options_(options) {}

  FemProblem build() {
    fem::Problem& problem = out_.problem;
    problem.formulation = fem::formulation_named(options_.text("element"));
    const bool body = mesh();
    problem.conditions = fem_conditions(options_, mistakes_);
    problem.contacts = fem_contacts(options_, mistakes_, out_.notes);
    if (!body) throw InputError(std::move(mistakes_).list());  // nothing can be said of regions and surfaces
    const bool sound = mesh_quality(), cells = mesh_type();
    problem.materials = fem_materials(options_, *problem.mesh, mistakes_, out_.materials);
    const bool tissue =
        sound && cells &&
        fem_tissue(options_, *problem.mesh, problem.formulation, mistakes_, problem.tissue, out_.directions);
    problem.programme = fem_programme(options_, *problem.mesh, problem.materials, mistakes_);
    check_outputs(options_, *problem.mesh, mistakes_);
    check(tissue);
    if (sound && cells) places();
    if (!mistakes_.empty()) throw InputError(std::move(mistakes_).list());
    return std::move(out_);
  }

 private:
  bool mesh() {
    const Options& entry = options_.table("mesh");
    return mistakes_.guarded(entry, "", [&] {
      FemMesh body = fem_mesh(entry, out_.problem.formulation);
      out_.mesh_source = body.source;
      out_.notes.insert(out_.notes.end(), body.notes.begin(), body.notes.end());
      out_.problem.mesh = std::make_shared<data::Mesh>(std::move(body.mesh));
    });
  }

  bool mesh_quality() {
    const std::vector<Diagnostic> broken = fem::check_quality(*out_.problem.mesh);
    mistakes_.take(broken, options_.table("mesh"));
    if (!broken.empty()) return false;
    out_.quality = fem::quality_table(*out_.problem.mesh, fem::cell_quality(*out_.problem.mesh));
    return true;
  }

  bool mesh_type() {
    const data::CellType type = out_.problem.mesh->type, needed = fem::cell_type(out_.problem.formulation);
    if (type == needed) return true;
    mistakes_.error(options_, "cell-type-mismatch",
                    fmt::format("the mesh has {} cells, the `element` {} needs {}", data::to_string(type),
                                options_.text("element"), data::to_string(needed)),
                    "choose an element for these cells, or set `elevate = true` in `mesh`");
    return false;
  }

  /// What is there as a whole is judged as a whole; otherwise the parts that do not hang on what is missing.
  void check(bool tissue) {
    const fem::Problem& problem = out_.problem;
    fem::Problem named = problem;  // conditions that name a surface
    std::erase_if(named.conditions, [](const fem::BoundaryCondition& c) {
      return c.surface.empty() && !std::holds_alternative<fem::BodyForce>(c.kind) &&
             !fem::moves_bodies_only(c);
    });
    const bool whole = tissue && problem.materials.size() == problem.mesh->regions.size() &&
                       named.conditions.size() == problem.conditions.size();
    if (whole) return mistakes_.take_checked(fem::check(problem), options_);  // notes come with the solve
    fem::Findings found;
    fem::check_conditions(named, found);
    fem::check_programme(problem, found);
    mistakes_.take_checked(found.list, options_);
  }

  /// Points, planes and contacts, which only the discretised body can judge.
  void places() {
    fem::Problem& problem = out_.problem;
    const fem::Discretisation discretisation(problem.mesh, problem.formulation);
    if (problem.materials.size() == problem.mesh->regions.size()) {
      const double stiffness = fem::stiffness_scale(problem),
                   cell_size = std::cbrt(discretisation.volume() / discretisation.cell_count());
      fem::Problem one = problem;
      for (fem::Contact& contact : problem.contacts) {
        const Options& entry =
            options_.tables("contact")[static_cast<std::size_t>(&contact - problem.contacts.data())];
        mistakes_.guarded(entry, fmt::format("contact `{}`: ", contact.name), [&] {
          one.contacts = {contact};
          contact.penalty_pa_per_m =
              fem::Contacts(one, discretisation, stiffness, cell_size).penalty_pa_per_m(0);
        });
      }
    }
    check_places(options_, discretisation, mistakes_);
  }

  const Options& options_;
  FemProblem out_;
  Mistakes mistakes_;
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

Eigen::Vector3d vector_of(const Options& entry, const std::string& key) {
  if (!entry.has(key)) return Eigen::Vector3d::Zero();
  const std::vector<double>& v = entry.numbers(key);
  return {v[0], v[1], v[2]};
}

FemProblem build_fem_problem(const Options& options) {
  return Builder(options).build();
}

}  // namespace brachium::pipelines
