#include <numbers>

#include "fem/mesh/cylinder.hpp"
#include "fem/mesh/pennate.hpp"
#include "fem/mesh/quality.hpp"
#include "tests/fem/mesh/mesh_measures.hpp"

namespace brachium::fem {
namespace {

using data::CellType;
using data::Mesh;
using namespace tests;
constexpr double pi = std::numbers::pi;

std::vector<std::string> surface_names(const Mesh& mesh) {
  std::vector<std::string> names;
  for (const auto& s : mesh.surfaces) names.push_back(s.name);
  std::sort(names.begin(), names.end());
  return names;
}

/// The outside is closed: vector areas of all boundary faces cancel.
double gap(Mesh mesh) {
  mesh.surfaces = {{"all", data::boundary_faces(mesh)}};
  return vector_area(mesh, "all").norm();
}

CylinderOptions small_cylinder(CellType type, int fineness = 1) {
  CylinderOptions options;
  options.type = type;
  options.radius_m = 0.5;
  options.z = {2.0, 2};
  options.section = {2 * fineness, 2 * fineness, 1.0};
  return options;
}

TEST(Cylinder, IsSoundForEveryCellType) {
  for (const CellType type : all_types) {
    SCOPED_TRACE(data::to_string(type));
    const Mesh mesh = cylinder(small_cylinder(type));
    EXPECT_EQ(structure(mesh), "");
    EXPECT_TRUE(check_quality(mesh).empty());
    EXPECT_LT(gap(mesh), 1e-13);
    EXPECT_EQ(surface_names(mesh), (std::vector<std::string>{"side", "z0", "z1"}));
    std::size_t named = 0;
    for (const auto& s : mesh.surfaces) named += s.faces.size();
    EXPECT_EQ(named, data::boundary_faces(mesh).size());
    EXPECT_GT(cell_quality(mesh).jacobian_ratio.minCoeff(), type == CellType::tet10 ? 0.2 : 0.3);
  }
}

TEST(Cylinder, VolumeConvergesToThatOfTheCircleWithTheOrderOfItsGeometry) {
  // A chord misses the area by h^2, a parabola by h^4.
  const auto error = [](CellType type, int fineness) {
    return std::abs(volume(cylinder(small_cylinder(type, fineness))) - 0.5 * pi);
  };
  EXPECT_NEAR(std::log2(error(CellType::hex8, 1) / error(CellType::hex8, 2)), 2.0, 0.1);
  EXPECT_NEAR(std::log2(error(CellType::hex27, 1) / error(CellType::hex27, 2)), 4.0, 0.2);
  EXPECT_NEAR(std::log2(error(CellType::tet10, 1) / error(CellType::tet10, 2)), 4.0, 0.2);
}

TEST(Cylinder, NodesOfTheSideLieOnTheEllipse) {
  CylinderOptions options = small_cylinder(CellType::hex27);
  options.radius_y_m = 0.2;
  const Mesh mesh = cylinder(options);
  for (const int p : mesh.surface_points("side")) {
    const Eigen::Vector3d x = mesh.points.col(p);
    EXPECT_NEAR(std::hypot(x.x() / 0.5, x.y() / 0.2), 1.0, 1e-14);
  }
}

SpindleOptions small_spindle(CellType type) {
  SpindleOptions options;
  options.type = type;
  options.origin_tendon = {0.03, 2};
  options.belly = {0.12, 8};
  options.insertion_tendon = {0.05, 3};
  options.belly_radius_m = 0.02;
  options.tendon_radius_m = 0.004;
  return options;
}

TEST(Spindle, IsSoundForEveryCellType) {
  for (const CellType type : all_types) {
    SCOPED_TRACE(data::to_string(type));
    const Mesh mesh = spindle(small_spindle(type));
    EXPECT_EQ(structure(mesh), "");
    for (const auto& d : check_quality(mesh)) ADD_FAILURE() << d.message;
    EXPECT_LT(gap(mesh), 1e-15);
    EXPECT_EQ(mesh.regions, (std::vector<std::string>{"tendon_origin", "muscle", "tendon_insertion"}));
    EXPECT_EQ(surface_names(mesh), (std::vector<std::string>{"belly", "insertion", "origin", "side"}));
    const double z = 0.2;
    EXPECT_NEAR(vector_area(mesh, "insertion").normalized().z(), 1.0, 1e-14);
    for (const int p : mesh.surface_points("insertion")) EXPECT_DOUBLE_EQ(mesh.points(2, p), z);
    for (const int p : mesh.surface_points("origin")) EXPECT_EQ(mesh.points(2, p), 0.0);
  }
}

TEST(Spindle, BellyVolumeConvergesToThatOfItsProfile) {
  // int pi (a + b sin^2(pi s))^2 ds = pi (a^2 + a b + 3/8 b^2) per length
  const double a = 0.004, b = 0.016;
  const double expected = pi * (a * a + a * b + 0.375 * b * b) * 0.12;
  const auto error = [&](int fineness) {
    SpindleOptions options = small_spindle(CellType::hex27);
    options.belly.cells = 8 * fineness;
    options.section = {2 * fineness, fineness, 1.0};
    return std::abs(volume(spindle(options), "muscle") / expected - 1.0);
  };
  EXPECT_LT(error(2), 1e-4);
  EXPECT_NEAR(std::log2(error(2) / error(4)), 4.0, 0.2);
}

TEST(Spindle, FibresAreTangentToTheSurfaceOfTheBelly) {
  const Mesh mesh = spindle(small_spindle(CellType::hex27));
  const Eigen::MatrixXd& fibre = mesh.point_fields.at("fibre");
  for (const int p : mesh.surface_points("belly")) {
    const Eigen::Vector3d x = mesh.points.col(p);
    const double s = (x.z() - 0.03) / 0.12, slope = 0.016 * pi * std::sin(2 * pi * s) / 0.12;
    const Eigen::Vector3d normal(x.x() / x.head<2>().norm(), x.y() / x.head<2>().norm(), -slope);
    EXPECT_NEAR(fibre.col(p).dot(normal), 0.0, 1e-12);
    EXPECT_NEAR(fibre.col(p).norm(), 1.0, 1e-14);
  }
  EXPECT_EQ(mesh.cell_fields.at("gamma_M").minCoeff(), 0.0);
  EXPECT_EQ(mesh.cell_fields.at("gamma_M").maxCoeff(), 1.0);
}

TEST(Spindle, AponeurosesAreSheetsThatCoverTheirShareOfTheBelly) {
  SpindleOptions options = small_spindle(CellType::hex27);
  options.aponeurosis_thickness_norm = 0.1;
  options.aponeurosis_origin_norm = 0.25;
  options.aponeurosis_insertion_norm = 0.5;
  options.flatness = 0.6;
  const Mesh mesh = spindle(options);
  EXPECT_EQ(structure(mesh), "");
  EXPECT_TRUE(check_quality(mesh).empty());
  EXPECT_EQ(mesh.regions.size(), 5u);
  // 8 layers along the belly, 8 cells around.
  const int origin = mesh.region("aponeurosis_origin"), insertion = mesh.region("aponeurosis_insertion");
  EXPECT_EQ(std::ranges::count(mesh.region_of_cell, origin), 2 * 8);
  EXPECT_EQ(std::ranges::count(mesh.region_of_cell, insertion), 4 * 8);
}

TEST(Spindle, TransitionRisesSmoothlyInsideTheBelly) {
  SpindleOptions options = small_spindle(CellType::hex27);
  options.transition_m = 0.03;
  const Mesh mesh = spindle(options);
  const Eigen::MatrixXd& gamma = mesh.point_fields.at("gamma_M");
  for (int p = 0; p < mesh.point_count(); ++p) {
    const double z = mesh.points(2, p);
    const double t = std::clamp(std::min(z - 0.03, 0.15 - z) / 0.03, 0.0, 1.0);
    EXPECT_NEAR(gamma(0, p), 3 * t * t - 2 * t * t * t, 1e-12) << z;
  }
}

TEST(Spindle, ProfileOfGivenRadiiIsMet) {
  SpindleOptions options = small_spindle(CellType::hex27);
  options.profile_m = {0.003, 0.02, 0.012, 0.005};
  options.belly.cells = 16;
  const Mesh mesh = spindle(options);
  double at_start = 0.0, in_belly = 0.0;
  for (int p = 0; p < mesh.point_count(); ++p) {
    const double r = mesh.points.col(p).head<2>().norm();
    if (mesh.points(2, p) == 0.0) at_start = std::max(at_start, r);
    in_belly = std::max(in_belly, r);
  }
  EXPECT_NEAR(at_start, 0.003, 1e-15);
  EXPECT_LE(in_belly, 0.02 + 1e-15);
  for (const auto& d : check_quality(mesh)) ADD_FAILURE() << d.message;
}

TEST(Spindle, RefusesContradictions) {
  const auto with = [](auto change) {
    SpindleOptions options = small_spindle(CellType::hex8);
    change(options);
    EXPECT_THROW(spindle(options), data::InputError);
  };
  with([](SpindleOptions& o) { o.belly_radius_m = 0.0; });
  with([](SpindleOptions& o) { o.section.core_cells = 0; });
  with([](SpindleOptions& o) { o.profile_m = {0.1, -0.1, 0.1}; });
  with([](SpindleOptions& o) { o.aponeurosis_thickness_norm = 0.1, o.aponeurosis_origin_norm = 0.6; });
  with([](SpindleOptions& o) { o.aponeurosis_thickness_norm = 0.1, o.transition_m = 0.01; });
  with([](SpindleOptions& o) { o.belly.cells = 0; });
}

PennateOptions small_pennate(CellType type) {
  PennateOptions options;
  options.type = type;
  options.length = {0.06, 4};
  options.width = {0.03, 2};
  options.thickness = {0.02, 3};
  options.pennation_rad = 25.0 * pi / 180.0;
  options.aponeurosis = {0.001, 1};
  options.tendon = {0.02, 2, 2.0, false};
  return options;
}

TEST(PennateBelly, IsSoundForEveryCellTypeAndHasTheVolumesOfItsParts) {
  for (const CellType type : all_types) {
    SCOPED_TRACE(data::to_string(type));
    const Mesh mesh = pennate_belly(small_pennate(type));
    EXPECT_EQ(structure(mesh), "");
    for (const auto& d : check_quality(mesh)) ADD_FAILURE() << d.message;
    EXPECT_LT(gap(mesh), 1e-15);
    EXPECT_NEAR(volume(mesh, "muscle"), 0.06 * 0.03 * 0.02, 1e-17);
    EXPECT_NEAR(volume(mesh, "aponeurosis_deep"), 0.06 * 0.03 * 0.001, 1e-17);
    EXPECT_NEAR(volume(mesh, "tendon_insertion"), 0.02 * 0.03 * 0.001, 1e-17);
    EXPECT_EQ(surface_names(mesh), (std::vector<std::string>{"deep", "distal", "insertion", "origin",
                                                             "proximal", "superficial", "y0", "y1"}));
    const Eigen::Vector3d end(0.03 * 0.001, 0, 0);
    EXPECT_LT((vector_area(mesh, "origin") + end).norm(), 1e-17);
    EXPECT_LT((vector_area(mesh, "insertion") - end).norm(), 1e-17);
    EXPECT_LT(vector_area(mesh, "y0").y(), 0.0);
    EXPECT_GT(vector_area(mesh, "y1").y(), 0.0);
    EXPECT_NEAR(vector_area(mesh, "deep").z(), -0.08 * 0.03, 1e-15);
  }
}

TEST(PennateBelly, FibresLieAlongTheObliqueEnds) {
  const Mesh mesh = pennate_belly(small_pennate(CellType::hex27));
  const Eigen::Vector3d normal = vector_area(mesh, "distal").normalized();
  for (int c = 0; c < mesh.cell_count(); ++c) {
    const Eigen::Vector3d fibre = mesh.cell_fields.at("fibre").col(c);
    EXPECT_NEAR(fibre.norm(), 1.0, 1e-15);
    if (mesh.cell_fields.at("gamma_M")(0, c) == 1.0) {
      EXPECT_NEAR(fibre.dot(normal), 0.0, 1e-14);
      EXPECT_NEAR(std::acos(fibre.x()), 25.0 * pi / 180.0, 1e-12);
    }
  }
}

TEST(PennateBelly, WithoutSheetsItIsHeldByItsLowerAndUpperSide) {
  PennateOptions options = small_pennate(CellType::hex8);
  options.aponeurosis.length_m = options.tendon.length_m = 0.0;
  const Mesh mesh = pennate_belly(options);
  EXPECT_EQ(mesh.regions, std::vector<std::string>{"muscle"});
  EXPECT_NEAR(vector_area(mesh, "origin").z(), -0.06 * 0.03, 1e-16);
  EXPECT_NEAR(vector_area(mesh, "insertion").z(), 0.06 * 0.03, 1e-16);
  options.tendon.length_m = 0.01;
  EXPECT_THROW(pennate_belly(options), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
