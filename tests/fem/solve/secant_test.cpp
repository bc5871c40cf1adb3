#include "fem/solve/secant.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

namespace brachium::fem {
namespace {

/// R(x) = A x - b with an "old factor" B: the explicit rank-one updates of Broyden, in full matrices.
TEST(Secant, GivesTheStepsOfBroydensExplicitUpdate) {
  Eigen::Matrix4d A, B;
  A << 5, 1, 0, 0, 1, 6, 2, 0, 0, 2, 7, 1, 0, 0, 1, 4;
  B = A;
  B.diagonal() *= 1.5;
  const Eigen::Vector4d b(1, -2, 3, 0.5);
  const Eigen::Matrix4d B0_inverse = B.inverse();
  Eigen::Vector4d x = Eigen::Vector4d::Zero(), y = x;
  Secant secant;
  for (int k = 0; k < 4; ++k) {
    const Eigen::VectorXd step = secant.step(-B0_inverse * (A * x - b));
    secant.taken(step);
    x += step;
    const Eigen::Vector4d reference = -B.inverse() * (A * y - b);
    y += reference;
    B += (A * y - b) * reference.transpose() / reference.squaredNorm();  // B s = y-difference, full steps
    EXPECT_LT((x - y).norm(), 1e-12 * y.norm()) << "step " << k;
  }
}

TEST(Secant, NeedsFewerStepsThanTheOldFactorAlone) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Random(12, 12);
  A = A * A.transpose() + 12.0 * Eigen::MatrixXd::Identity(12, 12);
  Eigen::MatrixXd B = A;
  B.diagonal() *= 1.4;
  const Eigen::MatrixXd B_inverse = B.inverse();
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(12, -1.0, 1.0);
  const auto count = [&](bool updated) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(12);
    Secant secant;
    for (int k = 0; k < 200; ++k) {
      const Eigen::VectorXd r = A * x - b;
      if (r.norm() < 1e-10) return k;
      Eigen::VectorXd step = -B_inverse * r;
      if (updated) {
        step = secant.step(step);
        secant.taken(step);
      }
      x += step;
    }
    return 200;
  };
  EXPECT_LT(count(true), count(false));
}

}  // namespace
}  // namespace brachium::fem
