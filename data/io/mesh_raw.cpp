#include "data/io/mesh_raw.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <set>

#include "data/model/units.hpp"

namespace brachium::io {
namespace {

using data::CellFace;
using data::InputError;
using data::Mesh;

/// All cells must be of one type: elements are chosen per mesh.
void check_one_type(const RawMesh& raw) {
  std::map<std::string, std::size_t> count;
  for (const data::CellType type : raw.types) ++count[data::to_string(type)];
  if (count.size() <= 1) return;
  std::vector<std::string> list;
  for (const auto& [type, n] : count) list.push_back(fmt::format("{} {}", n, type));
  throw InputError("mesh-mixed-cells",
                   fmt::format("`{}` mixes volume cells: {}", raw.file.string(), fmt::join(list, ", ")),
                   "mesh with one type and one order throughout");
}

/// The same cell listed in two regions is one region too many.
void check_regions(const RawMesh& raw, const Mesh& mesh) {
  const auto corners = static_cast<std::size_t>(data::corners_per_cell(mesh.type));
  std::vector<std::array<int, 9>> keys(static_cast<std::size_t>(mesh.cell_count()));
  for (std::size_t c = 0; c < keys.size(); ++c) {
    keys[c].fill(-1);
    for (std::size_t i = 0; i < corners; ++i)
      keys[c][i] = mesh.cells(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c));
    std::sort(keys[c].begin(), keys[c].begin() + static_cast<std::ptrdiff_t>(corners));
    keys[c][8] = static_cast<int>(c);
  }
  std::sort(keys.begin(), keys.end());
  std::set<std::pair<int, int>> pairs;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (!std::equal(keys[i].begin(), keys[i].begin() + 8, keys[i - 1].begin())) continue;
    const int a = mesh.region_of_cell[static_cast<std::size_t>(keys[i - 1][8])];
    const int b = mesh.region_of_cell[static_cast<std::size_t>(keys[i][8])];
    if (a != b) pairs.insert(std::minmax(a, b));
  }
  if (pairs.empty()) return;
  std::vector<std::string> list;
  for (const auto& [a, b] : pairs)
    list.push_back(fmt::format("`{}` and `{}`", mesh.regions[static_cast<std::size_t>(a)],
                               mesh.regions[static_cast<std::size_t>(b)]));
  throw InputError(
      "mesh-double-region",
      fmt::format("`{}`: cells belong to two regions: {}", raw.file.string(), fmt::join(list, "; ")),
      "a cell must belong to one region: remove one of the groups");
}

void drop_unused_points(RawMesh& raw) {
  std::vector<int> number(raw.points.size(), -1);
  for (const int p : raw.nodes) number[static_cast<std::size_t>(p)] = 0;
  std::vector<int> kept;
  for (std::size_t p = 0; p < number.size(); ++p) {
    if (number[p] < 0) continue;
    number[p] = static_cast<int>(kept.size());
    kept.push_back(static_cast<int>(p));
  }
  if (kept.size() == raw.points.size()) return;
  raw.note(
      fmt::format("{} points that belong to no volume cell were left out", raw.points.size() - kept.size()));
  std::vector<Eigen::Vector3d> points;
  points.reserve(kept.size());
  for (const int p : kept) points.push_back(raw.points[static_cast<std::size_t>(p)]);
  raw.points = std::move(points);
  for (int& p : raw.nodes) p = number[static_cast<std::size_t>(p)];
  for (RawMesh::Facet& f : raw.facets) {
    // -2: a corner of no volume cell, which no face can match.
    for (int& p : f.corners)
      p = p < 0 ? p : (number[static_cast<std::size_t>(p)] < 0 ? -2 : number[static_cast<std::size_t>(p)]);
  }
  for (auto& [name, set] : raw.node_sets) {
    std::erase_if(set, [&](int p) { return number[static_cast<std::size_t>(p)] < 0; });
    for (int& p : set) p = number[static_cast<std::size_t>(p)];
  }
  for (auto& [name, field] : raw.point_fields) field = Eigen::MatrixXd(field(Eigen::all, kept));
}

void match_surfaces(const RawMesh& raw, Mesh& mesh) {
  for (const std::string& name : raw.surfaces.names) mesh.surfaces.push_back({name, {}});
  if (raw.facets.empty()) return;
  const data::FaceTable table(mesh);
  std::map<std::string, std::size_t> unmatched;
  for (const RawMesh::Facet& facet : raw.facets) {
    const std::size_t corners = facet.corners[3] == -1 ? 3 : 4;
    const auto cells = table.find({facet.corners.data(), corners});
    auto& surface = mesh.surfaces[static_cast<std::size_t>(facet.surface)];
    if (cells.empty()) {
      ++unmatched[surface.name];
    } else {
      surface.faces.push_back(cells.front());  // between two cells: the face of the first
    }
  }
  if (!unmatched.empty()) {
    std::vector<std::string> list;
    for (const auto& [name, n] : unmatched) list.push_back(fmt::format("{} of `{}`", n, name));
    throw InputError(
        "mesh-unmatched-surface",
        fmt::format("`{}`: surface cells that are no face of a volume cell: {}", raw.file.string(),
                    fmt::join(list, ", ")),
        "surface and volume must share their points: mesh them together, or merge coincident points");
  }
  for (data::NamedSurface& s : mesh.surfaces) {
    std::sort(s.faces.begin(), s.faces.end());
    s.faces.erase(std::unique(s.faces.begin(), s.faces.end()), s.faces.end());
  }
}

}  // namespace

const int vtk_order[27] = {0,  1,  2,  3,  4,  5,  6,  7,  8,  9,  10, 11, 12, 13,
                           14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};

void RawMesh::add_cell(data::CellType type, int region, const std::vector<int>& file_nodes,
                       const int* order) {
  types.push_back(type);
  region_of_cell.push_back(region);
  for (int a = 0; a < data::nodes_per_cell(type); ++a)
    nodes.push_back(file_nodes[static_cast<std::size_t>(order[a])]);
}

double metres_per_unit(const std::filesystem::path& file, const MeshReadOptions& options) {
  if (options.length_unit.empty()) {
    throw InputError("mesh-unit-missing",
                     fmt::format("the unit of the coordinates in `{}` is not stated", file.string()),
                     "mesh files hold bare numbers: give the unit, for example \"mm\"");
  }
  return data::convert(1.0, options.length_unit, "m");
}

MeshFile assemble(RawMesh raw, const MeshReadOptions& options) {
  const double scale = metres_per_unit(raw.file, options);
  if (raw.types.empty()) {
    throw InputError("mesh-empty", fmt::format("`{}` holds no volume cells", raw.file.string()),
                     "export tetrahedra or hexahedra, not only the surface");
  }
  check_one_type(raw);
  drop_unused_points(raw);
  Mesh mesh;
  mesh.type = raw.types.front();
  mesh.points.resize(3, static_cast<Eigen::Index>(raw.points.size()));
  for (std::size_t p = 0; p < raw.points.size(); ++p)
    mesh.points.col(static_cast<Eigen::Index>(p)) = scale * raw.points[p];
  mesh.cells = Eigen::Map<const Eigen::MatrixXi>(raw.nodes.data(), data::nodes_per_cell(mesh.type),
                                                 static_cast<Eigen::Index>(raw.types.size()));
  mesh.regions = raw.regions.names;
  mesh.region_of_cell = std::move(raw.region_of_cell);
  mesh.node_sets = std::move(raw.node_sets);
  for (auto& [name, set] : mesh.node_sets) {
    std::sort(set.begin(), set.end());
    set.erase(std::unique(set.begin(), set.end()), set.end());
  }
  mesh.point_fields = std::move(raw.point_fields);
  mesh.cell_fields = std::move(raw.cell_fields);
  check_regions(raw, mesh);
  match_surfaces(raw, mesh);
  std::vector<data::Diagnostic> findings = data::check_structure(mesh);
  if (!findings.empty()) {
    for (data::Diagnostic& d : findings) d.message = fmt::format("`{}`: {}", raw.file.string(), d.message);
    throw InputError(std::move(findings));
  }
  return {std::move(mesh), std::move(raw.notes)};
}

MeshFile read_mesh(const std::filesystem::path& file, const MeshReadOptions& options) {
  const std::string extension = file.extension().string();
  if (extension == ".msh") return read_gmsh(file, options);
  if (extension == ".vtu") return read_vtu(file, options);
  if (extension == ".vtk") return read_vtk(file, options);
  if (extension == ".feb") return read_febio(file, options);
  throw InputError("mesh-unsupported",
                   fmt::format("`{}`: `{}` is no mesh format that can be read", file.string(), extension),
                   "known: .msh (Gmsh 2.2, 4.1), .vtu, .vtk, .feb");
}

}  // namespace brachium::io
