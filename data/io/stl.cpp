#include "data/io/stl.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

#include "data/io/mesh_cursor.hpp"
#include "data/model/error.hpp"
#include "data/model/units.hpp"

namespace brachium::io {
namespace {

using Corner = std::array<double, 3>;

constexpr std::size_t header_bytes = 80, bytes_per_triangle = 50;

/// Text files begin with "solid", and so do the headers of some binary ones: only the size tells them apart.
bool is_binary(const std::string& text) {
  if (text.size() < header_bytes + 4) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, text.data() + header_bytes, 4);
  return text.size() == header_bytes + 4 + bytes_per_triangle * static_cast<std::size_t>(count) ||
         text.compare(0, 5, "solid") != 0;
}

std::vector<Corner> binary_corners(MeshCursor& cursor) {
  cursor.set_binary(true);
  cursor.seek(header_bytes);
  const auto triangles = cursor.raw<std::uint32_t>("number of triangles");
  cursor.checked_count(triangles, "triangles", bytes_per_triangle);
  std::vector<Corner> corners;
  for (std::uint32_t t = 0; t < triangles; ++t) {
    for (int i = 0; i < 3; ++i) cursor.raw<float>("normal");
    for (int i = 0; i < 3; ++i) {
      Corner c{};
      for (double& x : c) {
        x = cursor.raw<float>("corner");
        if (!std::isfinite(x)) cursor.fail("mesh-syntax", "a corner is not finite");
      }
      corners.push_back(c);
    }
    cursor.raw<std::uint16_t>("attribute");
  }
  return corners;
}

std::vector<Corner> text_corners(MeshCursor& cursor) {
  const auto expect = [&](const char* word) {
    cursor.peek();  // the place of the word, not of the blanks before it
    const std::size_t at = cursor.at();
    const std::string_view got = cursor.token(word);
    if (got != word)
      cursor.fail_at(at, "mesh-syntax", fmt::format("`{}` where `{}` should stand", got, word));
  };
  std::vector<Corner> corners;
  expect("solid");
  cursor.line();
  while (cursor.peek() == "facet") {
    expect("facet");
    expect("normal");
    for (int i = 0; i < 3; ++i) cursor.number("normal");
    expect("outer");
    expect("loop");
    for (int i = 0; i < 3; ++i) {
      expect("vertex");
      Corner c{};
      for (double& x : c) x = cursor.number("corner");
      corners.push_back(c);
    }
    expect("endloop");
    expect("endfacet");
  }
  expect("endsolid");
  return corners;
}

}  // namespace

TriangleFile read_stl(const std::filesystem::path& file, const std::string& length_unit) {
  if (length_unit.empty()) {
    throw data::InputError("mesh-unit-missing",
                           fmt::format("the unit of the coordinates in `{}` is not stated", file.string()),
                           "STL files hold bare numbers: give the unit, for example \"mm\"");
  }
  const double scale = data::convert(1.0, length_unit, "m");
  MeshCursor cursor(file);
  const std::vector<Corner> corners =
      is_binary(cursor.text()) ? binary_corners(cursor) : text_corners(cursor);
  std::map<Corner, int> place;
  TriangleFile out;
  out.triangles.resize(3, static_cast<Eigen::Index>(corners.size() / 3));
  std::vector<Corner> points;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto [at, added] = place.try_emplace(corners[k], static_cast<int>(points.size()));
    if (added) points.push_back(corners[k]);
    out.triangles(static_cast<Eigen::Index>(k % 3), static_cast<Eigen::Index>(k / 3)) = at->second;
  }
  out.points.resize(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t p = 0; p < points.size(); ++p)
    out.points.col(static_cast<Eigen::Index>(p)) =
        scale * Eigen::Map<const Eigen::Vector3d>(points[p].data());
  return out;
}

}  // namespace brachium::io
