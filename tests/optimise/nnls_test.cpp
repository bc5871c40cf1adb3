#include "optimise/nnls.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixXd matrix() {
  MatrixXd A(12, 5);
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 5; ++j) A(i, j) = std::cos(1.3 * i * (j + 1) + 0.7 * j) + 0.1 * j;
  return A;
}

VectorXd data_vector() {
  VectorXd b(12);
  for (int i = 0; i < 12; ++i) b[i] = std::sin(0.9 * i) - 0.4 * std::cos(1.3 * i) + 0.1;
  return b;
}

TEST(NonNegativeLeastSquares, EqualsScipy) {  // reference_nnls.py
  const LinearFit fit = nnls(matrix(), data_vector());
  const double expected[] = {0.08866649738718771, 0.0035677156146892157, 0.0, 1.0919298641772366,
                             0.4129046531473021};
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(fit.x[j], expected[j], 1e-13);
  EXPECT_NEAR(fit.residual_norm, 1.134102890229996, 1e-13);
}

TEST(BoundedLeastSquares, EqualsScipy) {  // reference_nnls.py
  const LinearFit fit = bounded_least_squares(matrix(), data_vector(), VectorXd::Constant(5, -0.1),
                                              VectorXd::Constant(5, 0.15));
  const double expected[] = {-0.1, 0.05459529185010928, 0.045045837652702966, 0.15, -0.019254908262129306};
  for (int j = 0; j < 5; ++j) EXPECT_NEAR(fit.x[j], expected[j], 1e-12);
  EXPECT_NEAR(fit.residual_norm, 2.363498102752751, 1e-12);
}

TEST(BoundedLeastSquares, MeetsTheOptimalityConditionsOnTwoHundredProblems) {
  for (int k = 0; k < 200; ++k) {
    MatrixXd A(9, 6);
    VectorXd b(9);
    for (int i = 0; i < 9; ++i) {
      b[i] = 3.0 * std::sin(12.9898 * (i + 1) * (k + 1));
      for (int j = 0; j < 6; ++j) A(i, j) = std::sin(78.233 * (i + 1) + 37.719 * (j + 1) * (k + 1));
    }
    const VectorXd lower = VectorXd::Constant(6, -0.5), upper = VectorXd::Constant(6, 0.7);
    const VectorXd x = bounded_least_squares(A, b, lower, upper).x, g = A.transpose() * (A * x - b);
    for (int j = 0; j < 6; ++j) {
      EXPECT_TRUE(x[j] >= -0.5 && x[j] <= 0.7);
      // The gradient vanishes inside, and points outward at a bound.
      const double downhill = x[j] == -0.5 ? std::min(g[j], 0.0) : (x[j] == 0.7 ? std::max(g[j], 0.0) : g[j]);
      EXPECT_NEAR(downhill, 0.0, 1e-9) << "problem " << k;
    }
  }
}

TEST(BoundedLeastSquares, RefusesWhatIsNotFiniteOrDoesNotFit) {
  EXPECT_THROW(nnls(matrix(), VectorXd::Zero(3)), data::InputError);
  EXPECT_THROW(nnls(matrix(), VectorXd::Constant(12, std::nan(""))), data::InputError);
}

}  // namespace
}  // namespace brachium::optimise
