// Triangles of rigid bodies: the same tetrahedron from every format, and what is said of broken files.

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cstring>

#include "data/io/triangle_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

/// Corners of a tetrahedron with volume 1/6 of the cube of its legs, faces counter-clockwise from outside.
const std::vector<Eigen::Vector3d> corners{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
const std::vector<std::array<int, 3>> faces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

std::string ascii_stl() {
  std::string text = "solid bone of 2020\n";
  for (const auto& f : faces) {
    text += "facet normal nan 0 0\n outer loop\n";
    for (const int c : f)
      text += fmt::format("  vertex {} {:e} {}\n", corners[static_cast<std::size_t>(c)][0],
                          corners[static_cast<std::size_t>(c)][1], corners[static_cast<std::size_t>(c)][2]);
    text += " endloop\nendfacet\n";
  }
  return text + "endsolid bone\n";
}

std::string binary_stl() {
  std::string bytes = "solid, although it is binary";
  bytes.resize(80, ' ');
  const auto put = [&](const auto& value) {
    char raw[sizeof(value)];
    std::memcpy(raw, &value, sizeof(value));
    bytes.append(raw, sizeof(value));
  };
  put(static_cast<std::uint32_t>(faces.size()));
  for (const auto& f : faces) {
    for (int i = 0; i < 3; ++i) put(0.0f);
    for (const int c : f) {
      for (int i = 0; i < 3; ++i) put(static_cast<float>(corners[static_cast<std::size_t>(c)][i]));
    }
    put(std::uint16_t{0});
  }
  return bytes;
}

const std::string obj =
    "# a comment\no bone\nv 0 0 0\nv 2 0 0\nvn 0 0 1\nv 0 2 0 1.0\nv 0 0 2\ns off\nf 1 3 2\nf 1//1 2//1 "
    "4//1\nf -4 -1 -2\nf 2/1/1 3/1/1 4/1/1\n";

double volume(const TriangleFile& t) {
  double sum = 0.0;
  for (int k = 0; k < t.triangles.cols(); ++k) {
    const auto x = [&](int i) -> Eigen::Vector3d { return t.points.col(t.triangles(i, k)); };
    sum += x(0).dot(x(1).cross(x(2))) / 6.0;
  }
  return sum;
}

class TriangleFiles : public ::testing::Test {
 protected:
  TriangleFile read(const std::string& name, const std::string& text) {
    return read_triangles(tests::write_file(dir / name, text), "mm");
  }
  std::string error(const std::string& name, const std::string& text) {
    const std::filesystem::path file = tests::write_file(dir / name, text);
    return tests::error_of([&] { read_triangles(file, "mm"); }, dir);
  }
  const std::filesystem::path dir = tests::scratch_dir();
};

TEST_F(TriangleFiles, EveryFormatGivesOneClosedBody) {
  for (const auto& [name, text] :
       {std::pair{"a.stl", ascii_stl()}, {"b.stl", binary_stl()}, {"c.obj", obj}}) {
    const TriangleFile t = read(name, text);
    EXPECT_EQ(t.points.cols(), 4) << name;
    EXPECT_EQ(t.triangles.cols(), 4) << name;
    EXPECT_NEAR(volume(t), 8e-9 / 6.0, 1e-22) << name;
  }
}

TEST_F(TriangleFiles, FacesOfMoreCornersAreCutIntoAFan) {
  const TriangleFile t = read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
  EXPECT_EQ(t.triangles, (Eigen::MatrixXi(3, 2) << 0, 0, 1, 2, 2, 3).finished());
}

TEST_F(TriangleFiles, BrokenFilesAreRefusedWithTheirPlace) {
  EXPECT_EQ(error("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n").substr(0, 84),
            "error[mesh-index]: a face names point 7, and 3 points came before it\n  --> a.obj:4:1");
  EXPECT_EQ(error("b.obj", "v 0 0\nv 1 0 0\n").substr(0, 76),
            "error[mesh-syntax]: a point has fewer than three coordinates\n  --> b.obj:1:1");
  EXPECT_EQ(error("c.obj", "v 0 0 0\n").substr(0, 17), "error[mesh-empty]");
  EXPECT_EQ(error("d.stl", binary_stl().substr(0, 200)).substr(0, 21), "error[mesh-truncated]");
  std::string text = ascii_stl();
  text.replace(text.find("endloop"), 7, "vertex ");
  EXPECT_NE(error("e.stl", text).find("`vertex` stands where `endloop` should\n  --> e.stl:7:2"),
            std::string::npos);
  EXPECT_EQ(error("f.ply", "ply").substr(0, 23), "error[mesh-unsupported]");
  EXPECT_NE(tests::error_of([&] {
              read_triangles(tests::write_file(dir / "g.obj", obj), "");
            }).find("mesh-unit-missing"),
            std::string::npos);
}

}  // namespace
}  // namespace brachium::io
