#include "fem/mesh/block.hpp"

#include "tests/fem/mesh/mesh_measures.hpp"

namespace brachium::fem {
namespace {

using data::CellType;
using namespace tests;

TEST(Axis, CellSizesGrowInGeometricProgression) {
  const auto x = positions({7.0, 3, 4.0, false}, "x");
  EXPECT_NEAR(x[1], 1.0, 1e-14);
  EXPECT_NEAR(x[2], 3.0, 1e-14);
  EXPECT_EQ(x[3], 7.0);
}

TEST(Axis, SymmetricGradingIsFineAtBothEnds) {
  const auto x = positions({8.0, 5, 4.0, true}, "x");
  const double expected[] = {0, 0.8, 2.4, 5.6, 7.2, 8.0};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(x[i], expected[i], 1e-14) << i;
  const auto even = positions({6.0, 4, 2.0, true}, "x");
  EXPECT_NEAR(even[1], 1.0, 1e-14);
  EXPECT_NEAR(even[2], 3.0, 1e-14);
}

TEST(Axis, RefusesWhatMakesNoCells) {
  for (const Axis& axis : {Axis{0.0, 1, 1.0, false}, Axis{1.0, 0, 1.0, false}, Axis{1.0, 1, 0.0, false},
                           Axis{std::nan(""), 1, 1.0, false}})
    EXPECT_THROW(positions(axis, "x"), data::InputError);
}

TEST(Block, HasItsVolumeSurfacesAndNormalsForEveryCellType) {
  const char* names[] = {"x0", "x1", "y0", "y1", "z0", "z1"};
  for (const CellType type : all_types) {
    BlockOptions options;
    options.type = type;
    options.x = {2.0, 3, 2.0, false};
    options.y = {3.0, 2, 1.0, false};
    options.z = {5.0, 2, 3.0, true};
    options.corner_m = {-1.0, 0.5, 7.0};
    const data::Mesh mesh = block(options);
    EXPECT_EQ(structure(mesh), "") << data::to_string(type);
    EXPECT_EQ(mesh.cell_count(), data::corners_per_cell(type) == 8 ? 12 : 72);
    EXPECT_NEAR(volume(mesh), 30.0, 1e-12);
    const Eigen::Vector3d areas(15.0, 10.0, 6.0);
    for (int s = 0; s < 6; ++s) {
      const Eigen::Vector3d expected = (s % 2 ? 1.0 : -1.0) * areas[s / 2] * Eigen::Vector3d::Unit(s / 2);
      EXPECT_LT((vector_area(mesh, names[s]) - expected).norm(), 1e-12) << data::to_string(type) << names[s];
    }
    EXPECT_NEAR(mesh.points.rowwise().minCoeff()[2], 7.0, 1e-14);
    std::size_t named = 0;
    for (const auto& s : mesh.surfaces) named += s.faces.size();
    EXPECT_EQ(named, data::boundary_faces(mesh).size());
  }
}

TEST(Block, CountsOfPointsAreThoseOfTheLattice) {
  EXPECT_EQ(block({1, 1, 1}, 4, 3, 2, CellType::hex8).point_count(), 5 * 4 * 3);
  EXPECT_EQ(block({1, 1, 1}, 4, 3, 2, CellType::hex27).point_count(), 9 * 7 * 5);
  EXPECT_EQ(block({1, 1, 1}, 4, 3, 2, CellType::tet10).point_count(), 9 * 7 * 5);
  EXPECT_EQ(block({1, 1, 1}, 4, 3, 2, CellType::tet4).point_count(), 5 * 4 * 3);
}

TEST(Block, SlabsBecomeRegionsAlongX) {
  BlockOptions options;
  options.slabs = {{"tendon", {1.0, 2}}, {"muscle", {4.0, 3, 2.0}}, {"tendon", {0.5, 1}}};
  options.y = options.z = {1.0, 1};
  options.fibre = Eigen::Vector3d(2.0, 0.0, 0.0);
  const data::Mesh mesh = block(options);
  EXPECT_EQ(mesh.regions, (std::vector<std::string>{"tendon", "muscle"}));
  EXPECT_NEAR(volume(mesh, "tendon"), 1.5, 1e-13);
  EXPECT_NEAR(volume(mesh, "muscle"), 4.0, 1e-13);
  EXPECT_EQ(mesh.cell_fields.at("fibre").col(5), Eigen::Vector3d::UnitX());
  EXPECT_EQ(structure(mesh), "");
}

}  // namespace
}  // namespace brachium::fem
