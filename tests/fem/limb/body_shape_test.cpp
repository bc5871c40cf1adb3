#include "fem/limb/body_shape.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "data/model/error.hpp"
#include "fem/limb/in_situ.hpp"
#include "fem/limb/upper_limb.hpp"

// A muscle's own mesh, taken out of the parametric body and brought back: the same muscle.
namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

UpperLimb arm() {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  return generic_arm(coarse);
}

TEST(BodyShape, AStressFreeMeshGivesTheForcesOfTheBodyItWasTakenFrom) {
  const UpperLimb a = arm();
  const data::Mesh mesh = *build(a.biceps, a.range).problem.mesh;
  const MuscleBody imported = with_stress_free_shape(a.biceps, mesh);
  EXPECT_NEAR(imported.belly_length_m, a.biceps.belly_length_m, 1e-12);
  MuscleStates ours(a.biceps, a.range, a.hinge, a.humerus), theirs(imported, a.range, a.hinge, a.humerus);
  for (const double q : {150.0 * degree, 110.0 * degree}) {
    const double force = ours.solve_state(q, 0.5).force_n;
    EXPECT_NEAR(theirs.solve_state(q, 0.5).force_n, force, 1e-4 * force);
  }
}

TEST(BodyShape, AMeshInSituIsWhereItWasInTheArm) {
  const UpperLimb a = arm();
  MuscleStates ours(a.biceps, a.range, a.hinge, a.humerus);
  const SolveState& at = ours.solved(a.biceps.reference_rad, 0.0);
  data::Mesh in_situ = *ours.problem().mesh;
  const Eigen::Index n = in_situ.points.size();
  in_situ.points += at.configuration.dofs.head(n).reshaped(3, in_situ.points.cols());
  InSituReport report;
  const MuscleBody found =
      find_stress_free(a.biceps, in_situ, {}, a.range, a.hinge, a.humerus, SolvedMuscleOptions{}, &report);
  EXPECT_LE(report.greatest_error_m, 1e-7);
  MuscleStates theirs(found, a.range, a.hinge, a.humerus);
  const double force = ours.solve_state(110.0 * degree, 0.5).force_n;
  EXPECT_NEAR(theirs.solve_state(110.0 * degree, 0.5).force_n, force, 1e-2 * force);
}

TEST(BodyShape, AnEndBesideThePathIsRefused) {
  const UpperLimb a = arm();
  data::Mesh mesh = *build(a.biceps, a.range).problem.mesh;
  mesh.points.row(0).array() += 0.05;
  mesh.points.row(1).array() -= 0.1;
  EXPECT_THROW(with_in_situ_guess(a.biceps, mesh), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
