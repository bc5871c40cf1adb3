/// Signed distances of analytic bodies and of distance grids: closed forms, and derivatives by differences.

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "data/model/error.hpp"
#include "fem/contact/distance.hpp"
#include "fem/contact/distance_grid.hpp"
#include "tests/fem/contact/sphere_mesh.hpp"

namespace brachium::fem {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Made where a test asks for it: the grid takes a while.
RigidShape make_shape(const std::string& name) {
  if (name == "half_space") return HalfSpace{{0.1, 0.2, 0.3}, {1.0, 2.0, -1.0}};
  if (name == "sphere") return Sphere{{0.2, -0.1, 0.0}, 0.8};
  if (name == "cylinder") return Cylinder{{0.1, 0.0, 0.2}, {0.3, 1.0, 0.2}, 0.7};
  if (name == "capsule") return Capsule{{-0.5, 0.0, 0.1}, {0.6, 0.2, 0.0}, 0.5};
  if (name == "ellipsoid") {
    const Matrix3d axes = Eigen::AngleAxisd(0.7, Vector3d(1.0, 0.3, -0.4).normalized()).toRotationMatrix();
    return Ellipsoid{{0.1, 0.1, -0.2}, {1.2, 0.5, 0.8}, axes};
  }
  return TriangleBody{std::make_shared<const DistanceGrid>(TriangleTree(sphere_mesh(1.0, 4)), 0.1, 1.5)};
}

class EveryShape : public testing::TestWithParam<std::string> {
 protected:
  const RigidShape shape_ = make_shape(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Distance, EveryShape,
                         testing::Values("half_space", "sphere", "cylinder", "capsule", "ellipsoid", "grid"),
                         [](const auto& instance) { return instance.param; });

TEST_P(EveryShape, GradientAndHessianAreDerivatives) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.4, 1.4);
  const double h = 1e-5;
  int tried = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d x(uniform(random), uniform(random), uniform(random));
    const Distance d = distance(shape_, x);
    if (d.value < -0.15) continue;  // deep inside, beyond the evolute, distances have kinks
    ++tried;
    for (int k = 0; k < 3; ++k) {
      const Distance above = distance(shape_, x + h * Vector3d::Unit(k)),
                     below = distance(shape_, x - h * Vector3d::Unit(k));
      EXPECT_NEAR((above.value - below.value) / (2.0 * h), d.gradient[k], 1e-7) << x.transpose();
      // A capsule's curvature jumps where its ends begin, a spline's third derivative at the grid's planes.
      const double tolerance = GetParam() == "grid" ? 1e-3 : 1e-5;
      const double jump = (distance(shape_, x + 3.0 * h * Vector3d::Unit(k)).hessian -
                           distance(shape_, x - 3.0 * h * Vector3d::Unit(k)).hessian)
                              .norm();
      if (jump < 1e-2) {
        EXPECT_LT(((above.gradient - below.gradient) / (2.0 * h) - d.hessian.col(k)).norm(), tolerance)
            << x.transpose();
      }
    }
    EXPECT_LT((d.hessian - d.hessian.transpose()).norm(), 1e-12);
    if (GetParam() != "grid") {
      EXPECT_NEAR(d.gradient.norm(), 1.0, 1e-12);
    }
  }
  EXPECT_GT(tried, 100);
}

TEST_P(EveryShape, MovesWithItsPose) {
  Pose pose;
  pose.rotation = Eigen::AngleAxisd(1.2, Vector3d(0.2, 1.0, 0.4).normalized()).toRotationMatrix();
  pose.translation_m = Vector3d(0.3, -0.2, 0.1);
  const Vector3d x(0.9, 0.7, -0.6);
  const Distance home = distance(shape_, x),
                 moved = distance(shape_, pose, pose.rotation * x + pose.translation_m);
  EXPECT_NEAR(moved.value, home.value, 1e-12);
  EXPECT_LT((moved.gradient - pose.rotation * home.gradient).norm(), 1e-12);
  EXPECT_LT((moved.hessian - pose.rotation * home.hessian * pose.rotation.transpose()).norm(), 1e-11);
}

TEST(Distance, OfAnEllipsoidIsThatOfItsFoot) {
  // Points made from feet: x = p + s n(p) has distance s while p stays the closest point.
  const Ellipsoid e{Vector3d::Zero(), Vector3d(2.0, 1.0, 0.5), Matrix3d::Identity()};
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 500; ++i) {
    const Vector3d u = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const Vector3d p = e.semi_axes_m.cwiseProduct(u);
    const Vector3d n = p.cwiseQuotient(e.semi_axes_m.cwiseAbs2()).normalized();
    for (const double s : {-0.1, -0.01, 0.0, 0.3, 5.0}) {
      const Distance d = distance(e, p + s * n);
      EXPECT_NEAR(d.value, s, 1e-11);
      EXPECT_LT((d.gradient - n).norm(), 1e-9);
    }
  }
}

TEST(Distance, OfAnEllipsoidIsFiniteOnItsSymmetryPlanes) {
  const Ellipsoid e{Vector3d::Zero(), Vector3d(2.0, 1.0, 0.5), Matrix3d::Identity()};
  for (const Vector3d& x : {Vector3d(0.0, 0.0, 0.0), Vector3d(0.3, 0.0, 0.0), Vector3d(0.0, 0.2, 0.0),
                            Vector3d(1.0, 0.3, 0.0), Vector3d(0.0, 0.0, 0.1)}) {
    const Distance d = distance(e, x);
    EXPECT_TRUE(std::isfinite(d.value) && d.gradient.allFinite() && d.hessian.allFinite()) << x.transpose();
    EXPECT_LE(d.value, 0.0);
  }
  EXPECT_NEAR(distance(e, Vector3d::Zero()).value, -0.5, 1e-12);
}

TEST(Distance, OfASphereAsAnEllipsoidIsTheSpheres) {
  const Ellipsoid e{Vector3d(0.1, 0.2, 0.3), Vector3d::Constant(0.7), Matrix3d::Identity()};
  const Sphere s{Vector3d(0.1, 0.2, 0.3), 0.7};
  for (const Vector3d& x : {Vector3d(1.0, 0.5, 0.2), Vector3d(0.1, 0.4, 0.5), Vector3d(-3.0, 0.2, 0.3)}) {
    const Distance a = distance(e, x), b = distance(s, x);
    EXPECT_NEAR(a.value, b.value, 1e-13);
    EXPECT_LT((a.gradient - b.gradient).norm(), 1e-12);
    EXPECT_LT((a.hessian - b.hessian).norm(), 1e-11);
  }
}

TEST(Distance, OfAGridIsNearlyThatOfTheSphere) {
  const TriangleTree tree(sphere_mesh(1.0, 5));  // facets are flat to 6e-4
  const DistanceGrid grid(tree, 0.08, 0.5);
  EXPECT_LT(grid.greatest_error_m(), 1e-3);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const Vector3d n = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const double r = 1.0 + 0.2 * uniform(random);
    const Distance d = grid.evaluate(r * n);
    EXPECT_NEAR(d.value, r - 1.0, 1e-3);
    EXPECT_LT((d.gradient - n).norm(), 0.02);
  }
  EXPECT_NEAR(grid.evaluate(Vector3d(5.0, 0.0, 0.0)).value, 4.0, 0.05);
}

TEST(Distance, SmoothingOfAGridTakesTheFacetsOutOfTheCurvature) {
  const TriangleTree tree(sphere_mesh(1.0, 4));
  const DistanceGrid rough(tree, 0.08, 0.5), smooth(tree, 0.08, 0.5, 0.08);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double worst_rough = 0.0, worst_smooth = 0.0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d n = Vector3d(uniform(random), uniform(random), uniform(random)).normalized();
    const Matrix3d exact = Matrix3d::Identity() - n * n.transpose();
    worst_rough = std::max(worst_rough, (rough.evaluate(n).hessian - exact).norm());
    worst_smooth = std::max(worst_smooth, (smooth.evaluate(n).hessian - exact).norm());
  }
  EXPECT_LT(worst_smooth, 0.35 * worst_rough);
  // A Gaussian of width s adds s^2/2 times the Laplacian, here 2/r.
  EXPECT_NEAR(smooth.evaluate(Vector3d(1.0, 0.0, 0.0)).value - rough.evaluate(Vector3d(1.0, 0.0, 0.0)).value,
              0.08 * 0.08, 2e-3);
}

TEST(Distance, RefusesBodiesThatAreNone) {
  const auto message = [](const RigidShape& shape) {
    try {
      check(shape, "humerus");
    } catch (const data::InputError& e) {
      return e.diagnostics()[0].code + ": " + e.diagnostics()[0].message;
    }
    return std::string("accepted");
  };
  EXPECT_EQ(message(Sphere{Vector3d::Zero(), 0.0}), "contact-shape: the radius of body `humerus` is 0");
  EXPECT_EQ(message(Capsule{Vector3d::Zero(), Vector3d::Zero(), 0.01}),
            "contact-shape: the axis of body `humerus` has no direction");
  EXPECT_EQ(message(Ellipsoid{Vector3d::Zero(), {1.0, -1.0, 1.0}, Matrix3d::Identity()}),
            "contact-shape: a semi-axis of body `humerus` is -1");
  EXPECT_EQ(message(Sphere{Vector3d::Zero(), 0.02}), "accepted");
}

}  // namespace
}  // namespace brachium::fem
