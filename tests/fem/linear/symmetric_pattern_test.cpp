#include "fem/linear/symmetric_pattern.hpp"

#include "data/model/error.hpp"
#include "fem/linear/refinement.hpp"
#include "tests/fem/linear/sparse_matrices.hpp"

namespace brachium::fem {
namespace {

void expect_rejected(const SymmetricPattern& pattern, const std::string& text) {
  try {
    check(pattern);
    FAIL() << text;
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().code, "linear-pattern");
    EXPECT_THAT(error.diagnostics().front().message, ::testing::HasSubstr(text));
  }
}

TEST(SymmetricPattern, RejectsWhatIsNotALowerTriangleAndNamesTheColumn) {
  expect_rejected({}, "`0` unknowns");
  expect_rejected({2, {0, 1}, {0}}, "column starts");
  expect_rejected({2, {0, 1, 3}, {0, 1}}, "column starts");
  expect_rejected({2, {0, 1, 2}, {0, 0}}, "column 1");              // above the diagonal
  expect_rejected({2, {0, 0, 1}, {1}}, "column 0");                 // no diagonal
  expect_rejected({3, {0, 3, 4, 5}, {0, 2, 1, 1, 2}}, "column 0");  // rows descend
  expect_rejected({2, {0, 2, 3}, {0, 2, 1}}, "column 0");           // beyond the matrix
  EXPECT_NO_THROW(check({2, {0, 2, 3}, {0, 1, 1}}));
}

TEST(SymmetricPattern, ExpandsToTheFullMatrixAndMultipliesAsEigenDoes) {
  const test::Matrix m = test::hex27_grid(2, 1, 1, 3, 10);
  const Eigen::SparseMatrix<double> reference = m.eigen();
  const FullPattern full = expand(m.pattern);
  ASSERT_EQ(full.column_start.back(), reference.nonZeros());
  for (int e = 0; e < reference.nonZeros(); ++e) {
    EXPECT_EQ(full.row[e], reference.innerIndexPtr()[e]);
    EXPECT_EQ(m.values[full.source[e]], reference.valuePtr()[e]);
  }
  const std::vector<double> x = test::random_vector(m.n());
  std::vector<double> y(x.size());
  multiply(m.view(), x, y);
  const Eigen::VectorXd expected = reference * Eigen::Map<const Eigen::VectorXd>(x.data(), m.n());
  for (int i = 0; i < m.n(); ++i) EXPECT_NEAR(y[i], expected[i], 1e-13 * expected.norm());
  EXPECT_THROW(multiply(m.view(), std::span(x).first(3), y), data::InputError);
}

TEST(Refinement, WinsBackWhatAFactorOfANearbyMatrixLacks) {
  const test::Matrix m = test::hex27_grid(2, 2, 1);
  std::vector<double> nearby = m.values;
  for (double& v : nearby) v *= 1.0 + 1e-5 * std::sin(1e3 * v);
  const auto solver = make_symmetric_solver("ldl");
  solver->analyse(m.pattern, m.groups);
  solver->factorise(nearby);
  const std::vector<double> b = test::random_vector(m.n());
  std::vector<double> x(b.size());
  const Refinement none = solve_refined(*solver, m.view(), b, x, 0.0, 0);
  const Refinement five = solve_refined(*solver, m.view(), b, x);
  EXPECT_EQ(none.steps, 0);
  EXPECT_GT(none.backward_error, 1e-9);
  EXPECT_LT(five.backward_error, 1e-14);
}

}  // namespace
}  // namespace brachium::fem
