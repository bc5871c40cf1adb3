// The humerus as a closed triangle mesh instead of a capsule, and sweeps of either muscle back and forth.

#include <gtest/gtest.h>

#include <vector>

#include "fem/contact/distance_grid.hpp"
#include "tests/fem/contact/sphere_mesh.hpp"
#include "tests/fem/limb/coarse_arm.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;

/// Triangles of a capsule: a sphere's, its halves moved apart along y.
TriangleMesh capsule_mesh(const Capsule& capsule, int divisions) {
  TriangleMesh mesh = sphere_mesh(capsule.radius_m, divisions);
  for (Eigen::Index p = 0; p < mesh.points.cols(); ++p)
    mesh.points.col(p) += mesh.points(1, p) < 0.0 ? capsule.from_m : capsule.to_m;
  return mesh;
}

TEST(MeshedBone, GivesTheForcesOfTheCapsuleThatItWasMadeOf) {
  UpperLimb arm = coarse_arm();
  MuscleStates smooth = states_of(arm, arm.triceps);
  const auto& shaft = std::get<Capsule>(arm.humerus.front().shape);
  const TriangleTree tree(capsule_mesh(shaft, 4));
  const auto grid = std::make_shared<const DistanceGrid>(tree, 0.0015, 0.03, 0.001);
  EXPECT_LT(grid->greatest_error_m(), 3e-4);
  arm.humerus.front().shape = TriangleBody{grid};
  MuscleStates meshed = states_of(arm, arm.triceps);
  for (const double q : {30.0, 80.0, 130.0}) {
    for (const double a : {0.0, 1.0}) {
      const SolvedMuscle &s = smooth.solve_state(q * degree, a), &m = meshed.solve_state(q * degree, a);
      EXPECT_EQ(m.stability, "stable") << q;
      EXPECT_NEAR(m.force_n, s.force_n, 2e-3 * s.force_n) << q << ", " << a;
      // The path lies beside that over the capsule by no more than the grid's error: so does the lever arm.
      EXPECT_NEAR(m.arms.moment_n_m, s.arms.moment_n_m, grid->greatest_error_m() * s.force_n)
          << q << ", " << a;
      EXPECT_NEAR(contact_force(m), contact_force(s), 0.1 * contact_force(s) + 0.2) << q << ", " << a;
    }
  }
}

class Sweep : public testing::TestWithParam<double> {};

TEST_P(Sweep, BackIsTheSameAsForth) {
  const UpperLimb arm = coarse_arm();
  for (const MuscleBody* body : {&arm.biceps, &arm.triceps}) {
    MuscleStates forth = states_of(arm, *body, GetParam()), back = states_of(arm, *body, GetParam());
    std::vector<double> up, down;
    for (double q = 10.0; q <= 150.0; q += 14.0) up.push_back(forth.solve_state(q * degree, 0.5).force_n);
    for (double q = 150.0; q >= 10.0; q -= 14.0) {
      const SolvedMuscle& s = back.solve_state(q * degree, 0.5);
      EXPECT_EQ(s.stability, "stable") << body->name << ", " << q;
      down.push_back(s.force_n);
    }
    for (std::size_t k = 0; k < up.size(); ++k)
      EXPECT_NEAR(down[up.size() - 1 - k], up[k], (GetParam() > 0.0 ? 2e-3 : 1e-6) * up[k])
          << body->name << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Contact, Sweep, testing::Values(0.0, 1e-4), [](const auto& tolerance) {
  return tolerance.param > 0.0 ? "multipliers" : "penalty";
});

}  // namespace
}  // namespace brachium::fem
