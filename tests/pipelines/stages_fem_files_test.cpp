// Mesh files through fem.solve: regions, surfaces and fibres by name, the same body from every program.

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "stages_fem_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string sample(const std::string& name) {
  return (brachium::tests::source_dir() / "tests/data/io/meshes" / name).string();
}

/// The samples' body [0, 20] x [0, 10] x [0, 10] mm, two regions along x, pulled at its ends, which may not
/// contract.
std::string pulled(const std::string& file, const std::string& element, const std::string& more = "") {
  return "element = \"" + element + "\"\nmesh = { file = \"" + file + "\", length_unit = \"mm\"" + more +
         " }\n" + R"(
material = [
  { regions = ["muscle"], law = "neo_hooke", shear_modulus_pa = 2e4, bulk_modulus_pa = 2e6 },
  { regions = ["tendon"], law = "neo_hooke", shear_modulus_pa = 2e5, bulk_modulus_pa = 2e7 },
]
boundary = [
  { name = "bone", surface = "origin", kind = "fixed" },
  { name = "pull", surface = "insertion", kind = "displacement", x_m = 0.002, y_m = 0, z_m = 0 },
]
phase = [{ name = "stretch", amplitude = { pull = 1.0 }, steps = 1 }]
output = [
  { name = "end", kind = "reaction", surface = "insertion" },
  { name = "soft", kind = "volume", regions = ["muscle"] },
  { name = "interface", kind = "displacement", point_m = [0.01, 0.005, 0.005] },
]
)";
}

const std::string vtk_names = ", region_numbers = { tendon = 1, muscle = 2, origin = 7, insertion = 8 }";

TEST(FemFiles, TheSameHexahedraFromEveryFormatGiveTheSameForce) {
  const StageData gmsh = solved(pulled(sample("hex27_41_binary.msh"), "q2_p1_discontinuous"));
  const double force = last(gmsh, "end_N"), place = last(gmsh, "interface_x_m");
  EXPECT_LT(place, 0.0005) << "the tendon, ten times as stiff, hardly gives";
  EXPECT_NEAR(last(gmsh, "soft_m3"), 1e-6, 2e-8);
  for (const auto& [file, more] : {std::pair{"hex27_22.msh", std::string()},
                                   {"hex27_raw_zlib.vtu", vtk_names},
                                   {"hex27_51.vtk", vtk_names},
                                   {"hex27_40.feb", std::string()}}) {
    const StageData data = solved(pulled(sample(file), "q2_p1_discontinuous", more));
    EXPECT_NEAR(last(data, "end_N"), force, 1e-9 * force) << file;
    EXPECT_NEAR(last(data, "interface_x_m"), place, 1e-12) << file;
    EXPECT_THAT(data.attributes.at("mesh"), AllOf(HasSubstr(file), HasSubstr("coordinates in mm")));
  }
}

TEST(FemFiles, LinearCellsAreElevatedWhereAskedFor) {
  const double force = last(solved(pulled(sample("hex27_41.msh"), "q2_p1_discontinuous")), "end_N");
  const StageData hexahedra =
      solved(pulled(sample("hex8_25.feb"), "q2_p1_discontinuous", ", elevate = true"));
  EXPECT_NEAR(last(hexahedra, "end_N"), force, 1e-9 * force) << "its faces are plane";
  EXPECT_THAT(hexahedra.attributes.at("mesh"), HasSubstr("hex8 elevated to hex27"));
  const double tetrahedra =
      last(solved(pulled(sample("tet4_22.msh"), "p2_p1_taylor_hood", ", elevate = true")), "end_N");
  EXPECT_NEAR(tetrahedra, last(solved(pulled(sample("tet10_41.msh"), "p2_p1_taylor_hood")), "end_N"),
              1e-9 * force);
  EXPECT_NEAR(tetrahedra, force, 0.1 * force);
  EXPECT_THAT(mistakes(pulled(sample("hex8_25.feb"), "q2_p1_discontinuous")),
              AllOf(HasSubstr("error[cell-type-mismatch]"), HasSubstr("elevate = true")));
}

TEST(FemFiles, TheSameTetrahedraFromEveryFormatGiveTheSameForce) {
  for (const std::string element : {"p2_p1_taylor_hood", "p2b_p1_discontinuous"}) {
    const StageData vtu = solved(pulled(sample("tet10_raw.vtu"), element, vtk_names));
    const double force = last(vtu, "end_N");
    EXPECT_NEAR(force, last(solved(pulled(sample("tet10_41.msh"), element)), "end_N"), 0.1 * force)
        << "another cut of the same body";
    EXPECT_NEAR(last(vtu, "soft_m3"), 1e-6, 2e-8);
    for (const auto& [file, more] : {std::pair{"tet10_51.vtk", vtk_names},
                                     {"tet10_51_binary.vtk", vtk_names},
                                     {"tet10_40.feb", std::string()}})
      EXPECT_NEAR(last(solved(pulled(sample(file), element, more)), "end_N"), force, 1e-9 * force)
          << element << ", " << file;
  }
}

/// Smallest and largest x (or z) distance between neighbouring planes of nodes on the surface.
std::pair<double, double> spacings(const StageData& data, const std::string& axis) {
  std::vector<double> at = data.tables.at("surface_points").numbers(axis);
  std::sort(at.begin(), at.end());
  double least = 1.0, most = 0.0;
  for (std::size_t k = 1; k < at.size(); ++k) {
    const double d = at[k] - at[k - 1];
    if (d < 1e-6) continue;
    least = std::min(least, d);
    most = std::max(most, d);
  }
  return {least, most};
}

TEST(FemFiles, BelliesAreGradedWhereAskedFor) {
  const auto belly = [](const std::string& grading) {
    return solved(
        "mesh = { spindle = { belly_m = 0.06, belly_cells = 6, belly_radius_m = 0.01, tendon_radius_m = "
        "0.008, core_cells = 1" +
        grading + R"( } }
material = [{ law = "neo_hooke", shear_modulus_pa = 2e4, incompressible = true }]
boundary = [
  { name = "bone", surface = "origin", kind = "fixed" },
  { name = "pull", surface = "insertion", kind = "displacement", x_m = 0, y_m = 0, z_m = 0.001 },
]
phase = [{ name = "stretch", amplitude = { pull = 1.0 }, steps = 1 }]
)");
  };
  const auto [even_least, even_most] = spacings(belly(""), "z_m");
  EXPECT_NEAR(even_least, 0.005, 1e-9) << "half a cell: midside nodes";
  EXPECT_NEAR(even_most, 0.005, 1e-9);
  const auto [least, most] = spacings(belly(", belly_grading = 4"), "z_m");
  EXPECT_NEAR(most / least, 4.0, 1e-6);
}

/// Fibres along y in a muscle that is pulled along x bear nothing; along x they stiffen it.
std::string fibrous(const std::string& file, const std::string& field, const std::string& more = "") {
  std::string options = pulled(file, "q2_p1_discontinuous", more);
  options = with(options, "law = \"neo_hooke\", shear_modulus_pa = 2e4, bulk_modulus_pa = 2e6",
                 "set = \"sprenger\", muscle_c3_pa = 1e3, bulk_modulus_pa = 2e6");
  return with(
      options, "boundary",
      "fibre = [{ regions = [\"muscle\"], kind = \"mesh_field\", field = \"" + field + "\" }]\nboundary");
}

TEST(FemFiles, FibresThatAFileBringsAlongAreThoseOfTheSolve) {
  const std::string file = sample("hex27_raw.vtu");
  const StageData brought = solved(fibrous(file, "fibre", vtk_names));  // (1, 0, 0) by cell
  const StageData stated =
      solved(with(fibrous(file, "fibre", vtk_names), "kind = \"mesh_field\", field = \"fibre\"",
                  "kind = \"constant\", direction = [1, 0, 0]"));
  EXPECT_DOUBLE_EQ(last(brought, "end_N"), last(stated, "end_N"));
  EXPECT_THAT(mistakes(fibrous(file, "fibres", vtk_names)),
              AllOf(HasSubstr("`fibres`"), HasSubstr("did you mean `fibre`?")));
}

TEST(FemFiles, FibresOfAFebioFileAreReadFromItsMeshData) {
  std::stringstream text;
  text << std::ifstream(sample("hex27_40.feb")).rdbuf();
  std::string content = text.str();
  content.insert(content.find("</febio_spec>"),
                 "<MeshData><ElementData type=\"mat_axis\" elem_set=\"muscle\"><e "
                 "lid=\"1\"><a>1,0,0</a><d>0,1,0</d></e></ElementData></MeshData>\n");
  const std::filesystem::path file = brachium::tests::scratch_dir() / "fibres.feb";
  std::ofstream(file) << content;
  const StageData read = solved(fibrous(file.string(), "mat_axis_a"));
  const StageData stated =
      solved(with(fibrous(file.string(), "mat_axis_a"), "kind = \"mesh_field\", field = \"mat_axis_a\"",
                  "kind = \"constant\", direction = [1, 0, 0]"));
  EXPECT_DOUBLE_EQ(last(read, "end_N"), last(stated, "end_N"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
