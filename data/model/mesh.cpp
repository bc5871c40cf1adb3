#include "data/model/mesh.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace brachium::data {
namespace {

// Local nodes of faces: corners counter-clockwise seen from outside, the edge nodes between them, the centre.
constexpr int hexahedron_faces[6][9] = {{0, 4, 7, 3, 16, 15, 19, 11, 20}, {1, 2, 6, 5, 9, 18, 13, 17, 21},
                                        {0, 1, 5, 4, 8, 17, 12, 16, 22},  {3, 7, 6, 2, 19, 14, 18, 10, 23},
                                        {0, 3, 2, 1, 11, 10, 9, 8, 24},   {4, 5, 6, 7, 12, 13, 14, 15, 25}};
constexpr int tetrahedron_faces[4][6] = {
    {1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 1, 6, 5, 4}};

std::size_t face_size(CellType type) {
  switch (type) {
    case CellType::tet4:
      return 3;
    case CellType::tet10:
      return 6;
    case CellType::hex8:
      return 4;
    case CellType::hex20:
      return 8;
    case CellType::hex27:
      return 9;
  }
  return 0;
}

}  // namespace

int nodes_per_cell(CellType type) {
  switch (type) {
    case CellType::tet4:
      return 4;
    case CellType::tet10:
      return 10;
    case CellType::hex8:
      return 8;
    case CellType::hex20:
      return 20;
    case CellType::hex27:
      return 27;
  }
  return 0;
}

int corners_per_cell(CellType type) {
  return type == CellType::tet4 || type == CellType::tet10 ? 4 : 8;
}

int faces_per_cell(CellType type) {
  return type == CellType::tet4 || type == CellType::tet10 ? 4 : 6;
}

std::string to_string(CellType type) {
  switch (type) {
    case CellType::tet4:
      return "tet4";
    case CellType::tet10:
      return "tet10";
    case CellType::hex8:
      return "hex8";
    case CellType::hex20:
      return "hex20";
    case CellType::hex27:
      return "hex27";
  }
  return "";
}

std::span<const int> face_nodes(CellType type, int face) {
  const auto f = static_cast<std::size_t>(face);
  const int* first = corners_per_cell(type) == 4 ? tetrahedron_faces[f] : hexahedron_faces[f];
  return {first, face_size(type)};
}

const NamedSurface& Mesh::surface(const std::string& name) const {
  std::vector<std::string> known;
  for (const NamedSurface& s : surfaces) {
    if (s.name == name) return s;
    known.push_back(s.name);
  }
  throw InputError("missing-surface", fmt::format("the mesh has no surface `{}`", name),
                   known.empty() ? "it has no named surfaces at all" : suggest(name, known));
}

int Mesh::region(const std::string& name) const {
  const auto found = std::find(regions.begin(), regions.end(), name);
  if (found == regions.end()) {
    throw InputError("missing-region", fmt::format("the mesh has no region `{}`", name),
                     regions.empty() ? "it has no regions at all" : suggest(name, regions));
  }
  return static_cast<int>(found - regions.begin());
}

std::vector<int> Mesh::surface_points(const std::string& name) const {
  std::vector<int> list;
  for (const CellFace& f : surface(name).faces) {
    for (const int local : face_nodes(type, f.face)) list.push_back(cells(local, f.cell));
  }
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

// ---------------------------------------------------------------- faces

namespace {

FaceTable::Key key_of(std::span<const int> corners) {
  FaceTable::Key key{-1, -1, -1, -1};
  for (std::size_t i = 0; i < corners.size() && i < 4; ++i) key[i] = corners[i];
  std::sort(key.begin(), key.end());
  return key;
}

}  // namespace

FaceTable::FaceTable(const Mesh& mesh) {
  const int faces = faces_per_cell(mesh.type);
  const std::size_t corners = corners_per_cell(mesh.type) == 4 ? 3 : 4;
  entries_.reserve(static_cast<std::size_t>(mesh.cell_count()) * static_cast<std::size_t>(faces));
  std::array<int, 4> points{};
  for (int c = 0; c < mesh.cell_count(); ++c) {
    for (int f = 0; f < faces; ++f) {
      const auto local = face_nodes(mesh.type, f);
      for (std::size_t i = 0; i < corners; ++i) points[i] = mesh.cells(local[i], c);
      entries_.push_back({key_of({points.data(), corners}), {c, f}});
    }
  }
  std::sort(entries_.begin(), entries_.end());
}

std::vector<CellFace> FaceTable::find(std::span<const int> corners) const {
  std::vector<CellFace> found;
  if (corners.size() != 3 && corners.size() != 4) return found;
  const Key key = key_of(corners);
  auto at = std::lower_bound(entries_.begin(), entries_.end(), key,
                             [](const Entry& entry, const Key& k) { return entry.key < k; });
  for (; at != entries_.end() && at->key == key; ++at) found.push_back(at->face);
  return found;
}

std::vector<CellFace> boundary_faces(const Mesh& mesh) {
  const FaceTable table(mesh);
  const auto& entries = table.entries();
  std::vector<CellFace> boundary;
  for (std::size_t i = 0; i < entries.size();) {
    std::size_t next = i + 1;
    while (next < entries.size() && entries[next].key == entries[i].key) ++next;
    if (next == i + 1) boundary.push_back(entries[i].face);
    i = next;
  }
  std::sort(boundary.begin(), boundary.end());
  return boundary;
}

}  // namespace brachium::data
