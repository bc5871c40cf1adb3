/// What makes a mesh usable as a data structure, whatever its geometry.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "data/model/mesh.hpp"

namespace brachium::data {
namespace {

constexpr std::size_t places_named = 5;

/// Collects the places of one kind of mistake; one finding tells the first few and the count.
struct Places {
  std::string code, sentence, help;
  std::vector<std::string> list{};
  std::size_t count = 0;

  void add(std::string place) {
    if (++count <= places_named) list.push_back(std::move(place));
  }
  void report(std::vector<Diagnostic>& findings) const {
    if (count == 0) return;
    std::string text = fmt::format("{}: {}", sentence, fmt::join(list, ", "));
    if (count > list.size()) text += fmt::format(" and {} more", count - list.size());
    findings.push_back({Severity::error, code, std::move(text), std::nullopt, help});
  }
};

void add(std::vector<Diagnostic>& findings, std::string code, std::string message, std::string help = {}) {
  findings.push_back({Severity::error, std::move(code), std::move(message), std::nullopt, std::move(help)});
}

void check_sizes(const Mesh& mesh, std::vector<Diagnostic>& findings) {
  if (mesh.point_count() == 0) add(findings, "mesh-empty", "the mesh has no points");
  if (mesh.cell_count() == 0) add(findings, "mesh-empty", "the mesh has no volume cells");
  if (mesh.cell_count() > 0 && mesh.cells.rows() != nodes_per_cell(mesh.type)) {
    add(findings, "mesh-size",
        fmt::format("cells of type {} have {} nodes, the mesh lists {}", to_string(mesh.type),
                    nodes_per_cell(mesh.type), mesh.cells.rows()));
  }
  if (mesh.region_of_cell.size() != static_cast<std::size_t>(mesh.cell_count())) {
    add(findings, "mesh-size",
        fmt::format("{} cells, but {} of them have a region", mesh.cell_count(), mesh.region_of_cell.size()));
  }
  for (const auto& [name, field] : mesh.point_fields) {
    if (field.cols() != mesh.point_count()) {
      add(findings, "mesh-size",
          fmt::format("point field `{}` has {} columns for {} points", name, field.cols(),
                      mesh.point_count()));
    }
  }
  for (const auto& [name, field] : mesh.cell_fields) {
    if (field.cols() != mesh.cell_count()) {
      add(findings, "mesh-size",
          fmt::format("cell field `{}` has {} columns for {} cells", name, field.cols(), mesh.cell_count()));
    }
  }
}

void check_names(const Mesh& mesh, std::vector<Diagnostic>& findings) {
  Places twice{"mesh-duplicate-name", "names that stand twice",
               "a name must mean one thing: rename or merge"};
  const auto each = [&](const char* kind, const auto& list, auto name_of) {
    std::set<std::string> seen;
    for (const auto& item : list) {
      const std::string& name = name_of(item);
      if (name.empty()) add(findings, "mesh-duplicate-name", fmt::format("a {} has no name", kind));
      if (!seen.insert(name).second) twice.add(fmt::format("{} `{}`", kind, name));
    }
  };
  each("region", mesh.regions, [](const std::string& r) -> const std::string& { return r; });
  each("surface", mesh.surfaces, [](const NamedSurface& s) -> const std::string& { return s.name; });
  twice.report(findings);
}

void check_indices(const Mesh& mesh, std::vector<Diagnostic>& findings) {
  Places points{"mesh-index", "nodes that are not points of the mesh", ""};
  Places repeated{"mesh-repeated-point", "cells that use a point twice",
                  "collapsed cells are not supported: mesh with tetrahedra there, or with an O-grid"};
  Places regions{"mesh-index", "cells with a region that does not exist", ""};
  Places faces{"mesh-index", "surfaces with a cell or face that does not exist", ""};
  Places twice{"mesh-duplicate-name", "faces that stand twice in a surface", ""};
  Places sets{"mesh-index", "node sets with a point that does not exist", ""};
  Places finite{"mesh-not-finite", "coordinates that are not finite", ""};
  for (int p = 0; p < mesh.point_count(); ++p) {
    if (!mesh.points.col(p).allFinite()) finite.add(fmt::format("point {}", p));
  }
  std::vector<int> nodes;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    nodes.assign(mesh.cells.col(c).begin(), mesh.cells.col(c).end());
    std::sort(nodes.begin(), nodes.end());
    if (nodes.front() < 0 || nodes.back() >= mesh.point_count()) points.add(fmt::format("cell {}", c));
    if (std::adjacent_find(nodes.begin(), nodes.end()) != nodes.end())
      repeated.add(fmt::format("cell {}", c));
  }
  for (std::size_t c = 0; c < mesh.region_of_cell.size(); ++c) {
    const int r = mesh.region_of_cell[c];
    if (r < 0 || static_cast<std::size_t>(r) >= mesh.regions.size()) regions.add(fmt::format("cell {}", c));
  }
  for (const NamedSurface& s : mesh.surfaces) {
    std::set<CellFace> seen;
    for (const CellFace& f : s.faces) {
      if (f.cell < 0 || f.cell >= mesh.cell_count() || f.face < 0 || f.face >= faces_per_cell(mesh.type))
        faces.add(fmt::format("`{}`: face {} of cell {}", s.name, f.face, f.cell));
      if (!seen.insert(f).second) twice.add(fmt::format("`{}`: face {} of cell {}", s.name, f.face, f.cell));
    }
  }
  for (const auto& [name, list] : mesh.node_sets) {
    for (const int p : list) {
      if (p < 0 || p >= mesh.point_count()) sets.add(fmt::format("`{}`: {}", name, p));
    }
  }
  for (const Places* p : {&finite, &points, &repeated, &regions, &faces, &twice, &sets}) p->report(findings);
}

void check_cells(const Mesh& mesh, std::vector<Diagnostic>& findings) {
  Places duplicates{"mesh-duplicate-cell", "cells with the same nodes as an earlier one",
                    "remove one of each pair"};
  const int corners = corners_per_cell(mesh.type);
  std::vector<std::array<int, 9>> keys(static_cast<std::size_t>(mesh.cell_count()));
  for (int c = 0; c < mesh.cell_count(); ++c) {
    auto& key = keys[static_cast<std::size_t>(c)];
    key.fill(-1);
    for (int i = 0; i < corners; ++i) key[static_cast<std::size_t>(i)] = mesh.cells(i, c);
    std::sort(key.begin(), key.begin() + corners);
    key[8] = c;
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (std::equal(keys[i].begin(), keys[i].begin() + 8, keys[i - 1].begin()))
      duplicates.add(fmt::format("cells {} and {}", keys[i - 1][8], keys[i][8]));
  }
  duplicates.report(findings);
}

void check_faces(const Mesh& mesh, std::vector<Diagnostic>& findings) {
  Places shared{"mesh-shared-face", "faces with more than two cells", "remove the cells that overlap"};
  Places apart{"mesh-nonconforming",
               "neighbours that share corners of a face but not its edge or centre nodes",
               "merge coincident points"};
  const FaceTable table(mesh);
  const auto& entries = table.entries();
  const auto nodes_of = [&](const CellFace& f) {
    std::vector<int> nodes;
    for (const int local : face_nodes(mesh.type, f.face)) nodes.push_back(mesh.cells(local, f.cell));
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  for (std::size_t i = 0; i + 1 < entries.size(); ++i) {
    if (entries[i].key != entries[i + 1].key) continue;
    if (i + 2 < entries.size() && entries[i + 2].key == entries[i].key) {
      shared.add(fmt::format("cells {}, {} and {}", entries[i].face.cell, entries[i + 1].face.cell,
                             entries[i + 2].face.cell));
      while (i + 1 < entries.size() && entries[i + 1].key == entries[i].key) ++i;
    } else if (nodes_of(entries[i].face) != nodes_of(entries[i + 1].face)) {
      apart.add(fmt::format("cells {} and {}", entries[i].face.cell, entries[i + 1].face.cell));
    }
  }
  shared.report(findings);
  apart.report(findings);
}

}  // namespace

std::vector<Diagnostic> check_structure(const Mesh& mesh) {
  std::vector<Diagnostic> findings;
  check_sizes(mesh, findings);
  check_names(mesh, findings);
  if (mesh.cell_count() == 0 || mesh.cells.rows() != nodes_per_cell(mesh.type)) return findings;
  const std::size_t before = findings.size();
  check_indices(mesh, findings);
  if (findings.size() == before) {  // the rest needs indices that hold
    check_cells(mesh, findings);
    check_faces(mesh, findings);
  }
  return findings;
}

}  // namespace brachium::data
