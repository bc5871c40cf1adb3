#include "data/io/triangle_file.hpp"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <vector>

#include "data/io/mesh_cursor.hpp"
#include "data/io/mesh_raw.hpp"

namespace brachium::io {
namespace {

/// Triangles as they are read; equal corners become one point where `merge` asks for it.
class Gathered {
 public:
  int point(const Eigen::Vector3d& x, bool merge) {
    if (merge) {
      const auto [found, is_new] = number_.try_emplace({x[0], x[1], x[2]}, static_cast<int>(points_.size()));
      if (!is_new) return found->second;
    }
    points_.push_back(x);
    return static_cast<int>(points_.size()) - 1;
  }
  void triangle(int a, int b, int c) { triangles_.emplace_back(a, b, c); }
  std::size_t point_count() const { return points_.size(); }

  TriangleFile take(const std::filesystem::path& file, double scale) const {
    if (triangles_.empty())
      throw data::InputError("mesh-empty", fmt::format("`{}` holds no triangles", file.string()),
                             "export the surface of the body");
    TriangleFile out;
    out.points.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t p = 0; p < points_.size(); ++p)
      out.points.col(static_cast<Eigen::Index>(p)) = scale * points_[p];
    out.triangles.resize(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      out.triangles.col(static_cast<Eigen::Index>(t)) = triangles_[t];
    return out;
  }

 private:
  std::vector<Eigen::Vector3d> points_;
  std::vector<Eigen::Vector3i> triangles_;
  std::map<std::array<double, 3>, int> number_;
};

constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

/// A binary file may begin with `solid` as well; no text holds a zero byte, and no count of triangles is
/// without one.
bool is_binary_stl(const MeshCursor& in) {
  return !in.text().starts_with("solid") || in.text().find('\0') < kStlHeader;
}

void read_binary_stl(MeshCursor& in, Gathered& out) {
  in.set_binary(true);
  in.need(kStlHeader, "the header");
  in.seek(kStlHeader - sizeof(std::uint32_t));
  const std::size_t count =
      in.checked_count(in.raw<std::uint32_t>("the number of triangles"), "triangles", kStlTriangle);
  for (std::size_t t = 0; t < count; ++t) {
    in.need(kStlTriangle, "a triangle");
    const std::size_t start = in.at();
    std::array<int, 3> corner{};
    in.seek(start + 3 * sizeof(float));  // behind the normal
    for (int& c : corner) {
      Eigen::Vector3d x;
      for (double& v : x) v = static_cast<double>(in.raw<float>("a corner"));
      if (!x.allFinite()) in.fail("mesh-syntax", "a coordinate is not finite");
      c = out.point(x, true);
    }
    out.triangle(corner[0], corner[1], corner[2]);
    in.seek(start + kStlTriangle);
  }
}

void expect(MeshCursor& in, const char* word) {
  const std::string_view found = in.peek();
  if (!found.empty() && found != word) {
    in.fail("mesh-syntax", fmt::format("`{}` stands where `{}` should", found.substr(0, 40), word));
  }
  in.token(word);
}

void read_ascii_stl(MeshCursor& in, Gathered& out) {
  while (!in.at_end()) {
    expect(in, "solid");
    in.line();
    while (in.peek() == "facet") {
      expect(in, "facet");
      expect(in, "normal");
      for (int i = 0; i < 3; ++i) in.token("a normal");  // some programs write nan
      expect(in, "outer");
      expect(in, "loop");
      std::array<int, 3> corner{};
      for (int& c : corner) {
        expect(in, "vertex");
        Eigen::Vector3d x;
        for (double& v : x) v = in.number("a coordinate");
        c = out.point(x, true);
      }
      expect(in, "endloop");
      expect(in, "endfacet");
      out.triangle(corner[0], corner[1], corner[2]);
    }
    expect(in, "endsolid");
    in.line();
  }
}

/// "7", "7/2", "7//3", "-1": from 1, or from the end.
int obj_index(const MeshCursor& in, std::size_t at, std::string_view word, std::size_t points) {
  const std::string_view digits = word.substr(0, word.find('/'));
  long long index = 0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
  if (status != std::errc() || end != digits.data() + digits.size())
    in.fail_at(at, "mesh-syntax", fmt::format("`{}` is no corner of a face", word.substr(0, 40)));
  const long long from_zero = index < 0 ? static_cast<long long>(points) + index : index - 1;
  if (from_zero < 0 || from_zero >= static_cast<long long>(points))
    in.fail_at(at, "mesh-index",
               fmt::format("a face names point {}, and {} points came before it", index, points));
  return static_cast<int>(from_zero);
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(" \t"); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(" \t", end);
  }
  return words;
}

void read_obj(MeshCursor& in, Gathered& out) {
  while (in.left() > 0) {
    const std::size_t at = in.at();
    const auto words = words_of(in.line());
    if (words.empty()) continue;
    if (words[0] == "v") {
      if (words.size() < 4) in.fail_at(at, "mesh-syntax", "a point has fewer than three coordinates");
      const std::size_t behind = in.at();
      in.seek(at);
      in.token("v");
      Eigen::Vector3d x;
      for (double& v : x) v = in.number("a coordinate");
      out.point(x, false);
      in.seek(behind);
    } else if (words[0] == "f") {
      if (words.size() < 4)
        in.fail_at(at, "mesh-syntax", fmt::format("a face has {} corners", words.size() - 1));
      std::vector<int> corner;
      for (std::size_t k = 1; k < words.size(); ++k)
        corner.push_back(obj_index(in, at, words[k], out.point_count()));
      for (std::size_t k = 2; k < corner.size(); ++k) out.triangle(corner[0], corner[k - 1], corner[k]);
    }
  }
}

}  // namespace

TriangleFile read_triangles(const std::filesystem::path& file, const std::string& length_unit) {
  MeshReadOptions unit;
  unit.length_unit = length_unit;
  const double scale = metres_per_unit(file, unit);
  const std::string extension = file.extension().string();
  if (extension != ".stl" && extension != ".obj")
    throw data::InputError(
        "mesh-unsupported",
        fmt::format("`{}`: `{}` is no format of triangles that can be read", file.string(), extension),
        "known: .stl, .obj");
  MeshCursor in(file);
  Gathered gathered;
  if (extension == ".obj")
    read_obj(in, gathered);
  else if (is_binary_stl(in))
    read_binary_stl(in, gathered);
  else
    read_ascii_stl(in, gathered);
  return gathered.take(file, scale);
}

}  // namespace brachium::io
