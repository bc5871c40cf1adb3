#include "fem/solve/stress_free.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "data/model/error.hpp"
#include "fem/limb/upper_limb.hpp"

// A muscle whose shape in situ is known, pressed against its bone: the stress-free shape is found again.
namespace brachium::fem {
namespace {

struct Case {
  UpperLimb arm;
  data::Mesh parametric, truth;
  Eigen::Matrix3Xd in_situ;

  Problem make(std::shared_ptr<const data::Mesh> mesh) const {
    Problem problem = build(arm.biceps, arm.range, std::move(mesh)).problem;
    Contact contact;
    contact.name = "shaft";
    contact.surface = "side";
    contact.body = arm.humerus.front().shape;
    contact.penalty_pa_per_m = 1e8;
    contact.smoothing_m = 2e-4;
    problem.contacts = {contact};
    problem.programme = {in_situ_phase(4)};
    return problem;
  }
  auto maker() const {
    return [this](std::shared_ptr<const data::Mesh> mesh) { return make(std::move(mesh)); };
  }
};

Case muscle() {
  Case c;
  LimbMesh coarse;
  coarse.belly_cells = 4;
  c.arm = generic_arm(coarse);
  c.parametric = *build(c.arm.biceps, c.arm.range).problem.mesh;
  c.truth = c.parametric;
  // Bulges away from the bone by up to 2 mm, and is thinner there: no shape that parameters describe.
  const double length = c.arm.biceps.belly_length_m, top = c.parametric.points.row(1).maxCoeff();
  for (Eigen::Index p = 0; p < c.truth.points.cols(); ++p) {
    const double along = (top - c.truth.points(1, p)) / length;
    if (along > 0.02 && along < 0.98) {
      c.truth.points(0, p) += 2e-3 * std::sin(std::numbers::pi * along);
      c.truth.points(2, p) *= 1.0 - 0.05 * std::sin(std::numbers::pi * along);
    }
  }
  const Summary s = solve(c.make(std::make_shared<const data::Mesh>(c.truth)), {});
  if (!s.completed) throw std::runtime_error(s.reason);
  const Eigen::VectorXd& u = s.last.configuration.dofs;
  c.in_situ = c.truth.points + u.head(c.truth.points.size()).reshaped(3, c.truth.points.cols());
  return c;
}

TEST(StressFreeShape, OfAMuscleInSituIsFoundAgain) {
  const Case c = muscle();
  StressFreeOptions options;
  options.solve.relative_residual = 1e-10;
  const StressFreeShape found = stress_free_shape(c.in_situ, c.parametric, c.maker(), options);
  ASSERT_TRUE(found.converged) << found.reason;
  const auto off = [&](const data::Mesh& mesh) {
    return (mesh.points - c.truth.points).colwise().norm().maxCoeff();
  };
  EXPECT_GT(off(c.parametric), 1.5e-3) << "the first guess must be wrong";
  EXPECT_LT(off(found.mesh), 2e-6);
  EXPECT_LE(found.error_m.back(), options.tolerance_m);
  EXPECT_GT(found.error_m.front(), 1e-3);
  EXPECT_LT(found.error_m.size(), 25u);
}

TEST(StressFreeShape, RefusesALoadedShapeThatItsEndsDoNotReach) {
  const Case c = muscle();
  Eigen::Matrix3Xd elsewhere = c.in_situ;
  elsewhere.row(2).array() += 1e-3;
  EXPECT_THROW(stress_free_shape(elsewhere, c.parametric, c.maker()), data::InputError);
  EXPECT_THROW(stress_free_shape(c.in_situ.leftCols(5), c.parametric, c.maker()), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
