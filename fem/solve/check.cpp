#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "fem/element/quadrature.hpp"
#include "fem/mesh/quality.hpp"
#include "fem/solve/constraints.hpp"
#include "fem/solve/problem_check.hpp"
#include "fem/solve/rigid_support.hpp"

namespace brachium::fem {
namespace {

using data::Diagnostic;
using data::Severity;

/// Parts of a mesh that nothing joins: one finding.
void check_connected(const data::Mesh& mesh, const std::vector<int>& part, Findings& found) {
  const int parts = part.empty() ? 0 : *std::max_element(part.begin(), part.end()) + 1;
  if (parts < 2) return;
  std::vector<std::string> list;
  for (int p = 0; p < std::min(parts, 5); ++p) {
    const auto first = std::find(part.begin(), part.end(), p);
    const auto cell = static_cast<std::size_t>(first - part.begin());
    list.push_back(fmt::format("{} cells from cell {} (region `{}`)", std::count(part.begin(), part.end(), p),
                               cell, mesh.regions[static_cast<std::size_t>(mesh.region_of_cell[cell])]));
  }
  found.error("disconnected-mesh",
              fmt::format("the mesh falls into {} parts that share no points: {}{}", parts,
                          fmt::join(list, "; "), parts > 5 ? "; ..." : ""),
              "merge the points along the interfaces, or solve the parts one by one");
}

/// Names of rigid motions that nothing holds, part by part, in every phase that changes the supports.
void check_support(const Problem& problem, const std::vector<int>& part,
                   const std::vector<std::vector<Hold>>& holds, Findings& found) {
  const data::Mesh& mesh = *problem.mesh;
  const int parts = *std::max_element(part.begin(), part.end()) + 1;
  std::vector<int> part_of_node(static_cast<std::size_t>(mesh.point_count()), -1);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    for (Eigen::Index a = 0; a < mesh.cells.rows(); ++a) {
      part_of_node[static_cast<std::size_t>(mesh.cells(a, c))] = part[static_cast<std::size_t>(c)];
    }
  }
  std::set<std::string> released, told;
  for (std::size_t p = 0; p < problem.programme.size(); ++p) {
    const Phase& phase = problem.programme[p];
    if (p > 0 && phase.release.empty()) continue;
    released.insert(phase.release.begin(), phase.release.end());
    for (int k = 0; k < parts; ++k) {
      std::vector<int> nodes;
      std::vector<Hold> on_part;
      for (int n = 0; n < mesh.point_count(); ++n) {
        if (part_of_node[static_cast<std::size_t>(n)] == k) nodes.push_back(n);
      }
      for (std::size_t c = 0; c < holds.size(); ++c) {
        if (released.contains(problem.conditions[c].name)) continue;
        for (const Hold& hold : holds[c]) {
          if (part_of_node[static_cast<std::size_t>(hold.node)] == k) on_part.push_back(hold);
        }
      }
      const std::vector<std::string> free = free_motions(mesh, nodes, on_part);
      if (free.empty()) continue;
      const std::string text =
          fmt::format("nothing holds the body{} against {}",
                      parts > 1 ? fmt::format("'s part {}", k + 1) : "", fmt::join(free, ", "));
      if (!told.insert(text).second) continue;
      found.error(
          "unsupported-motion",
          p == 0 ? text : fmt::format("{} once phase `{}` begins to release constraints", text, phase.name),
          "fix or prescribe displacements that stop these motions");
    }
  }
}

void check_contradictions(const Problem& problem, Findings& found) {
  const data::Mesh& mesh = *problem.mesh;
  const double size = (mesh.points.rowwise().maxCoeff() - mesh.points.rowwise().minCoeff()).norm();
  const auto n = static_cast<Eigen::Index>(problem.conditions.size());
  Eigen::VectorXd amplitude = Eigen::VectorXd::Zero(n);
  std::vector<std::string> released;
  std::set<std::pair<int, int>> told;
  for (const Phase& phase : problem.programme) {
    released.insert(released.end(), phase.release.begin(), phase.release.end());
    const Constraints constraints(problem, mesh.point_count(), 3 * mesh.point_count(), released);
    Eigen::VectorXd end = amplitude;
    for (Eigen::Index c = 0; c < n; ++c) {
      const auto to = phase.amplitude.find(problem.conditions[static_cast<std::size_t>(c)].name);
      if (to != phase.amplitude.end()) end[c] = to->second;
    }
    for (const double part : {1.0, 0.5}) {  // two motions may agree at the end only
      for (const Contradiction& c :
           constraints.contradictions(amplitude + part * (end - amplitude), 1e-7 * size)) {
        if (!told.insert({c.first, c.second}).second) continue;
        found.error("contradictory-conditions",
                    fmt::format("`{}` and `{}` hold {} nodes in the same direction and disagree, in phase "
                                "`{}` by up to {:.3g} m (point {})",
                                problem.conditions[static_cast<std::size_t>(c.first)].name,
                                problem.conditions[static_cast<std::size_t>(c.second)].name, c.nodes,
                                phase.name, c.difference_m, c.node),
                    "free the component in one of them, or make both move alike");
      }
    }
    amplitude = end;
  }
}

/// A continuous pressure is fixed by the boundary's freedom to move; held everywhere, only up to a constant.
void check_pressure(const Problem& problem, const std::vector<std::vector<Hold>>& holds, Findings& found) {
  if (pressure_space(problem.formulation) != PressureSpace::continuous) return;
  if (std::none_of(problem.materials.begin(), problem.materials.end(),
                   [](const RegionMaterial& m) { return std::isinf(m.volumetric.bulk_modulus_pa); })) {
    return;
  }
  std::vector<Eigen::Matrix3d> held(static_cast<std::size_t>(problem.mesh->point_count()),
                                    Eigen::Matrix3d::Zero());
  for (const auto& list : holds) {
    for (const Hold& hold : list)
      held[static_cast<std::size_t>(hold.node)] += hold.direction * hold.direction.transpose();
  }
  for (const data::CellFace& face : data::boundary_faces(*problem.mesh)) {
    for (const int local : data::face_nodes(problem.mesh->type, face.face)) {
      if (held[static_cast<std::size_t>(problem.mesh->cells(local, face.cell))].determinant() < 1e-12) return;
    }
  }
  found.error(
      "pressure-undetermined",
      "the whole boundary of an incompressible body is held: its pressure is known only up to a constant",
      "free a part of the boundary, give a finite bulk modulus, or use a condensed formulation");
}

}  // namespace

std::vector<Diagnostic> check(const Problem& problem) {
  Findings found;
  if (!problem.mesh) {
    found.error("mesh-empty", "the problem has no mesh", "");
    return found.list;
  }
  const data::Mesh& mesh = *problem.mesh;
  found.list = data::check_structure(mesh);
  if (found.any_error()) return found.list;
  if (mesh.type != cell_type(problem.formulation)) {
    found.error("cell-type-mismatch",
                fmt::format("`{}` needs {} cells, the mesh has {}", to_string(problem.formulation),
                            data::to_string(cell_type(problem.formulation)), data::to_string(mesh.type)),
                "elevate the mesh, or choose a formulation for its cells");
  }
  check_materials(problem, found);
  check_tissue(problem, found);
  const std::vector<std::vector<Hold>> holds = check_conditions(problem, found);
  check_programme(problem, found);
  const std::vector<int> part = connected_parts(mesh);
  check_connected(mesh, part, found);
  if (!found.conditions_sound)
    return found.list;  // supports cannot be judged where conditions are not understood
  check_support(problem, part, holds, found);
  check_contradictions(problem, found);
  check_pressure(problem, holds, found);
  return found.list;
}

}  // namespace brachium::fem
