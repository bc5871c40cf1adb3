#include <cmath>

#include "fem/linear/refinement.hpp"
#include "tests/fem/linear/stokes_matrix.hpp"

namespace brachium::fem {
namespace {

TEST(SaddlePoint, HasAsManyNegativeEigenvaluesAsPressuresWithoutGrowthAndWithoutFallBack) {
  for (const auto& [x, y, z] : {std::array{1, 1, 1}, {2, 2, 2}, {4, 3, 3}, {6, 2, 5}}) {
    const test::Stokes stokes = test::stokes(x, y, z);
    SolverOptions options;
    options.fall_back = false;
    const auto solver = make_symmetric_solver("ldl", options);
    solver->analyse(stokes.matrix.pattern, stokes.matrix.groups);
    ASSERT_EQ(solver->factorise(stokes.matrix.values).kind, FactorKind::indefinite);
    EXPECT_EQ(solver->inertia()->negative, stokes.pressures);
    EXPECT_LT(solver->inertia()->growth, 100.0);
  }
}

TEST(SaddlePoint, IsSolvedAsEigenAndUmfpackDo) {
  const test::Stokes stokes = test::stokes(3, 2, 2);
  const test::Matrix& m = stokes.matrix;
  const std::vector<double> b = test::random_vector(m.n());
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(m.eigen());
  const Eigen::VectorXd reference = lu.solve(Eigen::Map<const Eigen::VectorXd>(b.data(), m.n()));
  for (const char* name : {"ldl", "umfpack"}) {
    const auto solver = make_symmetric_solver(name);
    solver->analyse(m.pattern, m.groups);
    ASSERT_TRUE(solver->factorise(m.values).solvable()) << name;
    std::vector<double> x = b;
    solver->solve(x);
    const Eigen::VectorXd difference = Eigen::Map<const Eigen::VectorXd>(x.data(), m.n()) - reference;
    EXPECT_LT(difference.norm(), 1e-11 * reference.norm()) << name;
  }
}

TEST(SaddlePoint, WithoutMarksIsRefusedOrFallsBackAndSaysSo) {
  const test::Stokes stokes = test::stokes(4, 3, 3);
  const test::Matrix& m = stokes.matrix;
  SolverOptions options;
  options.fall_back = false;
  const UnknownGroups unmarked{m.groups.block_of_unknown, {}};
  const auto strict = make_symmetric_solver("ldl", options), lenient = make_symmetric_solver("ldl");
  strict->analyse(m.pattern, unmarked);
  ASSERT_EQ(strict->factorise(m.values).kind, FactorKind::unstable);
  EXPECT_FALSE(strict->inertia().has_value());
  std::vector<double> x(m.n(), 1.0);
  EXPECT_ANY_THROW(strict->solve(x));

  lenient->analyse(m.pattern, unmarked);
  EXPECT_EQ(lenient->factorise(m.values).kind, FactorKind::regular);
  EXPECT_THAT(lenient->statistics().method, ::testing::HasSubstr("umfpack"));
  EXPECT_THAT(lenient->statistics().method, ::testing::HasSubstr("ldl was unstable"));
  EXPECT_FALSE(lenient->inertia().has_value());
  const std::vector<double> b = test::random_vector(m.n());
  EXPECT_LT(solve_refined(*lenient, m.view(), b, x).backward_error, 1e-14);
}

TEST(SaddlePoint, WithoutSupportHasOneZeroPivotPerTranslation) {
  // ∇u : ∇v without a held face: three translations are free.
  const test::Stokes stokes = test::stokes(2, 2, 1, false);
  const auto solver = make_symmetric_solver("ldl");
  solver->analyse(stokes.matrix.pattern, stokes.matrix.groups);
  const FactorStatus status = solver->factorise(stokes.matrix.values);
  EXPECT_EQ(status.kind, FactorKind::singular);
  ASSERT_EQ(status.zero_unknowns.size(), 3U);
  // One of each direction: the unknowns of a node follow each other.
  std::array<int, 3> directions{};
  for (const int unknown : status.zero_unknowns) ++directions[unknown % 3];
  EXPECT_THAT(directions, ::testing::Each(1));
}

TEST(SaddlePoint, GrowthLimitIsHeldAgainstTheMeasuredGrowth) {
  const test::Stokes stokes = test::stokes(2, 2, 2);
  SolverOptions options;
  options.fall_back = false;
  options.growth_limit = 1.01;
  const auto solver = make_symmetric_solver("ldl", options);
  solver->analyse(stokes.matrix.pattern, stokes.matrix.groups);
  EXPECT_EQ(solver->factorise(stokes.matrix.values).kind, FactorKind::unstable);
}

}  // namespace
}  // namespace brachium::fem
