// fem.muscle_map on a limb file whose muscles are meshes: taken out of the parametric bodies, written, read back.

#include <gmock/gmock.h>

#include <fstream>

#include "fem/limb/in_situ.hpp"
#include "fem/mesh/convert.hpp"
#include "pipelines/stages/limb_scene.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

std::filesystem::path shipped() {
  return brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml";
}

/// A legacy VTK file in millimetres: cells of region r have the number 1 + r, surfaces 101 and 102.
void write_vtk(const std::filesystem::path& file, const data::Mesh& mesh) {
  const bool tetrahedra = mesh.type == data::CellType::tet10;
  std::ofstream out(file);
  out.precision(17);
  std::ostringstream cells, types, numbers;
  Eigen::Index count = 0, entries = 0;
  const auto add = [&](const auto& nodes, int type, int number) {
    cells << nodes.size();
    for (const int n : nodes) cells << ' ' << n;
    cells << '\n';
    types << type << '\n';
    numbers << number << '\n';
    ++count;
    entries += static_cast<Eigen::Index>(nodes.size()) + 1;
  };
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const std::vector<int> nodes(mesh.cells.col(c).begin(), mesh.cells.col(c).end());
    add(nodes, tetrahedra ? 24 : 29, 1 + mesh.region_of_cell[static_cast<std::size_t>(c)]);
  }
  for (const auto& [name, number] : {std::pair{"origin", 101}, std::pair{"insertion", 102}}) {
    for (const data::CellFace& f : mesh.surface(name).faces) {
      std::vector<int> nodes;
      for (const int local : data::face_nodes(mesh.type, f.face)) nodes.push_back(mesh.cells(local, f.cell));
      add(nodes, tetrahedra ? 22 : 28, number);
    }
  }
  out << "# vtk DataFile Version 3.0\nmuscle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << mesh.point_count()
      << " double\n";
  for (int p = 0; p < mesh.point_count(); ++p) out << 1e3 * mesh.points.col(p).transpose() << '\n';
  out << "CELLS " << count << ' ' << entries << '\n'
      << cells.str() << "CELL_TYPES " << count << '\n'
      << types.str() << "CELL_DATA " << count << "\nSCALARS region int 1\nLOOKUP_TABLE default\n"
      << numbers.str();
}

/// The shipped limb's biceps as a mesh of the file `biceps.vtk`; `keys` beside it.
std::string with_mesh(const std::string& keys) {
  std::ifstream in(shipped());
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto replace = [&](const std::string& from, const std::string& until, const std::string& to) {
    const std::size_t at = text.find(from), end = text.find(until, at);
    text.replace(at, end - at, to);
  };
  replace("belly = {", "pre_stretch",
          "mesh = { file = \"biceps.vtk\", length_unit = \"mm\", " + keys + " }\n");
  replace("tendons = {", "standoff_mm", "");
  return text;
}

const std::string surfaces = "origin = \"from\", insertion = \"to\"";
const std::string numbers = ", region_numbers = { muscle = 1, sheet = 2, from = 101, to = 102 }";

class LimbMeshStage : public ::testing::Test {
 protected:
  StageData map(const std::string& limb_text) {
    std::ofstream(folder_ / "limb.toml") << limb_text;
    return of(folder_ / "limb.toml");
  }
  StageData of(const std::filesystem::path& limb, int cells = 4) {
    return run("fem.muscle_map", "limb = \"" + limb.string() +
                                     "\"\nmesh = { belly_cells = " + std::to_string(cells) +
                                     " }\nmuscles = [\"biceps\"]\nsurrogate = "
                                     "\"none\"\nangle_deg = [110]\nactivation = [0, 0.5]\n");
  }
  static fem::MuscleBody biceps() {
    return read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4}).muscle("biceps").body;
  }
  static double force(const StageData& map, std::size_t row) {
    return map.tables.at("states").numbers("force_N")[row];
  }

  const std::filesystem::path folder_ = brachium::tests::scratch_dir();
};

TEST_F(LimbMeshStage, StressFreeHexahedraHaveTheForcesOfTheParametricBody) {
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  write_vtk(folder_ / "biceps.vtk", *fem::build(biceps(), limb.range).problem.mesh);
  const StageData imported = map(with_mesh("shape = \"stress_free\", " + surfaces + numbers));
  const StageData parametric = of(shipped());
  for (const std::size_t row : {0u, 1u})
    EXPECT_NEAR(force(imported, row), force(parametric, row), 1e-4 * force(parametric, row));
}

TEST_F(LimbMeshStage, StressFreeTetrahedraComeCloserToHexahedraAsTheMeshIsRefined) {
  std::array<std::vector<double>, 2> off;
  for (const int cells : {4, 8}) {
    const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = cells});
    write_vtk(folder_ / "biceps.vtk",
              fem::split_into_tetrahedra(*fem::build(limb.muscle("biceps").body, limb.range).problem.mesh));
    const StageData imported = map(with_mesh("shape = \"stress_free\", " + surfaces + numbers));
    const StageData parametric = of(shipped(), cells);
    EXPECT_EQ(imported.tables.at("states").texts("outcome")[1], "stable");
    for (const std::size_t row : {0u, 1u})
      off[row].push_back(force(imported, row) / force(parametric, row) - 1.0);
  }
  for (const std::vector<double>& error : off) {
    EXPECT_GT(error[0], 0.0) << "coarse tetrahedra are stiffer";
    EXPECT_LT(std::abs(error[1]), 0.5 * error[0]);
    EXPECT_LT(std::abs(error[1]), 0.07);
  }
}

TEST_F(LimbMeshStage, AMeshInSituIsMadeStressFreeOnceAndThatIsSaid) {
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  fem::MuscleStates states(biceps(), limb.range, limb.hinge, limb.humerus);
  const fem::SolveState& at = states.solved(limb.range.upper_rad, 0.0);
  data::Mesh in_situ = *states.problem().mesh;
  in_situ.points += at.configuration.dofs.head(in_situ.points.size()).reshaped(3, in_situ.points.cols());
  write_vtk(folder_ / "biceps.vtk", in_situ);
  const StageData imported = map(with_mesh("shape = \"in_situ\", " + surfaces + numbers));
  EXPECT_THAT(imported.attributes.at("stress_free_shapes"),
              HasSubstr("biceps: stress-free shape found from the shape in situ by "));
  const StageData parametric = of(shipped());
  EXPECT_NEAR(force(imported, 1), force(parametric, 1), 0.01 * force(parametric, 1));
}

TEST_F(LimbMeshStage, ARegionOfTheMeshMayBeASheetOfTendon) {
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  data::Mesh mesh = *fem::build(biceps(), limb.range).problem.mesh;
  // Every fourth cell is tendon: stiffer along the fibres, and without active stress.
  mesh.regions = {"muscle", "sheet"};
  for (std::size_t c = 0; c < mesh.region_of_cell.size(); ++c) mesh.region_of_cell[c] = c % 4 == 0 ? 1 : 0;
  write_vtk(folder_ / "biceps.vtk", mesh);
  const std::string keys = "shape = \"stress_free\", " + surfaces + numbers;
  const StageData plain = map(with_mesh(keys)), sheets = map(with_mesh(keys + ", tendons = [\"sheet\"]"));
  EXPECT_GT(force(sheets, 0), force(plain, 0));
  EXPECT_EQ(sheets.tables.at("states").texts("outcome")[1], "stable");
}

TEST_F(LimbMeshStage, TellsWhatIsWrongWithTheMesh) {
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  write_vtk(folder_ / "biceps.vtk", *fem::build(biceps(), limb.range).problem.mesh);
  const auto told = [&](const std::string& keys) { return error_of([&] { map(with_mesh(keys)); }); };
  EXPECT_THAT(told("shape = \"in situ\", " + surfaces + numbers),
              HasSubstr("error[unknown-value]: a mesh cannot show a muscle `in situ`\n"));
  EXPECT_THAT(told("shape = \"stress_free\"" + numbers),
              HasSubstr("error[missing-surface]: muscle `biceps`: "));
  EXPECT_THAT(told("shape = \"stress_free\", tendons = [\"tendon\"], " + surfaces + numbers),
              HasSubstr("muscle `biceps`: "));
}

}  // namespace
}  // namespace brachium::pipelines::tests
