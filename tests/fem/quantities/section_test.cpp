#include "fem/quantities/section.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/fem/quantities/affine.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;
using verification::box_mesh;

TEST(Section, OfADeformedBoxHasTheAreaOfNansonsFormula) {
  for (const Formulation formulation : affine::formulations()) {
    const Discretisation d(box_mesh({.type = cell_type(formulation),
                                     .cells = {3, 2, 2},
                                     .size_m = Vector3d(3.0, 1.0, 0.5),
                                     .distortion = 0.15}),
                           formulation);
    const Eigen::Matrix3d F = affine::gradient();
    const Configuration c = affine::configuration(d, F, Vector3d(0.5, 0.0, 0.0));
    const Vector3d N = Vector3d(1.0, 0.2, -0.1).normalized(), centre(1.4, 0.5, 0.25);
    const SectionFigures s = section(d, c, centre, 3.0 * N);
    const double reference = 0.5 / N[0];
    const Vector3d expected = F.determinant() * F.inverse().transpose() * N * reference;
    EXPECT_NEAR(s.area_m2, expected.norm(), 1e-10) << to_string(formulation);
    EXPECT_NEAR(std::abs(s.normal.dot(expected.normalized())), 1.0, 1e-10);
    EXPECT_LT((s.centroid_m - (F * centre + Vector3d(0.5, 0.0, 0.0))).norm(), 1e-10);
  }
}

// Quadratic faces follow a circle to fourth order in the spacing; the section adds nothing to that.
TEST(Section, OfACylinderIsADiskToTheOrderOfItsMesh) {
  const double r = 0.02, radius = 1.2 * r;
  const auto disk = [r](const Vector3d& x) {
    const double u = 2.0 * x[1] - 1.0, v = 2.0 * x[2] - 1.0;
    return Vector3d(x[0], r * u * std::sqrt(1.0 - v * v / 2.0), r * v * std::sqrt(1.0 - u * u / 2.0));
  };
  double error = 1.0;
  for (const int n : {8, 16}) {
    const Discretisation d(box_mesh({.cells = {2, n, n}, .map = disk, .curved = true}),
                           Formulation::q2_p1_discontinuous);
    const Configuration c = affine::configuration(d, Vector3d(1.0, 1.2, 1.2).asDiagonal());
    const SectionFigures s = section(d, c, Vector3d(0.3, 0.0, 0.0), Vector3d::UnitX());
    const double now = std::abs(s.area_m2 / (std::numbers::pi * radius * radius) - 1.0);
    EXPECT_LT(now, n == 8 ? 2e-5 : error / 10.0);
    error = now;
    EXPECT_NEAR(s.mean_radius_m, radius, 1e-5 * radius);
    EXPECT_NEAR(s.least_radius_m, radius, 5e-4 * radius);
    EXPECT_NEAR(s.greatest_radius_m, radius, 5e-4 * radius);
    EXPECT_NEAR(s.perimeter_m, 2.0 * std::numbers::pi * radius, 1e-4 * radius);
    EXPECT_NEAR(section_thickness(d, c, Vector3d(0.3, 0.0, 0.0), Vector3d::UnitX(), Vector3d(0.0, 0.0, 2.0)),
                2.0 * radius, 1e-4 * radius);
  }
}

TEST(Section, ThroughTheNodesIsNoSpecialCase) {
  const Discretisation d(
      box_mesh({.type = data::CellType::tet10, .cells = {4, 3, 3}, .size_m = Vector3d(4.0, 1.0, 1.0)}),
      Formulation::p2_p1_taylor_hood);
  const Configuration c = affine::configuration(d, Eigen::Matrix3d::Identity());
  for (const double x : {1.0, 2.0, 2.5, 3.0, 0.123})
    EXPECT_NEAR(section(d, c, Vector3d(x, 0.0, 0.0), Vector3d::UnitX()).area_m2, 1.0, 1e-9) << x;
}

TEST(Section, OfAHollowBodyLeavesTheHoleOut) {
  auto mesh = box_mesh({.cells = {1, 3, 3}, .size_m = Vector3d(1.0, 3.0, 3.0)});
  Eigen::MatrixXi kept(27, 8);
  int n = 0;
  for (int cell = 0; cell < 9; ++cell) {
    if (cell != 4) kept.col(n++) = mesh->cells.col(cell);
  }
  // Only the points that are still used, renumbered.
  std::vector<int> number(static_cast<std::size_t>(mesh->point_count()), -1);
  Eigen::Matrix3Xd points(3, 0);
  for (int& node : kept.reshaped()) {
    int& to = number[static_cast<std::size_t>(node)];
    if (to < 0) {
      to = static_cast<int>(points.cols());
      points.conservativeResize(3, to + 1);
      points.col(to) = mesh->points.col(node);
    }
    node = to;
  }
  data::Mesh hollow;
  hollow.type = mesh->type;
  hollow.points = points;
  hollow.cells = kept;
  hollow.regions = {"ring"};
  hollow.region_of_cell.assign(8, 0);
  const Discretisation d(std::make_shared<data::Mesh>(hollow), Formulation::q2_p1_discontinuous);
  const SectionFigures s = section(d, affine::configuration(d, Eigen::Matrix3d::Identity()),
                                   Vector3d(0.4, 0.0, 0.0), Vector3d::UnitX());
  EXPECT_NEAR(s.area_m2, 8.0, 1e-10);
  EXPECT_NEAR(s.perimeter_m, 16.0, 1e-10);
  EXPECT_LT((s.centroid_m - Vector3d(0.4, 1.5, 1.5)).norm(), 1e-10);
}

TEST(Section, SaysWhenThePlaneMissesTheBody) {
  const Discretisation d(box_mesh({.type = data::CellType::hex8}), Formulation::q1_p0);
  const Configuration c = affine::configuration(d, Eigen::Matrix3d::Identity());
  const auto code = [&](const Vector3d& point, const Vector3d& normal) {
    try {
      section(d, c, point, normal);
    } catch (const data::InputError& e) {
      return e.diagnostics()[0].code;
    }
    return std::string();
  };
  EXPECT_EQ(code(Vector3d(2.0, 0.0, 0.0), Vector3d::UnitX()), "plane-misses-body");
  EXPECT_EQ(code(Vector3d(0.5, 0.0, 0.0), Vector3d::Zero()), "zero-direction");
}

}  // namespace
}  // namespace brachium::fem
