/// Materials, and fields at quadrature points.

#include <fmt/format.h>

#include <cmath>

#include "fem/element/quadrature.hpp"
#include "fem/solve/problem_check.hpp"

namespace brachium::fem {

void check_materials(const Problem& problem, Findings& found) {
  const data::Mesh& mesh = *problem.mesh;
  if (problem.materials.size() != mesh.regions.size()) {
    found.error("region-materials",
                fmt::format("the mesh has {} regions, and {} materials are given", mesh.regions.size(),
                            problem.materials.size()),
                "give one material per region, in the mesh's order");
  }
  for (std::size_t r = 0; r < std::min(problem.materials.size(), mesh.regions.size()); ++r) {
    const RegionMaterial& material = problem.materials[r];
    try {
      check(material.material);
    } catch (const data::InputError& e) {
      for (data::Diagnostic d : e.diagnostics()) {
        d.message = fmt::format("region `{}`: {}", mesh.regions[r], d.message);
        found.list.push_back(std::move(d));
      }
    }
    const double k = material.volumetric.bulk_modulus_pa;
    if (!(k > 0.0)) {
      found.error(
          "parameter-range",
          fmt::format(
              "region `{}`: `bulk_modulus_pa` is {}, it must be greater than 0 (infinite: incompressible)",
              mesh.regions[r], k),
          "");
    }
    if (std::isinf(k) && pressure_space(problem.formulation) == PressureSpace::none) {
      found.error("incompressible-displacement",
                  fmt::format("region `{}` is incompressible, and `{}` has no pressure", mesh.regions[r],
                              to_string(problem.formulation)),
                  "give a finite bulk modulus, or a formulation with a pressure");
    }
  }
}

namespace {

void check_size(Eigen::Index size, Eigen::Index wanted, const char* name, Findings& found) {
  if (size == 0 || size == wanted) return;
  found.error("tissue-size",
              fmt::format("`{}` has {} values, the cells have {} quadrature points", name, size, wanted),
              "fields are given at the quadrature points of the formulation");
}

void check_unit_interval(const Eigen::VectorXd& values, const char* name, Findings& found) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (values[i] >= 0.0 && values[i] <= 1.0) continue;
    found.error("blending-range",
                fmt::format("`{}` is {} at quadrature point {}, it must be in [0, 1]", name, values[i], i),
                "");
    return;
  }
}

}  // namespace

void check_tissue(const Problem& problem, Findings& found) {
  const data::Mesh& mesh = *problem.mesh;
  const TissueField& tissue = problem.tissue;
  const Eigen::Index n_q = cell_quadrature(problem.formulation).size(), points = n_q * mesh.cell_count();
  check_size(tissue.fibre.cols(), points, "fibre", found);
  check_size(tissue.muscle.size(), points, "muscle", found);
  check_size(tissue.soft_tissue.size(), points, "soft_tissue", found);
  check_unit_interval(tissue.muscle, "muscle", found);
  check_unit_interval(tissue.soft_tissue, "soft_tissue", found);
  if (tissue.fibre.cols() != 0 && tissue.fibre.cols() != points) return;
  for (std::size_t r = 0; r < std::min(problem.materials.size(), mesh.regions.size()); ++r) {
    if (!needs_fibres(problem.materials[r].material)) continue;
    if (tissue.fibre.cols() == 0) {
      found.error(
          "missing-fibres",
          fmt::format("the law of region `{}` has fibres, and no fibre field is given", mesh.regions[r]),
          "give a fibre field");
      continue;
    }
    Eigen::Index bad = 0;
    int first_cell = -1;
    double length = 1.0;
    for (int c = 0; c < mesh.cell_count(); ++c) {
      if (mesh.region_of_cell[static_cast<std::size_t>(c)] != static_cast<int>(r)) continue;
      for (Eigen::Index q = 0; q < n_q; ++q) {
        const double norm = tissue.fibre.col(q + n_q * c).norm();
        if (std::abs(norm - 1.0) <= 1e-9) continue;
        if (bad++ == 0) {
          first_cell = c;
          length = norm;
        }
      }
    }
    if (bad > 0) {
      found.error("fibre-not-unit",
                  fmt::format("region `{}`: the fibres at {} quadrature points are no unit vectors, first in "
                              "cell {} (length {})",
                              mesh.regions[r], bad, first_cell, length),
                  "normalise the field; a zero vector means that the direction is missing");
    }
  }
}

}  // namespace brachium::fem
