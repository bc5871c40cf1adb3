#include "fem/linear/symmetric_solver.hpp"
#include "tests/fem/linear/sparse_matrices.hpp"

namespace brachium::fem {
namespace {

using test::Matrix;

class EveryCounter : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryCounter, CountsTheEigenvaluesOfAShiftedLaplacian) {
  for (const double shift : {0.05, 0.5, 2.345, 6.01, 11.0}) {
    const Matrix m = test::laplacian(7, 8, 9, shift);
    const auto solver = make_symmetric_solver(GetParam());
    solver->analyse(m.pattern);
    ASSERT_TRUE(solver->factorise(m.values).solvable()) << shift;
    const auto inertia = solver->inertia();
    ASSERT_TRUE(inertia.has_value()) << shift;
    EXPECT_EQ(inertia->negative, test::laplacian_eigenvalues_below(7, 8, 9, shift)) << shift;
    EXPECT_EQ(inertia->zero, 0);
    EXPECT_EQ(inertia->negative + inertia->positive, m.n());
  }
}

TEST_P(EveryCounter, CountsTheNegativeEigenvaluesOfHexahedraAsEigenDoes) {
  for (const int negative : {0, 3, 20, 60}) {
    const Matrix m = test::hex27_grid(2, 1, 1, 11, negative);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Eigen::MatrixXd(m.eigen()),
                                                               Eigen::EigenvaluesOnly);
    const auto solver = make_symmetric_solver(GetParam());
    solver->analyse(m.pattern, m.groups);
    ASSERT_TRUE(solver->factorise(m.values).solvable());
    EXPECT_EQ(solver->inertia()->negative, (eigen.eigenvalues().array() < 0.0).count()) << negative;
  }
}

INSTANTIATE_TEST_SUITE_P(ByName, EveryCounter, ::testing::Values("ldl", "cholmod"),
                         [](const auto& named) { return named.param; });

TEST(Inertia, OfADenseMatrixWithChosenEigenvaluesIsExact) {
  for (const int n : {1, 2, 5, 12, 13, 47, 48, 49, 97, 150, 700}) {
    Eigen::VectorXd lambda(n);
    for (int i = 0; i < n; ++i) lambda(i) = (i % 3 == 1 ? -1.0 : 1.0) * (1.0 + i);
    Matrix m = test::dense(test::with_eigenvalues(lambda, 2));
    m.groups.block_of_unknown.assign(n, 0);  // one front
    const auto solver = make_symmetric_solver("ldl");
    solver->analyse(m.pattern, m.groups);
    solver->factorise(m.values);
    ASSERT_TRUE(solver->inertia().has_value()) << n;
    EXPECT_EQ(solver->inertia()->negative, (lambda.array() < 0.0).count()) << n;
  }
}

TEST(Inertia, GrowthOfADefiniteMatrixIsOne) {
  const Matrix m = test::hex27_grid(3, 3, 2);
  for (const char* name : {"ldl", "cholmod"}) {
    const auto solver = make_symmetric_solver(name);
    solver->analyse(m.pattern, m.groups);
    solver->factorise(m.values);
    EXPECT_NEAR(solver->inertia()->growth, 1.0, 1e-12) << name;
  }
}

TEST(Inertia, ZeroDiagonalInsideABlockIsPivotedNotRefused) {
  // [0 1; 1 0], [0 2; 2 0], [0 -3; -3 0]: no 1 x 1 pivot exists.
  Matrix m = test::from_entries(6, {{{0, 0}, 0.0},
                                    {{0, 1}, 1.0},
                                    {{1, 1}, 0.0},
                                    {{2, 2}, 0.0},
                                    {{2, 3}, 2.0},
                                    {{3, 3}, 0.0},
                                    {{4, 4}, 0.0},
                                    {{4, 5}, -3.0},
                                    {{5, 5}, 0.0}});
  m.groups.block_of_unknown = {0, 0, 1, 1, 2, 2};
  const auto solver = make_symmetric_solver("ldl");
  solver->analyse(m.pattern, m.groups);
  EXPECT_EQ(solver->factorise(m.values).kind, FactorKind::indefinite);
  EXPECT_EQ(solver->inertia()->negative, 3);
  EXPECT_GT(solver->statistics().pivoted_blocks, 0);
  std::vector<double> x{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  solver->solve(x);
  EXPECT_THAT(x, ::testing::Pointwise(::testing::DoubleEq(), {2.0, 1.0, 2.0, 1.5, -2.0, -5.0 / 3.0}));
}

}  // namespace
}  // namespace brachium::fem
