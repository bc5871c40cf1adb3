#include <Eigen/Geometry>
#include <algorithm>

#include "data/io/mesh_file.hpp"
#include "tests/data/io/io_test_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::io {
namespace {

using data::CellType;
using data::Mesh;

std::filesystem::path sample(const std::string& name) {
  return tests::source_dir() / "tests/data/io/meshes" / name;
}

MeshReadOptions millimetres() {
  MeshReadOptions options;
  options.length_unit = "mm";
  options.region_names = {{1, "tendon"}, {2, "muscle"}, {7, "origin"}, {8, "insertion"}};
  return options;
}

/// All edges of the samples are straight: every node has one right place between the corners, which pins its
/// number.
void expect_nodes_in_place(const Mesh& mesh) {
  const std::size_t corners = data::corners_per_cell(mesh.type) == 4 ? 3 : 4;
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const auto x = [&](int local) -> Eigen::Vector3d { return mesh.points.col(mesh.cells(local, c)); };
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (int i = 0; i < data::corners_per_cell(mesh.type); ++i)
      centre += x(i) / data::corners_per_cell(mesh.type);
    for (int f = 0; f < data::faces_per_cell(mesh.type); ++f) {
      const auto n = data::face_nodes(mesh.type, f);
      const Eigen::Vector3d normal = (x(n[1]) - x(n[0])).cross(x(n[2]) - x(n[1]));
      ASSERT_GT(normal.dot(x(n[0]) - centre), 0.0) << "cell " << c << " is inverted at face " << f;
      Eigen::Vector3d mean = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < corners; ++i) mean += x(n[i]) / static_cast<double>(corners);
      for (std::size_t i = 0; n.size() > corners && i < corners; ++i)
        ASSERT_LT((x(n[corners + i]) - 0.5 * (x(n[i]) + x(n[(i + 1) % corners]))).norm(), 1e-12)
            << "edge node of face " << f;
      if (n.size() == 9) {
        ASSERT_LT((x(n[8]) - mean).norm(), 1e-12) << "centre of face " << f;
      }
    }
    if (mesh.type == CellType::hex27) {
      ASSERT_LT((x(26) - centre).norm(), 1e-12);
    }
  }
}

void expect_sample(const MeshFile& file, CellType type) {
  const Mesh& mesh = file.mesh;
  ASSERT_EQ(mesh.type, type);
  expect_nodes_in_place(mesh);
  EXPECT_LT((mesh.points.rowwise().minCoeff()).norm(), 1e-15);
  EXPECT_LT((mesh.points.rowwise().maxCoeff() - Eigen::Vector3d(0.02, 0.01, 0.01)).norm(), 1e-15);
  EXPECT_EQ(mesh.regions.size(), 2u);
  for (int c = 0; c < mesh.cell_count(); ++c) {
    double centre = 0.0;
    for (int i = 0; i < data::corners_per_cell(type); ++i)
      centre += mesh.points(0, mesh.cells(i, c)) / data::corners_per_cell(type);
    EXPECT_EQ(mesh.regions[static_cast<std::size_t>(mesh.region_of_cell[static_cast<std::size_t>(c)])],
              centre < 0.01 ? "tendon" : "muscle");
  }
  for (const auto& [name, place] : {std::pair{"origin", 0.0}, std::pair{"insertion", 0.02}}) {
    for (const int p : mesh.surface_points(name)) EXPECT_NEAR(mesh.points(0, p), place, 1e-15);
    double area = 0.0;
    for (const data::CellFace& f : mesh.surface(name).faces) {
      const auto n = data::face_nodes(type, f.face);
      const auto x = [&](std::size_t i) -> Eigen::Vector3d {
        return mesh.points.col(mesh.cells(n[i], f.cell));
      };
      const double triangle = 0.5 * (x(1) - x(0)).cross(x(2) - x(0)).norm();
      area += data::corners_per_cell(type) == 4 ? triangle : 2.0 * triangle;
    }
    EXPECT_NEAR(area, 1e-4, 1e-16) << name;
  }
}

TEST(GmshReader, FourFlavoursOfEveryCellTypeGiveOneMesh) {
  for (const CellType type :
       {CellType::tet4, CellType::tet10, CellType::hex8, CellType::hex20, CellType::hex27}) {
    std::optional<Mesh> first;
    for (const char* flavour : {"_22", "_22_binary", "_41", "_41_binary"}) {
      const std::string name = data::to_string(type) + flavour + ".msh";
      SCOPED_TRACE(name);
      const MeshFile file = read_mesh(sample(name), millimetres());
      expect_sample(file, type);
      if (!first) first = file.mesh;
      EXPECT_EQ(first->cell_count(), file.mesh.cell_count());
      EXPECT_EQ(first->point_count(), file.mesh.point_count());
    }
  }
}

TEST(VtuReader, EveryEncodingGivesOneMesh) {
  std::optional<Mesh> first;
  for (const char* name :
       {"ascii", "inline", "inline_zlib", "appended", "appended_zlib", "raw", "raw_zlib", "raw_big"}) {
    SCOPED_TRACE(name);
    const MeshFile file = read_mesh(sample(std::string("hex27_") + name + ".vtu"), millimetres());
    expect_sample(file, CellType::hex27);
    EXPECT_TRUE(file.notes.empty());
    if (!first) first = file.mesh;
    EXPECT_EQ(first->points, file.mesh.points);
    EXPECT_EQ(first->cells, file.mesh.cells);
    EXPECT_EQ(file.mesh.cell_fields.at("fibre"), Eigen::Vector3d::UnitX().replicate(1, 2));
    EXPECT_LT((1e-3 * file.mesh.point_fields.at("height") - file.mesh.points.row(2)).norm(), 1e-15);
  }
}

TEST(VtkReader, EveryVersionAndFlavourIsRead) {
  const std::pair<const char*, CellType> files[] = {
      {"hex8_51", CellType::hex8},   {"hex8_51_binary", CellType::hex8},
      {"hex20_51", CellType::hex20}, {"hex20_51_binary", CellType::hex20},
      {"hex27_42", CellType::hex27}, {"hex27_42_binary", CellType::hex27},
      {"hex27_51", CellType::hex27}, {"hex27_51_binary", CellType::hex27}};
  for (const auto& [name, type] : files) {
    SCOPED_TRACE(name);
    const MeshFile file = read_mesh(sample(std::string(name) + ".vtk"), millimetres());
    expect_sample(file, type);
    EXPECT_LT((1e-3 * file.mesh.point_fields.at("height") - file.mesh.points.row(2)).norm(), 1e-15);
  }
}

TEST(FebioReader, EverySpecificationIsRead) {
  const std::pair<const char*, CellType> files[] = {
      {"hex8_25.feb", CellType::hex8}, {"hex20_30.feb", CellType::hex20}, {"hex27_40.feb", CellType::hex27}};
  for (const auto& [name, type] : files) {
    SCOPED_TRACE(name);
    const MeshFile file = read_mesh(sample(name), millimetres());
    expect_sample(file, type);
    EXPECT_EQ(file.mesh.node_sets.at("held").size(), 4u);
    EXPECT_EQ(file.mesh.cell_fields.at("distal"), (Eigen::MatrixXd(1, 2) << 0, 1).finished());
  }
}

// ---------------------------------------------------------------- what is refused, and how it is told

class MeshErrors : public ::testing::Test {
 protected:
  std::filesystem::path dir = tests::scratch_dir();
  /// The message of reading `text` as a file of that name.
  std::string error(const std::string& name, const std::string& text,
                    MeshReadOptions options = millimetres()) {
    const auto file = tests::write_file(dir / name, text);
    return tests::error_of([&] { read_mesh(file, options); }, dir);
  }
  /// A sample with one piece of its text replaced.
  std::string changed(const std::string& name, const std::string& from, const std::string& to) {
    std::string text = tests::slurp(sample(name));
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) text.replace(at, from.size(), to);
    return error(name, text);
  }
  static void expect_start(const std::string& text, const std::string& start) {
    EXPECT_EQ(text.substr(0, start.size()), start);
  }
};

TEST_F(MeshErrors, MissingUnitIsRefusedForEveryFormat) {
  for (const char* name : {"hex8_41.msh", "hex27_ascii.vtu", "hex8_51.vtk", "hex8_25.feb"}) {
    const std::string text = tests::error_of([&] { read_mesh(sample(name), {}); }, sample("x").parent_path());
    EXPECT_EQ(text.substr(0, 24), "error[mesh-unit-missing]") << text;
  }
  MeshReadOptions options;
  options.length_unit = "kg";
  EXPECT_NE(tests::error_of([&] { read_mesh(sample("hex8_41.msh"), options); }).find("error[wrong-unit]"),
            std::string::npos);
}

TEST_F(MeshErrors, TextTellsFileAndLine) {
  EXPECT_EQ(changed("hex8_22.msh", "2 0 10 0", "2 0 1O 0"),
            "error[mesh-syntax]: `1O` is not a finite number (a coordinate)\n"
            "  --> hex8_22.msh:14:5\n   |\n14 | 2 0 1O 0\n   |     ^\n");
}

TEST_F(MeshErrors, BinaryTellsTheByte) {
  const std::string text = tests::slurp(sample("hex8_41_binary.msh"));
  expect_start(error("cut.msh", text.substr(0, text.size() / 2)), "error[mesh-truncated]: `cut.msh`, byte 2");
}

TEST_F(MeshErrors, UnknownAndUnusableElementsAreNamed) {
  expect_start(changed("hex8_22.msh", "\n3 5 2 3 1", "\n3 6 2 3 1"),
               "error[mesh-cell-type]: volume elements of type 6 (prism6) cannot be used");
  expect_start(changed("hex8_22.msh", "\n3 5 2 3 1", "\n3 99 2 3 1"),
               "error[mesh-cell-type]: element type 99 of Gmsh is not known");
  expect_start(changed("hex8_51.vtk", "CELL_TYPES 4\n12", "CELL_TYPES 4\n11"),
               "error[mesh-cell-type]: cell 0 is of VTK type 11, which cannot be used");
  expect_start(changed("hex8_25.feb", "type=\"hex8\"", "type=\"penta6\""),
               "error[mesh-cell-type]: elements of type `penta6` cannot be used");
}

TEST_F(MeshErrors, MixedCellsAreCounted) {
  // A hexahedron and, on points of its own, a tetrahedron.
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n12\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 "
      "1\n7 1 1 1\n"
      "8 0 1 1\n9 5 0 0\n10 6 0 0\n11 5 1 0\n12 5 0 1\n$EndNodes\n$Elements\n2\n1 5 2 1 1 1 2 3 4 5 6 7 8\n"
      "2 4 2 1 1 9 10 11 12\n$EndElements\n";
  expect_start(error("mixed.msh", text),
               "error[mesh-mixed-cells]: `mixed.msh` mixes volume cells: 1 hex8, 1 tet4");
}

TEST_F(MeshErrors, CellInTwoRegionsIsRefused) {
  // Gmsh 2.2 writes the cell once per group, 4.1 names both groups at its entity.
  const std::string text = tests::slurp(sample("hex8_22.msh"));
  std::string twice = text;
  const std::size_t count = twice.find("$Elements\n4\n"), end = twice.find("$EndElements");
  ASSERT_NE(count, std::string::npos);
  twice.insert(
      end, "5 5 2 4 1" +
               text.substr(text.find("\n3 5 2 3 1") + 10,
                           text.find('\n', text.find("\n3 5 2 3 1") + 1) - text.find("\n3 5 2 3 1") - 10) +
               "\n");
  twice.replace(count, 12, "$Elements\n5\n");
  expect_start(error("twice.msh", twice),
               "error[mesh-double-region]: `twice.msh`: cells belong to two regions: `tendon` and `muscle`");
  expect_start(changed("hex8_41.msh", "\n1 0 0 0 10 10 10 1 3 6", "\n1 0 0 0 10 10 10 2 3 4 6"),
               "error[mesh-double-region]: element 3 belongs to two physical volumes: `tendon` and `muscle`");
}

TEST_F(MeshErrors, DoublyNamedGroupsAreRefused) {
  expect_start(changed("hex8_22.msh", "3 4 \"muscle\"", "3 4 \"tendon\""),
               "error[mesh-duplicate-name]: two physical groups are called `tendon`");
  expect_start(changed("hex8_25.feb", "Surface name=\"insertion\"", "Surface name=\"origin\""),
               "error[mesh-duplicate-name]: two surfaces are called `origin`");
}

TEST_F(MeshErrors, SurfaceApartFromTheVolumeIsRefused) {
  expect_start(changed("hex8_51.vtk", "0 3 \n7 4 8", "0 3 \n6 4 8"),
               "error[mesh-unmatched-surface]: `hex8_51.vtk`: surface cells that are no face of a volume "
               "cell: 1 of `origin`");
}

TEST_F(MeshErrors, NodesThatDoNotExistAreRefused) {
  expect_start(changed("hex8_25.feb", "<elem id=\"1\">101,", "<elem id=\"1\">999,"),
               "error[mesh-index]: node 999 does not exist\n  --> hex8_25.feb:");
}

TEST_F(MeshErrors, MissingDomainIsToldWithTheNearestName) {
  EXPECT_NE(changed("hex27_40.feb", "SolidDomain name=\"muscle\"", "SolidDomain name=\"mucsle\"")
                .find("did you mean `muscle`?"),
            std::string::npos);
}

TEST_F(MeshErrors, FormatsThatAreNotReadAreNamed) {
  expect_start(changed("hex8_22.msh", "2.2 0 8", "1.0 0 8"),
               "error[mesh-unsupported]: version 1.0 of the format is not read");
  EXPECT_NE(tests::error_of([&] {
              read_mesh(sample("hex27_raw_lz4.vtu"), millimetres());
            }).find("compression `vtkLZ4DataCompressor` is not read"),
            std::string::npos);
  expect_start(error("a.stl", "solid"), "error[mesh-unsupported]");
  expect_start(error("a.msh", "solid"), "error[mesh-syntax]: this is no Gmsh mesh");
}

TEST_F(MeshErrors, RegionArrayThatWasAskedForMustBeThere) {
  MeshReadOptions options = millimetres();
  options.region_array = "regions";
  EXPECT_NE(
      tests::error_of([&] { read_mesh(sample("hex27_raw.vtu"), options); }).find("did you mean `region`?"),
      std::string::npos);
  MeshReadOptions plain;
  plain.length_unit = "mm";
  std::string text = tests::slurp(sample("hex27_ascii.vtu"));
  text.replace(text.find("\"region\""), 8, "\"tissue\"");
  const MeshFile file = read_mesh(tests::write_file(dir / "plain.vtu", text), plain);
  EXPECT_EQ(file.mesh.regions, std::vector<std::string>{"all"});
  EXPECT_EQ(file.notes.size(), 1u);
}

TEST_F(MeshErrors, PointsOfNoVolumeCellAreLeftOutWithANote) {
  std::string text = tests::slurp(sample("hex8_22.msh"));
  text.replace(text.find("$Nodes\n12\n"), 10, "$Nodes\n13\n77 1 2 3\n");
  const MeshFile file = read_mesh(tests::write_file(dir / "a.msh", text), millimetres());
  EXPECT_EQ(file.mesh.point_count(), 12);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_EQ(file.notes[0].message, "1 points that belong to no volume cell were left out");
}

std::string with_data(const std::string& file, const std::string& data) {
  std::string text = tests::slurp(sample(file));
  return text.insert(text.find("</febio_spec>"), data);
}

TEST_F(MeshErrors, FibresAndAxesOfFebioFilesGoByTheirSet) {
  // Entries of MeshData are numbered within their set: an ElementSet, or a block of Elements.
  const std::string three =
      "<MeshData><ElementData var=\"fiber\" elem_set=\"distal\"><elem "
      "lid=\"1\">0,0.6,0.8</elem></ElementData></MeshData>";
  MeshFile file =
      read_mesh(tests::write_file(dir / "a.feb", with_data("hex20_30.feb", three)), millimetres());
  EXPECT_EQ(file.mesh.cell_fields.at("fiber"), (Eigen::MatrixXd(3, 2) << 0, 0, 0, 0.6, 0, 0.8).finished());
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_EQ(file.notes[0].message, "field `fiber` has no value at 1 cells; 0 is used there");
  const std::string four =
      "<MeshData><ElementData type=\"mat_axis\" elem_set=\"tendon\"><e "
      "lid=\"1\"><a>0,0,1</a><d>1,0,0</d></e></ElementData>"
      "<ElementData type=\"mat_axis\" elem_set=\"muscle\"><e "
      "lid=\"1\"><a>0,1,0</a><d>1,0,0</d></e></ElementData>"
      "<NodeData name=\"gamma\" data_type=\"scalar\" node_set=\"held\"><node "
      "lid=\"2\">0.5</node></NodeData></MeshData>";
  file = read_mesh(tests::write_file(dir / "b.feb", with_data("hex27_40.feb", four)), millimetres());
  EXPECT_EQ(file.mesh.cell_fields.at("mat_axis_a"), (Eigen::MatrixXd(3, 2) << 0, 0, 0, 1, 1, 0).finished());
  EXPECT_EQ(file.mesh.cell_fields.at("mat_axis_d"), (Eigen::MatrixXd(3, 2) << 1, 1, 0, 0, 0, 0).finished());
  Eigen::Index row = 0, at = 0;
  ASSERT_EQ(file.mesh.point_fields.at("gamma").maxCoeff(&row, &at), 0.5);
  EXPECT_EQ(file.mesh.points.col(at), Eigen::Vector3d(0.0, 0.0, 0.01))
      << "the second of the set, as the file lists it";
}

TEST_F(MeshErrors, DataOfFebioFilesThatCannotBeReadAreNamed) {
  const auto said = [&](const std::string& data) {
    return error("a.feb", with_data("hex20_30.feb", "<MeshData>" + data + "</MeshData>"));
  };
  EXPECT_NE(said("<ElementData var=\"fiber\" elem_set=\"distl\"/>").find("did you mean `distal`?"),
            std::string::npos);
  expect_start(said("<ElementData var=\"fiber\" elem_set=\"distal\"><e lid=\"2\">1,0,0</e></ElementData>"),
               "error[mesh-index]: entry 2 of a set of 1 members\n  --> a.feb:");
  expect_start(said("<ElementData var=\"fiber\" elem_set=\"distal\" generator=\"math\"/>"),
               "error[mesh-unsupported]: <ElementData> is left to FEBio to compute");
  const std::string material =
      "<Material><material id=\"1\"><fiber type=\"vector\">1,0,0</fiber></material></Material>";
  const MeshFile file =
      read_mesh(tests::write_file(dir / "c.feb", with_data("hex20_30.feb", material)), millimetres());
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_EQ(file.notes[0].message, "<fiber> within a material was left out: only MeshData are read");
}

TEST_F(MeshErrors, FieldsOfGmshFilesGoByTag) {
  const std::string text =
      tests::slurp(sample("hex8_22.msh")) +
      "$ElementData\n1\n\"fibre\"\n1\n0.0\n3\n0\n3\n2\n3 1 0 0\n4 0 0 1\n$EndElementData\n"
      "$NodeData\n1\n\"gamma_M\"\n1\n0.0\n3\n0\n1\n1\n2 0.5\n$EndNodeData\n";
  const MeshFile file = read_mesh(tests::write_file(dir / "a.msh", text), millimetres());
  EXPECT_EQ(file.mesh.cell_fields.at("fibre"), (Eigen::MatrixXd(3, 2) << 1, 0, 0, 0, 0, 1).finished());
  EXPECT_EQ(file.mesh.point_fields.at("gamma_M").sum(), 0.5);
  ASSERT_EQ(file.notes.size(), 1u);
  EXPECT_EQ(file.notes[0].message, "field `gamma_M` has no value at 11 points; 0 is used there");
}

}  // namespace
}  // namespace brachium::io
