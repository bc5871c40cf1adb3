// What every law owes: tests over laws_under_test.hpp.

#include <gtest/gtest.h>

#include <cmath>

#include "laws_under_test.hpp"

namespace brachium::fem::test {
namespace {

class Law : public testing::TestWithParam<Case> {
 protected:
  static double scale(const MaterialResponse<double>& r) {
    double s = 0.0;
    for (double x : r.CC) s = std::max(s, std::abs(x));
    return s;
  }
};

TEST_P(Law, HasNeitherEnergyNorStressAtRest) {
  Case c = GetParam();
  c.activation = 0.0;
  const MaterialResponse<double> r = respond(c, Matrix3d::Identity(), directions()[1]);
  EXPECT_LT(std::abs(r.energy), 1e-15 * scale(r));
  for (double s : r.S) EXPECT_LT(std::abs(s), 1e-15 * scale(r));
}

// Sixth-order central differences along a direction B of C: error about h^6 and rounding/h.
template <class Function>
auto slope(const Function& f, double h) {
  return ((45.0 / 60.0) * (f(h) - f(-h)) - (9.0 / 60.0) * (f(2 * h) - f(-2 * h)) +
          (1.0 / 60.0) * (f(3 * h) - f(-3 * h))) /
         h;
}

std::vector<Matrix3d> probes() {
  Matrix3d A, B;
  A << 0.5, 0.3, -0.2, 0.3, -0.4, 0.1, -0.2, 0.1, 0.7;
  B << -0.1, -0.5, 0.3, -0.5, 0.8, 0.4, 0.3, 0.4, 0.2;
  return {A, B};
}

// |S : B - 2 dW/dC[B]| / |CC|, the worst of all states. `factor` 1 tells the truth, any other is a wrong
// twin.
double stress_error(const Case& c, double factor) {
  double worst = 0.0;
  for (const Matrix3d& F : gradients()) {
    for (const Vector3d& a0 : directions()) {
      const Matrix3d C = F.transpose() * F;
      const MaterialResponse<double> r = respond(c, C, a0);
      double size = 0.0;
      for (double s : r.S) size = std::max(size, std::abs(s));
      for (const Matrix3d& B : probes()) {
        const double found = 2.0 * slope([&](double h) { return respond(c, C + h * B, a0).energy; }, 1e-3);
        worst = std::max(worst, std::abs((factor * tensor(r.S)).cwiseProduct(B).sum() - found) / size);
      }
    }
  }
  return worst;
}

double tangent_error(const Case& c, double factor) {
  double worst = 0.0;
  for (const Matrix3d& F : gradients()) {
    for (const Vector3d& a0 : directions()) {
      const Matrix3d C = F.transpose() * F;
      const MaterialResponse<double> r = respond(c, C, a0);
      double size = 0.0;
      for (double x : r.CC) size = std::max(size, std::abs(x));
      for (const Matrix3d& B : probes()) {
        const Matrix3d found =
            2.0 * slope([&](double h) -> Matrix3d { return tensor(respond(c, C + h * B, a0).S); }, 1e-3);
        worst = std::max(worst, (factor * apply(r, B) - found).cwiseAbs().maxCoeff() / size);
      }
    }
  }
  return worst;
}

TEST_P(Law, StressIsTheSlopeOfTheEnergy) {
  Case c = GetParam();
  c.inverse_dt = 0.0;  // with a rate there is no potential
  EXPECT_LT(stress_error(c, 1.0), 1e-8);
  EXPECT_GT(stress_error(c, 1.0 + 1e-6), 1e-7);
}

TEST_P(Law, TangentIsTheSlopeOfTheStress) {
  EXPECT_LT(tangent_error(GetParam(), 1.0), 1e-8);
  EXPECT_GT(tangent_error(GetParam(), 1.0 + 1e-6), 1e-7);
}

Matrix3d rotation() {
  return (Eigen::AngleAxisd(0.7, Vector3d(0.3, -0.5, 0.8).normalized()) *
          Eigen::AngleAxisd(1.9, Vector3d::UnitX()))
      .toRotationMatrix();
}

TEST_P(Law, DoesNotSeeARotationOfSpace) {
  for (const Matrix3d& F : gradients()) {
    const Matrix3d QF = rotation() * F;
    const auto r = respond(GetParam(), F.transpose() * F, directions()[1]);
    const auto s = respond(GetParam(), QF.transpose() * QF, directions()[1]);
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(r.S[i], s.S[i], 1e-13 * scale(r));
  }
}

// S(Q C Q', Q a0) = Q S(C, a0) Q': no direction but a0 counts.
TEST_P(Law, TurnsWithTheBody) {
  const Matrix3d Q = rotation();
  for (const Matrix3d& F : gradients()) {
    const Matrix3d C = F.transpose() * F;
    const Vector3d a0 = directions()[2];
    const auto r = respond(GetParam(), C, a0);
    const auto s = respond(GetParam(), Q * C * Q.transpose(), Q * a0);
    EXPECT_LT((tensor(s.S) - Q * tensor(r.S) * Q.transpose()).cwiseAbs().maxCoeff(), 1e-12 * scale(r));
    EXPECT_NEAR(s.energy, r.energy, 1e-12 * scale(r));
    const Matrix3d B = probes()[0];
    EXPECT_LT((apply(s, Q * B * Q.transpose()) - Q * apply(r, B) * Q.transpose()).cwiseAbs().maxCoeff(),
              1e-12 * scale(r));
  }
}

// Rotations of the reference placement about a0, and a0 -> -a0, change nothing but the axes.
TEST_P(Law, IsTransverselyIsotropicOrIsotropic) {
  const bool fibrous = needs_fibres(GetParam().material);
  const Vector3d a0 = directions()[1];
  const Matrix3d Q = fibrous ? Eigen::AngleAxisd(0.83, a0).toRotationMatrix() : rotation();
  for (const Matrix3d& F : gradients()) {
    const Matrix3d C = F.transpose() * F;
    const auto r = respond(GetParam(), C, a0);
    const auto s = respond(GetParam(), Q * C * Q.transpose(), -a0);
    EXPECT_NEAR(s.energy, r.energy, 1e-12 * scale(r));
    EXPECT_LT((tensor(s.S) - Q * tensor(r.S) * Q.transpose()).cwiseAbs().maxCoeff(), 1e-12 * scale(r));
  }
}

// Only 21 entries exist, so major symmetry is kept by the type; the finite differences must have it as well.
TEST_P(Law, DifferencesOfTheStressAreSymmetric) {
  const Matrix3d C = gradients()[1].transpose() * gradients()[1];
  const Vector3d a0 = directions()[1];
  const auto derivative = [&](const Matrix3d& B) -> Matrix3d {
    return slope([&](double h) -> Matrix3d { return tensor(respond(GetParam(), C + h * B, a0).S); }, 1e-3);
  };
  const double ab = derivative(probes()[0]).cwiseProduct(probes()[1]).sum();
  const double ba = derivative(probes()[1]).cwiseProduct(probes()[0]).sum();
  EXPECT_NEAR(ab, ba, 1e-8 * scale(respond(GetParam(), C, a0)));
}

class IsochoricLaw : public Law {};

TEST_P(IsochoricLaw, DoesNotSeeAChangeOfVolume) {
  const Matrix3d C = gradients()[0].transpose() * gradients()[0];
  const auto r = respond(GetParam(), C, directions()[1]);
  const auto s = respond(GetParam(), 1.7 * C, directions()[1]);
  EXPECT_NEAR(s.energy, r.energy, 1e-12 * scale(r));
  EXPECT_NEAR(tensor(r.S).cwiseProduct(C).sum(), 0.0, 1e-12 * scale(r));
}

// Four different points in the lanes.
MaterialPoint<Lanes> pack(const Case& c) {
  MaterialPoint<Lanes> p;
  p.inverse_dt = c.inverse_dt;
  for (int l = 0; l < 4; ++l) {
    const Matrix3d F = gradients()[l];
    Case at = c;
    if (l == 2) at.muscle = 0.5 * c.muscle, at.activation = 0.5 * c.activation;
    const MaterialPoint<double> q = point(at, F.transpose() * F, directions()[l % 3]);
    for (int i = 0; i < 6; ++i) p.C[i][l] = q.C[i];
    for (int i = 0; i < 3; ++i) p.fibre[i][l] = q.fibre[i];
    p.activation[l] = q.activation, p.muscle[l] = q.muscle, p.soft_tissue[l] = q.soft_tissue;
    p.stretch_before[l] = q.stretch_before;
  }
  return p;
}

MaterialPoint<double> unpack(const MaterialPoint<Lanes>& p, int l) {
  MaterialPoint<double> q;
  for (int i = 0; i < 6; ++i) q.C[i] = p.C[i][l];
  for (int i = 0; i < 3; ++i) q.fibre[i] = p.fibre[i][l];
  q.activation = p.activation[l], q.muscle = p.muscle[l], q.soft_tissue = p.soft_tissue[l];
  q.stretch_before = p.stretch_before[l], q.inverse_dt = p.inverse_dt;
  return q;
}

// Against one lane with the C library's exp and log.
double lane_error(const Case& c, InstructionSet set) {
  const MaterialPoint<Lanes> p = pack(c);
  MaterialResponse<Lanes> r;
  evaluate(c.material, set, everything, p, r);
  double worst = 0.0;
  const auto note = [&](double error) { worst = error <= worst ? worst : error; };  // keeps a NaN
  for (int l = 0; l < 4; ++l) {
    MaterialResponse<double> s;
    evaluate(c.material, unpack(p, l), s);
    double size = 0.0;
    for (double x : s.CC) size = std::max(size, std::abs(x));
    note(std::abs(r.energy[l] - s.energy) / size);
    for (int i = 0; i < 6; ++i) note(std::abs(r.S[i][l] - s.S[i]) / size);
    for (int i = 0; i < 21; ++i) note(std::abs(r.CC[i][l] - s.CC[i]) / size);
  }
  return worst;
}

TEST_P(Law, LanesGiveWhatOnePointGives) {
  EXPECT_LT(lane_error(GetParam(), InstructionSet::baseline), 1e-14);
}

TEST_P(Law, Avx2GivesWhatTheBaselineGives) {
  if (!has_avx2()) GTEST_SKIP() << "no AVX2 here";
  EXPECT_LT(lane_error(GetParam(), InstructionSet::avx2), 1e-14);
  const MaterialPoint<Lanes> p = pack(GetParam());
  MaterialResponse<Lanes> a, b;
  evaluate(GetParam().material, InstructionSet::baseline, everything, p, a);
  evaluate(GetParam().material, InstructionSet::avx2, everything, p, b);
  for (int l = 0; l < 4; ++l) {
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(a.S[i][l], b.S[i][l], 1e-13 * std::abs(a.S[0][l]));
  }
}

TEST_P(Law, PartsNotWantedDoNotChangeTheOthers) {
  const MaterialPoint<Lanes> p = pack(GetParam());
  MaterialResponse<Lanes> all;
  evaluate(GetParam().material, InstructionSet::baseline, everything, p, all);
  for (Wanted wanted : {stress_only, with_tangent, with_energy}) {
    MaterialResponse<Lanes> r;
    evaluate(GetParam().material, InstructionSet::baseline, wanted, p, r);
    for (int l = 0; l < 4; ++l) {
      for (int i = 0; i < 6; ++i) EXPECT_EQ(r.S[i][l], all.S[i][l]);
      if (wanted == with_energy) {
        EXPECT_EQ(r.energy[l], all.energy[l]);
      }
      if (wanted == with_tangent) {
        for (int i = 0; i < 21; ++i) EXPECT_EQ(r.CC[i][l], all.CC[i][l]);
      }
    }
  }
}

std::vector<Case> isochoric_cases() {
  std::vector<Case> cases;
  for (const Case& c : all_cases()) {
    if (c.isochoric) cases.push_back(c);
  }
  return cases;
}

std::string name_of(const testing::TestParamInfo<Case>& instance) {
  return instance.param.name;
}

INSTANTIATE_TEST_SUITE_P(All, Law, testing::ValuesIn(all_cases()), name_of);
INSTANTIATE_TEST_SUITE_P(All, IsochoricLaw, testing::ValuesIn(isochoric_cases()), name_of);

}  // namespace
}  // namespace brachium::fem::test
