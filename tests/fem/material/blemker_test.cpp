// Blemker's muscle where its invariants vanish and where its fibres begin to bear: B1 and B2 are 0 at rest
// and in every stretch along the fibres, and B2 = acosh w has no slope there, though B2^2 has.

#include <gtest/gtest.h>

#include <cmath>

#include "laws_under_test.hpp"

namespace brachium::fem::test {
namespace {

constexpr double G1 = 500.0, G2 = 700.0;

/// Fibres that are slack up to 1.2: W = G1 B1^2 + G2 B2^2 around rest.
Case slack() {
  return {"slack", BlemkerMuscle{G1, G2, 0.05, 6.6, 1.2, 3e5, 1.4}};
}

// Small strains e: B1^2 = 4 (e_12^2 + e_13^2), B2^2 = (e_22 - e_33)^2 + 4 e_23^2, fibres along x.
TEST(BlemkerMuscleLaw, HasItsShearModuliAtRest) {
  const MaterialResponse<double> r = respond(slack(), Matrix3d::Identity(), Vector3d::UnitX());
  EXPECT_NEAR(r.CC[upper(3, 3)], 2.0 * G1, 1e-9 * G1) << "along the fibres";
  EXPECT_NEAR(r.CC[upper(5, 5)], 2.0 * G1, 1e-9 * G1);
  EXPECT_NEAR(r.CC[upper(4, 4)], 2.0 * G2, 1e-9 * G2) << "across";
  EXPECT_NEAR(r.CC[upper(1, 1)] - r.CC[upper(1, 2)], 4.0 * G2, 1e-9 * G2);
}

// B2 by its definition: the rest of the state is a shear across the fibres, w = cosh(2 shear).
TEST(BlemkerMuscleLaw, FollowsItsSeriesAndItsClosedFormWhereTheyMeet) {
  for (const double shear : {1e-9, 1e-6, 1e-3, 0.1, 0.1571, 0.1573, 0.2, 0.5}) {  // w - 1 = 0.05 at 0.1574...
    const Matrix3d C = Vector3d(1.0, std::exp(2.0 * shear), std::exp(-2.0 * shear)).asDiagonal();
    const MaterialResponse<double> r = respond(slack(), C, Vector3d::UnitX());
    EXPECT_NEAR(r.energy, G2 * 4.0 * shear * shear, 1e-12 * G2) << shear;
    // S_22 = (dW/d ln stretch)/stretch^2 = 4 G2 shear/C_22, at constant volume
    EXPECT_NEAR(r.S[1] * C(1, 1) - r.S[2] * C(2, 2), 8.0 * G2 * shear, 1e-11 * G2) << shear;
  }
}

TEST(BlemkerMuscleLaw, HasASmoothTangentWhereItsInvariantsVanish) {
  Matrix3d A;
  A << 0.3, 0.2, -0.1, 0.2, -0.5, 0.4, -0.1, 0.4, 0.2;
  const double along = 1.1;
  const Matrix3d stretched = Vector3d(along * along, 1.0 / along, 1.0 / along).asDiagonal();
  for (const Matrix3d& C : {Matrix3d(Matrix3d::Identity()), stretched}) {
    for (const double away : {0.0, 1e-9, 1e-6, 1e-3}) {
      const Matrix3d at = C + away * A;
      const MaterialResponse<double> r = respond(slack(), at, Vector3d::UnitX());
      for (const Matrix3d& B : {A, Matrix3d(A * A)}) {
        const double h = 1e-4;
        const auto S = [&](double x) { return tensor(respond(slack(), at + x * B, Vector3d::UnitX()).S); };
        const Matrix3d found = 2.0 * (8.0 * (S(h) - S(-h)) - (S(2.0 * h) - S(-2.0 * h))) / (12.0 * h);
        EXPECT_LT((apply(r, B) - found).cwiseAbs().maxCoeff(), 1e-7 * G2) << away;
      }
    }
  }
}

// Taut from the slack length on: the slope of the stress to the side on which the fibres bear, whatever
// rounding makes of lambda = 1.
TEST(BlemkerMuscleLaw, IsTautAtItsSlackLength) {
  const Case c{"at rest", BlemkerMuscle{G1, G2, 0.05, 6.6, 1.0, 3e5, 1.4}};
  for (const Vector3d& a0 : directions()) {
    const MaterialResponse<double> r = respond(c, Matrix3d::Identity(), a0);
    const Matrix3d B = a0 * a0.transpose();
    const double h = 1e-5;
    const Matrix3d taut = 2.0 * (tensor(respond(c, Matrix3d::Identity() + h * B, a0).S) - tensor(r.S)) / h;
    EXPECT_LT((apply(r, B) - taut).cwiseAbs().maxCoeff(), 1e-4 * taut.cwiseAbs().maxCoeff());
    // 2/3 of a stretch along the fibre keeps the volume; so much of the fibre's stress does.
    EXPECT_NEAR(a0.dot(taut * a0), 4.0 / 9.0 * 0.05 * 6.6 * 3e5, 10.0);
  }
}

}  // namespace
}  // namespace brachium::fem::test
