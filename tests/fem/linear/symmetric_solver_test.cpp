#include "fem/linear/symmetric_solver.hpp"

#include <cmath>

#include "data/model/error.hpp"
#include "fem/linear/refinement.hpp"
#include "tests/fem/linear/sparse_matrices.hpp"

namespace brachium::fem {
namespace {

using test::Matrix;

double relative_error(std::span<const double> x, std::span<const double> reference) {
  double difference = 0.0, size = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    difference = std::max(difference, std::abs(x[i] - reference[i]));
    size = std::max(size, std::abs(reference[i]));
  }
  return difference / size;
}

std::vector<double> by_eigen(const Matrix& m, const std::vector<double>& b) {
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(m.eigen());
  const Eigen::VectorXd x = lu.solve(Eigen::Map<const Eigen::VectorXd>(b.data(), m.n()));
  return {x.begin(), x.end()};
}

class EverySolver : public ::testing::TestWithParam<std::string> {};

TEST_P(EverySolver, SolvesADefiniteMatrixOfHexahedraAsEigenDoes) {
  const Matrix m = test::hex27_grid(3, 2, 2);
  const auto solver = make_symmetric_solver(GetParam());
  solver->analyse(m.pattern, m.groups);
  const FactorStatus status = solver->factorise(m.values);
  EXPECT_EQ(status.kind, GetParam() == "umfpack" ? FactorKind::regular : FactorKind::positive_definite);
  const std::vector<double> b = test::random_vector(m.n());
  std::vector<double> x = b;
  solver->solve(x);
  EXPECT_LT(relative_error(x, by_eigen(m, b)), 1e-12);
}

TEST_P(EverySolver, SolvesAnIndefiniteMatrixAsEigenDoes) {
  const Matrix m = test::hex27_grid(3, 2, 2, 5, 20);
  const auto solver = make_symmetric_solver(GetParam());
  solver->analyse(m.pattern, m.groups);
  const FactorStatus status = solver->factorise(m.values);
  EXPECT_EQ(status.kind, GetParam() == "umfpack" ? FactorKind::regular : FactorKind::indefinite);
  const std::vector<double> b = test::random_vector(m.n());
  std::vector<double> x(b.size());
  const Refinement refinement = solve_refined(*solver, m.view(), b, x);
  EXPECT_LT(refinement.backward_error, 1e-14);
  EXPECT_LT(relative_error(x, by_eigen(m, b)), 1e-10);
}

TEST_P(EverySolver, SolvesManyRightHandSidesAsItDoesEachAlone) {
  const Matrix m = test::hex27_grid(2, 2, 1);
  const auto solver = make_symmetric_solver(GetParam());
  solver->analyse(m.pattern, m.groups);
  solver->factorise(m.values);
  std::vector<double> block = test::random_vector(3 * m.n()), single(block);
  solver->solve(block, 3);
  for (int c = 0; c < 3; ++c) solver->solve(std::span(single).subspan(c * m.n(), m.n()));
  EXPECT_LT(relative_error(block, single), 1e-13);
}

TEST_P(EverySolver, FactorisesNewValuesOnTheSamePattern) {
  Matrix m = test::hex27_grid(2, 2, 2);
  const auto solver = make_symmetric_solver(GetParam());
  solver->analyse(m.pattern, m.groups);
  for (const unsigned seed : {1U, 2U, 3U}) {
    m.values = test::hex27_grid(2, 2, 2, seed, seed == 2 ? 15 : 0).values;
    solver->factorise(m.values);
    const std::vector<double> b = test::random_vector(m.n(), seed);
    std::vector<double> x(b.size());
    solve_refined(*solver, m.view(), b, x);
    EXPECT_LT(relative_error(x, by_eigen(m, b)), 1e-10) << seed;
  }
}

TEST_P(EverySolver, SolvesWithoutBlocksAndWithEitherOrdering) {
  const Matrix m = test::laplacian(7, 8, 9);
  for (const Ordering ordering : {Ordering::metis, Ordering::amd, Ordering::automatic}) {
    SolverOptions options;
    options.ordering = ordering;
    const auto solver = make_symmetric_solver(GetParam(), options);
    solver->analyse(m.pattern);
    solver->factorise(m.values);
    const std::vector<double> b = test::random_vector(m.n());
    std::vector<double> x = b;
    solver->solve(x);
    EXPECT_LT(relative_error(x, by_eigen(m, b)), 1e-13);
  }
}

TEST_P(EverySolver, SolvesMatricesOfOneUnknownAndOfSeparateParts) {
  const Matrix matrices[] = {
      test::from_entries(1, {{{0, 0}, 4.0}}),
      test::from_entries(4, {{{0, 0}, 2.0}, {{0, 2}, 1.0}, {{1, 1}, 3.0}, {{2, 2}, 5.0}, {{3, 3}, 1.0}})};
  for (const Matrix& m : matrices) {
    const auto solver = make_symmetric_solver(GetParam());
    solver->analyse(m.pattern);
    ASSERT_TRUE(solver->factorise(m.values).solvable());
    const std::vector<double> b = test::random_vector(m.n());
    std::vector<double> x = b;
    solver->solve(x);
    EXPECT_LT(relative_error(x, by_eigen(m, b)), 1e-15);
  }
}

TEST_P(EverySolver, NamesTheUnknownThatNothingHolds) {
  Matrix m = test::hex27_grid(2, 1, 1);
  const int loose = 40;
  for (int j = 0; j < m.n(); ++j) {
    for (int e = m.pattern.column_start[j]; e < m.pattern.column_start[j + 1]; ++e) {
      if (j == loose || m.pattern.row[e] == loose) m.values[e] = 0.0;
    }
  }
  const auto solver = make_symmetric_solver(GetParam());
  solver->analyse(m.pattern, m.groups);
  const FactorStatus status = solver->factorise(m.values);
  EXPECT_EQ(status.kind, FactorKind::singular);
  EXPECT_EQ(status.first_zero_unknown, loose);
  EXPECT_FALSE(status.solvable());
  std::vector<double> x(m.n(), 1.0);
  EXPECT_THROW(solver->solve(x), data::InputError);
}

TEST_P(EverySolver, FindsThatAFreeChainIsSingular) {
  // Springs between neighbours, none to the ground: the constant vector is in the kernel.
  test::Entries entries;
  const int n = 50;
  for (int i = 0; i + 1 < n; ++i) {
    const double k = 1.0 + 0.37 * i;
    entries[{i, i}] += k;
    entries[{i + 1, i + 1}] += k;
    entries[{i, i + 1}] = -k;
  }
  const Matrix m = test::from_entries(n, entries);
  const auto solver = make_symmetric_solver(GetParam());
  solver->analyse(m.pattern);
  const FactorStatus status = solver->factorise(m.values);
  EXPECT_EQ(status.kind, FactorKind::singular);
  EXPECT_EQ(status.zero_unknowns.size(), 1U);
}

std::string code_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const data::InputError& error) {
    return error.diagnostics().front().code;
  }
  return "none";
}

TEST_P(EverySolver, RejectsWrongSizesValuesAndOrderOfCalls) {
  const Matrix m = test::laplacian(3, 3, 3);
  const auto solver = make_symmetric_solver(GetParam());
  std::vector<double> x(m.n(), 1.0), short_x(m.n() - 1, 1.0);
  EXPECT_EQ(code_of([&] { solver->factorise(m.values); }), "linear-order");
  EXPECT_EQ(code_of([&] { solver->analyse(m.pattern, {std::vector<int>(3, 0), {}}); }), "linear-size");
  solver->analyse(m.pattern);
  EXPECT_EQ(code_of([&] { solver->solve(x); }), "linear-order");
  EXPECT_EQ(code_of([&] { solver->factorise(std::span(m.values).first(5)); }), "linear-size");
  std::vector<double> bad = m.values;
  bad[3] = std::nan("");
  EXPECT_EQ(code_of([&] { solver->factorise(bad); }), "linear-value");
  bad[3] = INFINITY;
  EXPECT_EQ(code_of([&] { solver->factorise(bad); }), "linear-value");
  solver->factorise(m.values);
  EXPECT_EQ(code_of([&] { solver->solve(short_x); }), "linear-size");
  EXPECT_EQ(code_of([&] { solver->solve(x, 2); }), "linear-size");
}

INSTANTIATE_TEST_SUITE_P(ByName, EverySolver, ::testing::Values("ldl", "cholmod", "umfpack"),
                         [](const auto& named) { return named.param; });

TEST(MakeSymmetricSolver, SuggestsTheNearestName) {
  try {
    make_symmetric_solver("cholmud");
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().code, "unknown-solver");
    EXPECT_THAT(error.diagnostics().front().help, ::testing::HasSubstr("cholmod"));
  }
}

TEST(LdlSolver, GivesTheSameBitsForAnyNumberOfThreads) {
  for (const int negative : {0, 15}) {
    const Matrix m = test::hex27_grid(8, 4, 4, 3, negative);
    std::vector<double> reference;
    for (const int threads : {1, 2, 3}) {
      SolverOptions options;
      options.threads = threads;
      const auto solver = make_symmetric_solver("ldl", options);
      solver->analyse(m.pattern, m.groups);
      for (int repeat = 0; repeat < 3; ++repeat) {
        ASSERT_TRUE(solver->factorise(m.values).solvable());
        std::vector<double> x = test::random_vector(m.n());
        solver->solve(x);
        if (reference.empty()) reference = x;
        ASSERT_EQ(x, reference) << threads << " threads";
      }
    }
  }
}

TEST(LdlSolver, KeepsNothingOfTheMatrixBefore) {
  const Matrix a = test::hex27_grid(3, 2, 2, 1), b = test::hex27_grid(3, 2, 2, 2, 15);
  const auto solver = make_symmetric_solver("ldl");
  solver->analyse(a.pattern, a.groups);
  std::vector<double> first = test::random_vector(a.n()), again = first;
  solver->factorise(a.values);
  solver->solve(first);
  solver->factorise(b.values);
  solver->factorise(a.values);
  solver->solve(again);
  EXPECT_EQ(first, again);
}

}  // namespace
}  // namespace brachium::fem
