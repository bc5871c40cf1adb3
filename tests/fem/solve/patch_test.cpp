/// A homogeneous state must be found exactly, whatever holds the body.

#include <Eigen/Geometry>

#include "bodies.hpp"

namespace brachium::fem {
namespace {

using tests::body;
using tests::quick_options;
using tests::reaction;
using tests::soft;

class Patch : public ::testing::TestWithParam<Formulation> {};

/// Displacements linear in X on the whole boundary: linear inside.
TEST_P(Patch, LinearDisplacementsOnTheBoundaryAreLinearInside) {
  Problem p = body(GetParam(), {0.02, 0.01, 0.01}, 2, 2, 2, soft(), 0.08);
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  mesh->surfaces.push_back({"skin", data::boundary_faces(*mesh)});
  p.mesh = mesh;
  Eigen::Matrix3d H;
  H << 0.10, 0.05, -0.03, 0.02, -0.06, 0.04, 0.0, 0.03, 0.05;
  const std::vector<int> nodes = mesh->surface_points("skin");
  PrescribedField field{Eigen::Matrix3Xd(3, static_cast<Eigen::Index>(nodes.size()))};
  for (std::size_t k = 0; k < nodes.size(); ++k)
    field.displacement_m.col(static_cast<Eigen::Index>(k)) = H * mesh->points.col(nodes[k]);
  p.conditions = {{"skin", "skin", field}};
  p.programme = {{"move", {{"skin", 1.0}}, {}, {}, 1, 1.0}};
  const Summary s = solve(p, quick_options());
  ASSERT_TRUE(s.completed) << s.reason;
  EXPECT_LT(tests::largest_difference(p, s.last.configuration.dofs,
                                      [&](const Eigen::Vector3d& X) { return Eigen::Vector3d(H * X); }),
            1e-10);
  EXPECT_EQ(s.steps.back().stability.verdict, "stable");
}

/// Uniaxial stretch between symmetry planes, turned in space so that the planes are oblique; one corner node
/// is on three.
TEST_P(Patch, SymmetryPlanesOfAnyDirectionHoldAUniaxialState) {
  const double k = 1e6, mu = 5e3, stretch = 1.15;
  const auto run = [&](const Eigen::Matrix3d& R) {
    Problem p = body(GetParam(), {0.02, 0.01, 0.01}, 2, 1, 1, soft(k), 0.08);
    tests::turn(p, R);
    const Eigen::Vector3d pull = R * Eigen::Vector3d(0.02 * (stretch - 1.0), 0.0, 0.0);
    p.conditions = {{"x", "x0", SymmetryPlane{}}, {"y", "y0", SymmetryPlane{}}, {"z", "z0", SymmetryPlane{}}};
    // The pulled end slides in its own plane: a dead traction would also do, a field holds the normal
    // component only where the plane is not oblique, so the pull is a total force.
    p.conditions.push_back({"pull", "x1", DeadTraction{R * Eigen::Vector3d(0.05, 0.0, 0.0), true}});
    (void)pull;
    p.programme = {{"pull", {{"pull", 1.0}}, {}, {}, 2, 1.0}};
    Eigen::Vector3d at_plane;
    const Summary s =
        solve(p, quick_options(), [&](const AcceptedState& state) { at_plane = reaction(p, state, "x0"); });
    EXPECT_TRUE(s.completed) << s.reason;
    EXPECT_LT((at_plane + R * Eigen::Vector3d(0.05, 0.0, 0.0)).norm(), 1e-9);
    Eigen::Vector3d corner = Eigen::Vector3d::Zero();
    for (int n = 0; n < p.mesh->point_count(); ++n) {
      const Eigen::Vector3d X = R.transpose() * p.mesh->points.col(n);
      if ((X - Eigen::Vector3d(0.02, 0.01, 0.01)).norm() < 1e-12)
        corner = R.transpose() * s.last.configuration.dofs.segment<3>(3 * n);
    }
    // Nominal stress 500 Pa: mu (l - 1/l) + k (J - 1) lateral^2 = 500, mu (q - 1/q) + k (J - 1) l q = 0, J =
    // l q^2.
    const double l = 1.0 + corner[0] / 0.02, q = 1.0 + corner[1] / 0.01, J = l * q * q;
    EXPECT_NEAR(corner[1], corner[2], 1e-11);
    EXPECT_NEAR(mu * (l - 1.0 / l) + k * (J - 1.0) * q * q, 500.0, 1e-4);
    EXPECT_NEAR(mu * (q - 1.0 / q) + k * (J - 1.0) * l * q, 0.0, 1e-4);
    return corner;
  };
  const Eigen::Vector3d straight = run(Eigen::Matrix3d::Identity());
  const Eigen::Vector3d oblique =
      run(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, -0.5).normalized()).toRotationMatrix());
  EXPECT_LT((straight - oblique).norm(), 1e-10);
}

/// A rigid rotation of 100 degrees of one end with the other end free: the body follows without stress.
TEST_P(Patch, AFiniteRotationOfOneEndTakesTheBodyAlong) {
  Problem p = body(GetParam(), {0.02, 0.01, 0.01}, 2, 1, 1, soft());
  const Eigen::Vector3d axis(0.3, -0.2, 1.0), centre(0.01, 0.0, 0.02);
  p.conditions = {{"turn", "x0", RigidMotion{{0.001, 0.0, -0.002}, centre, axis, 1.745}}};
  p.programme = {{"turn", {{"turn", 1.0}}, {}, {}, 6, 1.0}};
  const Summary s = solve(p, quick_options());
  ASSERT_TRUE(s.completed) << s.reason;
  const Eigen::AngleAxisd R(1.745, axis.normalized());
  EXPECT_LT(tests::largest_difference(p, s.last.configuration.dofs,
                                      [&](const Eigen::Vector3d& X) {
                                        return Eigen::Vector3d(centre + R * (X - centre) +
                                                               Eigen::Vector3d(0.001, 0.0, -0.002) - X);
                                      }),
            1e-8);
  EXPECT_NEAR(s.steps.back().energy, 0.0, 1e-12);
}

/// Fixed components and a prescribed displacement; pressure on a face against the same traction as a dead
/// one.
TEST_P(Patch, PressureOnAFaceThatKeepsItsAreaIsADeadTraction) {
  const auto run = [&](bool follows) {
    Problem p = body(GetParam(), {0.01, 0.01, 0.01}, 2, 1, 1, soft(1e6), 0.08);
    p.conditions = {{"x", "x0", Fixed{{true, false, false}}},
                    {"y0", "y0", Fixed{{false, true, false}}},
                    {"z0", "z0", Fixed{{false, false, true}}},
                    {"y1", "y1", Fixed{{false, true, false}}},
                    {"z1", "z1", PrescribedDisplacement{{NAN, NAN, 0.0}}}};
    if (follows) {
      p.conditions.push_back({"push", "x1", FollowerPressure{800.0}});
    } else {
      p.conditions.push_back({"push", "x1", DeadTraction{{-800.0, 0.0, 0.0}, false}});
    }
    p.programme = {{"push", {{"push", 1.0}}, {}, {}, 1, 1.0}};
    const Summary s = solve(p, quick_options());
    EXPECT_TRUE(s.completed) << s.reason;
    return s.last.configuration.dofs;
  };
  const Eigen::VectorXd dead = run(false), follower = run(true);
  EXPECT_LT((dead - follower).norm(), 1e-9 * dead.norm());
  EXPECT_GT(dead.norm(), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Formulations, Patch,
                         ::testing::Values(Formulation::q2_p1_discontinuous, Formulation::q1_p0,
                                           Formulation::q2_q1_taylor_hood, Formulation::p2_p1_taylor_hood,
                                           Formulation::p2b_p1_discontinuous, Formulation::q1_displacement),
                         [](const auto& which) { return to_string(which.param); });

}  // namespace
}  // namespace brachium::fem
