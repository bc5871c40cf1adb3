#include "data/io/vtk_grid.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <optional>

namespace brachium::io {
namespace {

using data::CellType;

struct Kind {
  int dimension;
  std::size_t nodes;
  std::optional<CellType> cell;
};

/// VTK's cell types that can be used or left out (vtkCellType.h).
std::optional<Kind> kind_of(double type) {
  switch (static_cast<int>(type)) {
    case 1:
      return Kind{0, 1, {}};
    case 3:
      return Kind{1, 2, {}};
    case 5:
      return Kind{2, 3, {}};
    case 9:
      return Kind{2, 4, {}};
    case 10:
      return Kind{3, 4, CellType::tet4};
    case 12:
      return Kind{3, 8, CellType::hex8};
    case 21:
      return Kind{1, 3, {}};
    case 22:
      return Kind{2, 6, {}};
    case 23:
      return Kind{2, 8, {}};
    case 24:
      return Kind{3, 10, CellType::tet10};
    case 25:
      return Kind{3, 20, CellType::hex20};
    case 28:
      return Kind{2, 9, {}};
    case 29:
      return Kind{3, 27, CellType::hex27};
    default:
      return std::nullopt;
  }
}

const char* refusal(double type) {
  switch (static_cast<int>(type)) {
    case 11:
      return "voxels cannot be used: make hexahedra of them (type 12)";
    case 13:
    case 26:
    case 31:
    case 32:
      return "wedges cannot be used: mesh with tetrahedra or hexahedra only";
    case 14:
    case 27:
    case 37:
      return "pyramids cannot be used: mesh with tetrahedra or hexahedra only";
    case 42:
      return "polyhedra cannot be used: mesh with tetrahedra or hexahedra";
    case 71:
    case 72:
      return "Lagrange cells cannot be used: write quadratic cells (types 24, 25, 29)";
    default:
      return "usable: 10, 12, 24, 25, 29 (volume), 5, 9, 22, 23, 28 (surface)";
  }
}

const VtkArray* region_array(const VtkGrid& grid, const MeshCursor& in, const MeshReadOptions& options,
                             RawMesh& raw) {
  std::vector<std::string> known;
  for (const VtkArray& a : grid.cell_arrays) {
    if (a.name == options.region_array) {
      if (a.components != 1)
        in.fail("mesh-region-array", fmt::format("cell array `{}` has {} components: it cannot tell regions",
                                                 a.name, a.components));
      return &a;
    }
    known.push_back(a.name);
  }
  const std::string message =
      fmt::format("there is no cell array `{}` that tells regions", options.region_array);
  const std::string help =
      known.empty() ? "the file has no cell arrays" : data::suggest(options.region_array, known);
  if (options.region_array != MeshReadOptions{}.region_array) in.fail("mesh-region-array", message, help);
  raw.note(
      fmt::format("{} ({}): all cells are in region `all`, and surface cells are left out", message, help));
  return nullptr;
}

}  // namespace

RawMesh raw_mesh(const VtkGrid& grid, const MeshCursor& in, const MeshReadOptions& options) {
  RawMesh raw;
  raw.file = in.file();
  const std::size_t n_points = grid.points.size() / 3, n_cells = grid.types.size();
  if (grid.offsets.size() != n_cells)
    in.fail("mesh-size", fmt::format("{} cells have types, {} have nodes", n_cells, grid.offsets.size()));
  for (const double x : grid.points) {
    if (!std::isfinite(x)) in.fail("mesh-not-finite", "a coordinate is not finite");
  }
  for (std::size_t p = 0; p < n_points; ++p)
    raw.points.emplace_back(grid.points[3 * p], grid.points[3 * p + 1], grid.points[3 * p + 2]);
  for (const auto* arrays : {&grid.point_arrays, &grid.cell_arrays}) {
    for (const VtkArray& a : *arrays) {
      const std::size_t expected = arrays == &grid.point_arrays ? n_points : n_cells;
      if (a.tuples() != expected)
        in.fail("mesh-size", fmt::format("array `{}` has {} tuples for {}", a.name, a.tuples(), expected));
    }
  }
  const VtkArray* regions = region_array(grid, in, options, raw);
  const auto name_of = [&](std::size_t cell) -> std::string {
    if (!regions->texts.empty()) return regions->texts[cell];
    const double value = regions->numbers[cell];
    if (!(std::abs(value) < 9e15) || value != std::floor(value))
      in.fail("mesh-region-array",
              fmt::format("cell array `{}` holds {}, which is no integer", regions->name, value));
    const auto number = static_cast<long long>(value);
    const auto named = options.region_names.find(number);
    return named == options.region_names.end() ? std::to_string(number) : named->second;
  };

  std::vector<Eigen::Index> volume_cells;
  std::vector<int> nodes;
  double begin = 0.0;
  for (std::size_t c = 0; c < n_cells; ++c) {
    const auto kind = kind_of(grid.types[c]);
    if (!kind)
      in.fail("mesh-cell-type",
              fmt::format("cell {} is of VTK type {}, which cannot be used", c, grid.types[c]),
              refusal(grid.types[c]));
    const double end = grid.offsets[c];
    if (!(end >= begin) || end > static_cast<double>(grid.connectivity.size()) ||
        end - begin != static_cast<double>(kind->nodes)) {
      in.fail("mesh-size", fmt::format("cell {} of VTK type {} needs {} nodes and has {}", c, grid.types[c],
                                       kind->nodes, end - begin));
    }
    nodes.clear();
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const double p = grid.connectivity[i];
      if (!(p >= 0.0) || p >= static_cast<double>(n_points))
        in.fail("mesh-index", fmt::format("cell {} uses point {} of {}", c, p, n_points));
      nodes.push_back(static_cast<int>(p));
    }
    begin = end;
    if (kind->dimension == 3) {
      raw.add_cell(*kind->cell, raw.regions.index(regions ? name_of(c) : "all"), nodes, vtk_order);
      volume_cells.push_back(static_cast<Eigen::Index>(c));
    } else if (kind->dimension == 2 && regions) {
      RawMesh::Facet facet;
      const bool triangle = kind->nodes == 3 || kind->nodes == 6;
      std::copy_n(nodes.begin(), triangle ? 3 : 4, facet.corners.begin());
      facet.surface = raw.surfaces.index(name_of(c));
      raw.facets.push_back(facet);
    }
  }

  for (const auto* arrays : {&grid.point_arrays, &grid.cell_arrays}) {
    const bool of_points = arrays == &grid.point_arrays;
    for (const VtkArray& a : *arrays) {
      if (!a.texts.empty()) {
        if (&a != regions) raw.note(fmt::format("array `{}` of texts was left out", a.name));
        continue;
      }
      const Eigen::MatrixXd all = Eigen::Map<const Eigen::MatrixXd>(
          a.numbers.data(), static_cast<Eigen::Index>(a.components), static_cast<Eigen::Index>(a.tuples()));
      if (!all.allFinite())
        in.fail("mesh-not-finite", fmt::format("array `{}` holds a value that is not finite", a.name));
      if (of_points) {
        raw.point_fields[a.name] = all;
      } else {
        raw.cell_fields[a.name] = all(Eigen::all, volume_cells);
      }
    }
  }
  return raw;
}

}  // namespace brachium::io
