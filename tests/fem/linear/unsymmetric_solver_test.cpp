#include "fem/linear/unsymmetric_solver.hpp"

#include "data/model/error.hpp"
#include "tests/fem/linear/sparse_matrices.hpp"

namespace brachium::fem {
namespace {

TEST(UnsymmetricSolver, SolvesAMatrixThatIsNotSymmetricAsEigenDoes) {
  const test::Matrix m = test::hex27_grid(2, 2, 1);
  UnsymmetricSolver solver;
  solver.analyse(m.pattern);
  const FullPattern& full = solver.pattern();
  std::vector<double> values(full.row.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int j = 0; j < m.n(); ++j) {
    for (int e = full.column_start[j]; e < full.column_start[j + 1]; ++e) {
      values[e] = m.values[full.source[e]] * (1.0 + 0.2 * std::sin(double(e)));
      entries.emplace_back(full.row[e], j, values[e]);
    }
  }
  Eigen::SparseMatrix<double> a(m.n(), m.n());
  a.setFromTriplets(entries.begin(), entries.end());
  EXPECT_EQ(solver.factorise(values).kind, FactorKind::regular);
  std::vector<double> x = test::random_vector(m.n());
  const Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXd>(x.data(), m.n());
  solver.solve(x);
  const Eigen::SparseLU<Eigen::SparseMatrix<double>> lu(a);
  const Eigen::VectorXd reference = lu.solve(b);
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(x.data(), m.n()) - reference).norm(),
            1e-11 * reference.norm());
}

TEST(UnsymmetricSolver, RejectsWrongSizesAndNamesASingularColumn) {
  const test::Matrix m = test::laplacian(3, 3, 2);
  UnsymmetricSolver solver;
  EXPECT_THROW(solver.factorise(m.values), data::InputError);
  solver.analyse(m.pattern);
  EXPECT_THROW(solver.factorise(m.values), data::InputError);  // those of the lower triangle only
  const FullPattern& full = solver.pattern();
  std::vector<double> values(full.row.size());
  for (std::size_t e = 0; e < values.size(); ++e) values[e] = m.values[full.source[e]];
  for (int e = full.column_start[4]; e < full.column_start[5]; ++e) values[e] = 0.0;
  const FactorStatus status = solver.factorise(values);
  EXPECT_EQ(status.kind, FactorKind::singular);
  EXPECT_EQ(status.zero_unknowns, std::vector<int>{4});
}

}  // namespace
}  // namespace brachium::fem
