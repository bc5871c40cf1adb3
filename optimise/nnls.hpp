#pragma once
/// Linear least squares with non-negative or box-bounded unknowns.

#include <Eigen/Core>

namespace brachium::optimise {

struct LinearFit {
  Eigen::VectorXd x;
  double residual_norm = 0.0;  ///< |A x - b|
  int iterations = 0;
};

/// min |A x - b| subject to x >= 0, by the active-set method of Lawson & Hanson 1974, ch. 23 (NNLS).
/// A m x n. Throws InputError("wrong-size"), ("not-finite"); data::ConvergenceFailure after 30 n changes of
/// the set.
LinearFit nnls(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// min |A x - b| subject to lower <= x <= upper (Stark & Parker 1995, BVLS); bounds may be infinite.
LinearFit bounded_least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                const Eigen::VectorXd& lower, const Eigen::VectorXd& upper);

}  // namespace brachium::optimise
