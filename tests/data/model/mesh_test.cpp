#include "data/model/mesh.hpp"

#include <Eigen/Geometry>

namespace brachium::data {
namespace {

/// A reference cell, its nodes placed from the words of the header, not from the face tables.
Mesh reference_cell(CellType type) {
  Mesh mesh;
  mesh.type = type;
  const int n = nodes_per_cell(type);
  mesh.points.resize(3, n);
  mesh.cells = Eigen::VectorXi::LinSpaced(n, 0, n - 1);
  mesh.regions = {"all"};
  mesh.region_of_cell = {0};
  auto& x = mesh.points;
  const auto between = [&](int at, std::initializer_list<std::pair<int, int>> edges) {
    for (const auto& [a, b] : edges) {
      if (at < n) x.col(at) = 0.5 * (x.col(a) + x.col(b));
      ++at;
    }
  };
  if (corners_per_cell(type) == 4) {
    x.leftCols(4) << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
    between(4, {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}});
    return mesh;
  }
  x.leftCols(8) << -1, 1, 1, -1, -1, 1, 1, -1,  //
      -1, -1, 1, 1, -1, -1, 1, 1,               //
      -1, -1, -1, -1, 1, 1, 1, 1;
  between(8,
          {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}});
  if (type == CellType::hex27) {
    x.rightCols(7) << -1, 1, 0, 0, 0, 0, 0,  //
        0, 0, -1, 1, 0, 0, 0,                //
        0, 0, 0, 0, -1, 1, 0;
  }
  return mesh;
}

constexpr CellType all_types[] = {CellType::tet4, CellType::tet10, CellType::hex8, CellType::hex20,
                                  CellType::hex27};

TEST(MeshFaces, CornersRunCounterClockwiseSeenFromOutside) {
  for (const CellType type : all_types) {
    const Mesh mesh = reference_cell(type);
    const Eigen::Vector3d centre = mesh.points.leftCols(corners_per_cell(type)).rowwise().mean();
    for (int f = 0; f < faces_per_cell(type); ++f) {
      const auto local = face_nodes(type, f);
      const Eigen::Vector3d a = mesh.points.col(local[0]);
      const Eigen::Vector3d b = mesh.points.col(local[1]);
      const Eigen::Vector3d c = mesh.points.col(local[2]);
      EXPECT_GT((b - a).cross(c - b).dot(a - centre), 0.1) << to_string(type) << " face " << f;
    }
  }
}

TEST(MeshFaces, HexahedralFacesAreNumberedByTheirNormals) {
  const Mesh mesh = reference_cell(CellType::hex27);
  for (int f = 0; f < 6; ++f) {
    for (const int local : face_nodes(CellType::hex27, f))
      EXPECT_EQ(mesh.points(f / 2, local), f % 2 ? 1.0 : -1.0) << "face " << f;
  }
}

TEST(MeshFaces, TetrahedralFacesAreNumberedByTheOppositeNode) {
  for (int f = 0; f < 4; ++f) {
    for (const int local : face_nodes(CellType::tet4, f)) EXPECT_NE(local, f);
  }
}

TEST(MeshFaces, EdgeNodesLieBetweenTheirCornersAndTheCentreInTheMiddle) {
  for (const CellType type : all_types) {
    const Mesh mesh = reference_cell(type);
    const std::size_t corners = corners_per_cell(type) == 4 ? 3 : 4;
    for (int f = 0; f < faces_per_cell(type); ++f) {
      const auto local = face_nodes(type, f);
      if (local.size() == corners) continue;
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i < corners; ++i) {
        const Eigen::Vector3d a = mesh.points.col(local[i]);
        const Eigen::Vector3d b = mesh.points.col(local[(i + 1) % corners]);
        sum += a;
        EXPECT_EQ((0.5 * (a + b) - mesh.points.col(local[corners + i])).norm(), 0.0)
            << to_string(type) << " face " << f << " edge " << i;
      }
      if (local.size() == 9) {
        EXPECT_EQ((sum / 4.0 - mesh.points.col(local[8])).norm(), 0.0);
      }
    }
  }
}

/// Two unit cubes side by side along x.
Mesh two_cubes() {
  Mesh mesh;
  mesh.points.resize(3, 12);
  for (int k = 0, p = 0; k < 2; ++k) {
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) mesh.points.col(p++) << i, j, k;
    }
  }
  mesh.cells.resize(8, 2);
  mesh.cells << 0, 1, 1, 2, 4, 5, 3, 4, 6, 7, 7, 8, 10, 11, 9, 10;
  mesh.regions = {"left", "right"};
  mesh.region_of_cell = {0, 1};
  mesh.surfaces = {{"ends", {{0, 0}, {1, 1}}}};
  return mesh;
}

std::string codes(const Mesh& mesh) {
  std::string text;
  for (const Diagnostic& d : check_structure(mesh)) text += (text.empty() ? "" : " ") + d.code;
  return text;
}

TEST(MeshFaces, BoundaryLeavesOutTheFaceBetweenTwoCells) {
  const auto faces = boundary_faces(two_cubes());
  EXPECT_EQ(faces.size(), 10u);
  EXPECT_FALSE(std::ranges::count(faces, CellFace{0, 1}));
  EXPECT_FALSE(std::ranges::count(faces, CellFace{1, 0}));
  EXPECT_TRUE(std::ranges::is_sorted(faces));
}

TEST(MeshFaces, AreFoundByTheirCornersInAnyOrder) {
  const FaceTable table(two_cubes());
  const int inner[] = {10, 1, 7, 4}, outer[] = {0, 9, 3, 6}, none[] = {0, 1, 2, 3}, odd[] = {0, 1};
  EXPECT_EQ(table.find(inner), (std::vector<CellFace>{{0, 1}, {1, 0}}));
  EXPECT_EQ(table.find(outer), (std::vector<CellFace>{{0, 0}}));
  EXPECT_TRUE(table.find(none).empty());
  EXPECT_TRUE(table.find(odd).empty());
}

TEST(MeshNames, SurfaceAndRegionAreFoundOrTheNearestNameIsTold) {
  const Mesh mesh = two_cubes();
  EXPECT_EQ(mesh.surface_points("ends"), (std::vector<int>{0, 2, 3, 5, 6, 8, 9, 11}));
  EXPECT_EQ(mesh.region("right"), 1);
  try {
    mesh.surface("end");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "missing-surface");
    EXPECT_EQ(e.diagnostics().front().help, "did you mean `ends`?");
  }
  EXPECT_THROW(mesh.region("rigth"), InputError);
}

TEST(MeshStructure, SoundMeshHasNoFindings) {
  EXPECT_EQ(codes(two_cubes()), "");
}

TEST(MeshStructure, EveryKindOfMistakeHasItsCode) {
  const auto with = [](auto change) {
    Mesh mesh = two_cubes();
    change(mesh);
    return codes(mesh);
  };
  EXPECT_EQ(codes(Mesh{}), "mesh-empty mesh-empty");
  EXPECT_EQ(with([](Mesh& m) { m.type = CellType::hex20; }), "mesh-size");
  EXPECT_EQ(with([](Mesh& m) { m.region_of_cell.pop_back(); }), "mesh-size");
  EXPECT_EQ(with([](Mesh& m) { m.point_fields["f"].resize(3, 11); }), "mesh-size");
  EXPECT_EQ(with([](Mesh& m) { m.cell_fields["f"].resize(1, 3); }), "mesh-size");
  EXPECT_EQ(with([](Mesh& m) { m.regions = {"a", "a"}; }), "mesh-duplicate-name");
  EXPECT_EQ(with([](Mesh& m) { m.surfaces.push_back(m.surfaces.front()); }), "mesh-duplicate-name");
  EXPECT_EQ(with([](Mesh& m) { m.cells(3, 1) = 12; }), "mesh-index");
  EXPECT_EQ(with([](Mesh& m) { m.cells(3, 1) = -1; }), "mesh-index");
  EXPECT_EQ(with([](Mesh& m) { m.region_of_cell[0] = 2; }), "mesh-index");
  EXPECT_EQ(with([](Mesh& m) { m.surfaces[0].faces[0].face = 6; }), "mesh-index");
  EXPECT_EQ(with([](Mesh& m) { m.node_sets["n"] = {12}; }), "mesh-index");
  EXPECT_EQ(with([](Mesh& m) { m.cells(3, 1) = m.cells(2, 1); }), "mesh-repeated-point");
  EXPECT_EQ(with([](Mesh& m) { m.points(1, 7) = std::nan(""); }), "mesh-not-finite");
  EXPECT_EQ(with([](Mesh& m) { m.cells.col(1) = m.cells.col(0); }), "mesh-duplicate-cell");
}

TEST(MeshStructure, ThreeCellsAtAFaceAreRefused) {
  Mesh mesh = two_cubes();
  mesh.points.conservativeResize(3, 16);
  mesh.points.rightCols(4) << 2, 2, 2, 2, -1, 0, -1, 0, 0, 0, 1, 1;
  mesh.cells.conservativeResize(8, 3);
  mesh.cells.col(2) = mesh.cells.col(1);
  mesh.cells.col(2)(1) = 12, mesh.cells.col(2)(2) = 13, mesh.cells.col(2)(5) = 14, mesh.cells.col(2)(6) = 15;
  mesh.region_of_cell.push_back(0);
  const auto findings = check_structure(mesh);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].message, "faces with more than two cells: cells 0, 1 and 2");
}

TEST(MeshStructure, NeighboursWithSeparateEdgeNodesAreRefused) {
  Mesh mesh = reference_cell(CellType::tet10);
  mesh.points.conservativeResize(3, 17);
  mesh.points.col(10) << 1, 1, 1;
  mesh.cells.conservativeResize(10, 2);
  // The second cell lies beyond face 0 (nodes 1 2 3); its edge nodes are all its own.
  mesh.cells.col(1) << 1, 2, 3, 10, 11, 12, 13, 14, 15, 16;
  mesh.points.rightCols(6) = Eigen::MatrixXd::Random(3, 6);
  mesh.region_of_cell = {0, 0};
  EXPECT_EQ(codes(mesh), "mesh-nonconforming");
  mesh.cells.col(1)(4) = 5, mesh.cells.col(1)(5) = 9, mesh.cells.col(1)(6) = 8;
  EXPECT_EQ(codes(mesh), "");
}

}  // namespace
}  // namespace brachium::data
