#include "fem/mesh/convert.hpp"

#include "fem/mesh/block.hpp"
#include "tests/fem/mesh/mesh_measures.hpp"

namespace brachium::fem {
namespace {

using data::CellType;
using data::Mesh;
using namespace tests;

/// A block bent by a quadratic map, with fields that a linear and a constant function give, and a node set.
Mesh bent(CellType type) {
  BlockOptions options;
  options.type = type;
  options.slabs = {{"a", {1.0, 2}}, {"b", {1.0, 1}}};
  options.y = options.z = {1.0, 2};
  Mesh mesh = block(options);
  for (auto p : mesh.points.colwise()) p += Eigen::Vector3d(0.1 * p.y() * p.z(), -0.1 * p.x() * p.z(), 0.0);
  mesh.point_fields["x"] = mesh.points.row(0);
  mesh.cell_fields["region"] = Eigen::MatrixXd(1, mesh.cell_count());
  for (int c = 0; c < mesh.cell_count(); ++c)
    mesh.cell_fields["region"](0, c) = mesh.region_of_cell[static_cast<std::size_t>(c)];
  mesh.node_sets["end"] = mesh.surface_points("x1");
  return mesh;
}

void expect_same_body(const Mesh& a, const Mesh& b, double tolerance) {
  EXPECT_EQ(structure(b), "");
  for (const std::string& r : a.regions) EXPECT_NEAR(volume(a, r), volume(b, r), tolerance) << r;
  for (const auto& s : a.surfaces)
    EXPECT_LT((vector_area(a, s.name) - vector_area(b, s.name)).norm(), tolerance) << s.name;
  for (int c = 0; c < b.cell_count(); ++c)
    ASSERT_EQ(b.cell_fields.at("region")(0, c), b.region_of_cell[static_cast<std::size_t>(c)]);
}

TEST(Elevate, KeepsTheBodyAndSharesNewNodes) {
  const std::pair<CellType, CellType> pairs[] = {{CellType::hex8, CellType::hex20},
                                                 {CellType::hex8, CellType::hex27},
                                                 {CellType::hex20, CellType::hex27},
                                                 {CellType::tet4, CellType::tet10}};
  for (const auto& [from, to] : pairs) {
    const Mesh low = bent(from), high = elevate(low, to);
    SCOPED_TRACE(data::to_string(from) + " to " + data::to_string(to));
    expect_same_body(low, high, 1e-13);
    EXPECT_EQ(high.point_count(), block({2, 1, 1}, 3, 2, 2, to).point_count());
    EXPECT_LT((high.point_fields.at("x") - high.points.row(0)).norm(), 1e-13);
    auto end = high.node_sets.at("end");
    std::sort(end.begin(), end.end());
    EXPECT_EQ(end, high.surface_points("x1"));
  }
}

TEST(Elevate, CurvedEdgesOfSerendipityCellsStayCurved) {
  const Mesh high = elevate(bent(CellType::hex20), CellType::hex27);
  for (int c = 0; c < high.cell_count(); ++c) {
    const Eigen::Matrix3Xd x = cell_points(high, c);
    EXPECT_LT((x.leftCols(20) - cell_points(bent(CellType::hex20), c)).norm(), 1e-15);
  }
}

TEST(Reduce, UndoesElevation) {
  for (const auto& [low, high] :
       {std::pair{CellType::hex8, CellType::hex27}, std::pair{CellType::tet4, CellType::tet10},
        std::pair{CellType::hex20, CellType::hex27}}) {
    const Mesh mesh = bent(low), back = reduce(elevate(mesh, high), low);
    EXPECT_EQ(mesh.points, back.points);
    EXPECT_EQ(mesh.cells, back.cells);
    EXPECT_EQ(mesh.node_sets, back.node_sets);
    EXPECT_EQ(mesh.point_fields.at("x"), back.point_fields.at("x"));
  }
}

TEST(Split, QuadraticTetrahedraFillTheCurvedBodyOfQuadraticHexahedra) {
  // The map is quadratic and so is every face: the outside is met exactly.
  expect_same_body(bent(CellType::hex27), split_into_tetrahedra(bent(CellType::hex27)), 1e-13);
}

TEST(Split, ConformsForAnyNumberingOfThePoints) {
  Mesh mesh = block({1, 1, 1}, 3, 3, 3, CellType::hex8);
  // A permutation with no order in it: p -> 37 p mod 64 (a unit modulo 64).
  Mesh mixed = mesh;
  for (int p = 0; p < 64; ++p) mixed.points.col(37 * p % 64) = mesh.points.col(p);
  for (int& p : mixed.cells.reshaped()) p = 37 * p % 64;
  const Mesh tets = split_into_tetrahedra(mixed);
  EXPECT_EQ(structure(tets), "");
  EXPECT_EQ(data::boundary_faces(tets).size(), 2u * 54u);
  EXPECT_NEAR(volume(tets), 1.0, 1e-13);
  for (int c = 0; c < tets.cell_count(); ++c) {
    const Eigen::Matrix3Xd x = cell_points(tets, c);
    const Eigen::Matrix3d edges = x.rightCols(3).colwise() - x.col(0);
    EXPECT_NEAR(edges.determinant(), 1.0 / 27 / 6 * 6, 1e-14);
  }
}

TEST(Refine, HalvesEveryCellOnItsOwnGeometry) {
  for (const CellType type : all_types) {
    SCOPED_TRACE(data::to_string(type));
    const Mesh coarse = bent(type), fine = refine(coarse);
    EXPECT_EQ(fine.cell_count(), 8 * coarse.cell_count());
    expect_same_body(coarse, fine, 1e-13);
    EXPECT_EQ(data::boundary_faces(fine).size(), 4 * data::boundary_faces(coarse).size());
    EXPECT_LT((fine.point_fields.at("x") - fine.points.row(0)).norm(), 1e-13);
    EXPECT_EQ(fine.point_count(), block({2, 1, 1}, 6, 4, 4, type).point_count());
  }
}

TEST(Convert, RefusesWhatCannotBe) {
  const Mesh hex8 = block({1, 1, 1}, 1, 1, 1, CellType::hex8);
  EXPECT_THROW(elevate(hex8, CellType::tet10), data::InputError);
  EXPECT_THROW(reduce(hex8, CellType::hex27), data::InputError);
  EXPECT_THROW(split_into_tetrahedra(block({1, 1, 1}, 1, 1, 1, CellType::hex20)), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
