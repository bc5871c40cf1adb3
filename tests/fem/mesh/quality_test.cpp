#include "fem/mesh/quality.hpp"

#include <cmath>

#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"
#include "tests/fem/mesh/mesh_measures.hpp"

namespace brachium::fem {
namespace {

using data::CellType;
using data::Mesh;
using namespace tests;

std::string codes(const Mesh& mesh, const QualityLimits& limits = {}) {
  std::string text;
  for (const data::Diagnostic& d : check_quality(mesh, limits)) text += (text.empty() ? "" : " ") + d.code;
  return text;
}

TEST(Quality, CubesAreIdealHexahedra) {
  for (const CellType type : {CellType::hex8, CellType::hex20, CellType::hex27}) {
    const CellQuality q = cell_quality(block({2, 1, 1}, 2, 1, 1, type));
    EXPECT_NEAR(q.volume_m3[0], 1.0, 1e-14);
    EXPECT_NEAR(q.jacobian_min_m3[1], 0.125, 1e-15);
    EXPECT_NEAR(q.jacobian_ratio[0], 1.0, 1e-13);
    EXPECT_NEAR(q.scaled_jacobian[0], 1.0, 1e-14);
    EXPECT_NEAR(q.aspect[1], 1.0, 1e-14);
  }
}

TEST(Quality, RegularTetrahedronIsIdeal) {
  Mesh mesh;
  mesh.type = CellType::tet4;
  mesh.points.resize(3, 4);
  mesh.points << 1, 1, -1, -1, 1, -1, -1, 1, 1, -1, 1, -1;
  mesh.cells = Eigen::Vector4i(0, 1, 2, 3);
  mesh.regions = {"all"};
  mesh.region_of_cell = {0};
  for (const CellType type : {CellType::tet4, CellType::tet10}) {
    const CellQuality q = cell_quality(elevate(mesh, type));
    EXPECT_NEAR(std::abs(q.volume_m3[0]), 8.0 / 3.0, 1e-14);
    EXPECT_NEAR(q.aspect[0], 1.0, 1e-14);
    EXPECT_NEAR(std::abs(q.scaled_jacobian[0]), 1.0, 1e-14);
  }
  EXPECT_EQ(codes(mesh), cell_quality(mesh).volume_m3[0] < 0 ? "inverted-cells" : "");
}

TEST(Quality, TwoPointMeasuresAgreeWithTheirClosedForms) {
  // A frustum with z the long axis: the Jacobian falls linearly in both x and y scale along z.
  Mesh mesh = block({1, 1, 4}, 1, 1, 1, CellType::hex8);
  for (auto p : mesh.points.colwise()) {
    if (p.z() > 2.0) p.head<2>() *= 0.5;
  }
  const CellQuality q = cell_quality(mesh);
  EXPECT_NEAR(q.jacobian_ratio[0], 0.25, 1e-14);  // (1/2)^2 at the top corners against the bottom's
  EXPECT_NEAR(q.jacobian_min_m3[0], 0.25 * 0.5, 1e-14);
  EXPECT_NEAR(q.volume_m3[0], 4.0 / 3.0 * (1 + 0.25 + 0.5), 1e-14);
  EXPECT_NEAR(q.aspect[0], std::sqrt(16.0 + 2 * 0.0625) / 0.75, 1e-12);
}

TEST(QualityGate, SoundMeshesPass) {
  for (const CellType type : all_types)
    EXPECT_EQ(codes(block({1, 1, 1}, 2, 2, 2, type)), "") << data::to_string(type);
}

TEST(QualityGate, NamesInvertedCellsWorstFirst) {
  Mesh mesh = block({2, 1, 1}, 2, 1, 1, CellType::hex8);
  mesh.points(0, mesh.cells(0, 0)) = 1.5;
  const auto findings = check_quality(mesh);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "inverted-cells");
  EXPECT_EQ(
      findings[0].message.substr(0, 80),
      std::string("1 of 2 cells are inverted: cell 0 of `block` at (0.6875, 0.5, 0.5) m, Jacobian ratio -0.5")
          .substr(0, 80));
}

TEST(QualityGate, MirroredMeshIsToldAsSuch) {
  Mesh mesh = block({1, 1, 1}, 2, 2, 2, CellType::tet10);
  mesh.points.row(0) *= -1.0;
  const auto findings = check_quality(mesh);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].code, "inverted-cells");
  EXPECT_EQ(findings[0].help.substr(0, 30), "all are: the mesh is mirrored,");
}

TEST(QualityGate, InversionAwayFromTheCornersIsFound) {
  Mesh mesh = block({1, 1, 1}, 1, 1, 1, CellType::hex27);
  mesh.points(0, mesh.cells(26, 0)) += 0.8;  // the centre node runs out through a face
  EXPECT_EQ(codes(mesh), "inverted-cells");
}

TEST(QualityGate, FlatCellsAreDegenerate) {
  Mesh mesh = block({1, 1, 1}, 1, 1, 1, CellType::tet4);
  mesh.points.row(2).setZero();
  EXPECT_EQ(codes(mesh), "degenerate-cells");
}

TEST(QualityGate, LimitsAreThoseAsked) {
  const Mesh flat = block({100, 100, 1}, 1, 1, 1, CellType::hex27);
  EXPECT_EQ(codes(flat), "");
  EXPECT_EQ(codes(flat, {.aspect_max = 50.0}), "stretched-cells");
  Mesh frustum = block({1, 1, 1}, 1, 1, 1, CellType::hex8);
  for (auto p : frustum.points.colwise()) {
    if (p.z() > 0.5) p.head<2>() *= 0.1;
  }
  EXPECT_EQ(codes(frustum), "distorted-cells");
  EXPECT_EQ(codes(frustum, {.jacobian_ratio_min = 0.005}), "");
  Mesh sheared = block({1, 1, 1}, 1, 1, 1, CellType::hex8);
  sheared.points.row(0) += 4.0 * sheared.points.row(2);
  EXPECT_EQ(codes(sheared), "");
  EXPECT_EQ(codes(sheared, {.scaled_jacobian_min = 0.3}), "distorted-cells");
}

TEST(QualityGate, PartsThatShareNoPointsAreFound) {
  Mesh mesh = block({3, 1, 1}, 3, 1, 1, CellType::hex8);
  mesh.cells.col(1) = mesh.cells.col(2);  // the middle goes
  mesh.cells.conservativeResize(8, 2);
  mesh.region_of_cell.resize(2);
  mesh.surfaces.clear();
  EXPECT_EQ(connected_parts(mesh), (std::vector<int>{0, 1}));
  EXPECT_EQ(codes(mesh), "disconnected-mesh");
  EXPECT_EQ(codes(mesh, {.several_parts = true}), "");
}

TEST(QualityGate, PointsOfNoCellAreFound) {
  Mesh mesh = block({1, 1, 1}, 1, 1, 1, CellType::hex8);
  mesh.points.conservativeResize(3, 9);
  mesh.points.col(8).setConstant(0.5);
  EXPECT_EQ(unused_points(mesh), std::vector<int>{8});
  EXPECT_EQ(codes(mesh), "unused-points");
  EXPECT_THROW(require_quality(mesh), data::InputError);
}

TEST(QualityTable, HasTheWorstCellOfEveryRegion) {
  BlockOptions options;
  options.slabs = {{"a", {1.0, 2, 3.0}}, {"b", {1.0, 1}}};
  options.y = options.z = {1.0, 1};
  const Mesh mesh = block(options);
  const data::Table table = quality_table(mesh, cell_quality(mesh));
  EXPECT_EQ(table.texts("region"), (std::vector<std::string>{"a", "b", "all"}));
  EXPECT_EQ(table.numbers("cells"), (std::vector<double>{2, 1, 3}));
  EXPECT_NEAR(table.numbers("aspect_max")[0], 4.0, 1e-12);
  EXPECT_EQ(table.numbers("aspect_max_cell")[0], 0.0);
  EXPECT_NEAR(table.numbers("aspect_max")[1], 1.0, 1e-12);
  EXPECT_NEAR(table.numbers("volume_m3")[2], 2.0, 1e-13);
}

}  // namespace
}  // namespace brachium::fem
