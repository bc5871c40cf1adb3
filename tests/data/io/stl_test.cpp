// Triangle surfaces: text and binary files hold the same tetrahedron; damaged ones are told with their place.

#include "data/io/stl.hpp"

#include <cstdint>

#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using tests::error_of;
using tests::write_file;

const float corners[4][3][3] = {{{0, 0, 0}, {0, 10, 0}, {10, 0, 0}},
                                {{0, 0, 0}, {10, 0, 0}, {0, 0, 10}},
                                {{0, 0, 0}, {0, 0, 10}, {0, 10, 0}},
                                {{10, 0, 0}, {0, 10, 0}, {0, 0, 10}}};

std::string text_file() {
  std::ostringstream out;
  out << "solid a name with blanks\n";
  for (const auto& t : corners) {
    out << "  facet normal 0 0 0\n    outer loop\n";
    for (const auto& c : t) out << "      vertex " << c[0] << " " << c[1] << " " << c[2] << "\n";
    out << "    endloop\n  endfacet\n";
  }
  out << "endsolid a name with blanks\n";
  return out.str();
}

std::string binary_file() {
  std::string out = "solid, says the header of some binary files";
  out.resize(80, ' ');
  const auto put = [&out](const auto& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  put(std::uint32_t{4});
  for (const auto& t : corners) {
    for (int i = 0; i < 3; ++i) put(0.0F);
    for (const auto& c : t) {
      for (const float x : c) put(x);
    }
    put(std::uint16_t{0});
  }
  return out;
}

TEST(Stl, TextAndBinaryFilesGiveTheSameSurfaceInMetres) {
  const auto folder = tests::scratch_dir();
  const TriangleFile a = read_stl(write_file(folder / "a.stl", text_file()), "mm");
  const TriangleFile b = read_stl(write_file(folder / "b.stl", binary_file()), "mm");
  EXPECT_EQ(a.points.cols(), 4) << "corners that coincide are one point";
  ASSERT_EQ(a.triangles.cols(), 4);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.points, b.points);
  EXPECT_DOUBLE_EQ(a.points.maxCoeff(), 0.01);
}

TEST(Stl, DamagedFilesAreToldWithTheirPlace) {
  const auto folder = tests::scratch_dir();
  std::string text = text_file();
  text.replace(text.find("endloop"), 7, "endlop");
  EXPECT_NE(error_of([&] { read_stl(write_file(folder / "a.stl", text), "mm"); }, folder)
                .find("error[mesh-syntax]: `endlop` where `endloop` should stand\n  --> a.stl:7"),
            std::string::npos);
  EXPECT_NE(
      error_of([&] { read_stl(write_file(folder / "b.stl", text_file().substr(0, 200)), "mm"); }, folder)
          .find("error[mesh-truncated]"),
      std::string::npos);
  std::string binary = binary_file();
  binary[0] = 'x';  // no longer "solid": the count decides
  EXPECT_NE(error_of([&] { read_stl(write_file(folder / "c.stl", binary.substr(0, 150)), "mm"); }, folder)
                .find("error[mesh-truncated]"),
            std::string::npos);
  EXPECT_NE(error_of([&] { read_stl(write_file(folder / "d.stl", binary), ""); }, folder)
                .find("error[mesh-unit-missing]"),
            std::string::npos);
}

}  // namespace
}  // namespace brachium::io
