#include "fem/solve/constraints.hpp"

#include <Eigen/Geometry>

#include "bodies.hpp"

namespace brachium::fem {
namespace {

using tests::body;
using tests::soft;

Problem turned_cube(const Eigen::Matrix3d& R) {
  Problem p = body(Formulation::q1_p0, {0.01, 0.01, 0.01}, 1, 1, 1, soft());
  tests::turn(p, R);
  return p;
}

Constraints constraints_of(const Problem& p) {
  return Constraints(p, p.mesh->point_count(), 3 * p.mesh->point_count(), {});
}

TEST(Constraints, StraightPlanesNeedNoFrames) {
  Problem p = turned_cube(Eigen::Matrix3d::Identity());
  p.conditions = {
      {"x", "x0", SymmetryPlane{}}, {"y", "y0", SymmetryPlane{}}, {"z", "z0", Fixed{{false, false, true}}}};
  const Constraints c = constraints_of(p);
  EXPECT_EQ(c.frames().cols(), 0);
  EXPECT_EQ(c.held_count(), 12);  // four points a face
}

TEST(Constraints, ObliquePlanesMeetInOrthonormalFrames) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 1, 2).normalized()).toRotationMatrix();
  Problem p = turned_cube(R);
  p.conditions = {{"x", "x0", SymmetryPlane{}}, {"y", "y0", SymmetryPlane{}}, {"z", "z0", SymmetryPlane{}}};
  const Constraints c = constraints_of(p);
  EXPECT_EQ(c.held_count(), 12);
  Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(3 * p.mesh->point_count(), -1.0, 1.0);
  c.impose(Eigen::VectorXd::Zero(3), u);
  for (const char* name : {"x0", "y0", "z0"}) {
    const Eigen::Vector3d normal = R * Eigen::Vector3d::Unit(name[0] - 'x');
    for (const int n : p.mesh->surface_points(name)) {
      EXPECT_NEAR(normal.dot(u.segment<3>(3 * n)), 0.0, 1e-14);
      const Eigen::Matrix3d Q = c.frames().middleCols<3>(3 * n);
      EXPECT_LT((Q.transpose() * Q - Eigen::Matrix3d::Identity()).norm(), 1e-14);
    }
  }
}

/// A plane at 45 degrees and a fixed component meet: two directions that are not orthogonal.
TEST(Constraints, APlaneAndAComponentThatAreNotOrthogonalHoldBoth) {
  Problem p = turned_cube(Eigen::AngleAxisd(M_PI / 4.0, Eigen::Vector3d::UnitZ()).toRotationMatrix());
  p.conditions = {{"plane", "x0", SymmetryPlane{}},
                  {"move", "x0", PrescribedDisplacement{{0.002, NAN, NAN}}}};
  const Constraints c = constraints_of(p);
  Eigen::VectorXd u = Eigen::VectorXd::Ones(3 * p.mesh->point_count());
  c.impose(Eigen::Vector2d(0.0, 1.0), u);
  for (const int n : p.mesh->surface_points("x0")) {
    EXPECT_NEAR(u[3 * n], 0.002, 1e-15);
    EXPECT_NEAR(u[3 * n] + u[3 * n + 1], 0.0, 1e-15);
    EXPECT_EQ(u[3 * n + 2], 1.0);
  }
}

TEST(Constraints, NotBorneIsThePartOfAForceThatNothingHolds) {
  Problem p = turned_cube(Eigen::Matrix3d::Identity());
  p.conditions = {{"x", "x0", Fixed{{true, false, false}}}};
  const Constraints c = constraints_of(p);
  const Eigen::VectorXd rest = c.not_borne(Eigen::VectorXd::Ones(3 * p.mesh->point_count()));
  EXPECT_EQ(rest.sum(), 3.0 * p.mesh->point_count() - 4.0);
}

TEST(Constraints, ContradictionsAreFoundAtTheAmplitudeWhereTheyArise) {
  Problem p = turned_cube(Eigen::Matrix3d::Identity());
  p.conditions = {{"foot", "x0", Fixed{}}, {"move", "z0", PrescribedDisplacement{{NAN, NAN, 0.001}}}};
  const Constraints c = constraints_of(p);
  EXPECT_TRUE(c.contradictions(Eigen::Vector2d(0.0, 0.0), 1e-9).empty());
  const auto found = c.contradictions(Eigen::Vector2d(0.0, 1.0), 1e-9);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].nodes, 2);
  EXPECT_NEAR(found[0].difference_m, 0.001, 1e-12);
}

TEST(PlaneNormal, RefusesASurfaceThatIsNotPlane) {
  Problem p = body(Formulation::q2_p1_discontinuous, {0.01, 0.01, 0.01}, 2, 2, 2, soft());
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  mesh->points.col(mesh->surface_points("x0")[4])[0] += 1e-4;
  try {
    plane_normal(*mesh, "x0");
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics().front().code, "surface-not-plane");
  }
}

}  // namespace
}  // namespace brachium::fem
