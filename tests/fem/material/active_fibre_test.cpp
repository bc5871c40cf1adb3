// The active fibre: its energy against the stress, and the force-velocity factor.

#include <gtest/gtest.h>

#include <cmath>

#include "laws_under_test.hpp"

namespace brachium::fem::test {
namespace {

// A law that is almost nothing but its active fibre.
MuscleTendon bare(const ForceLength& f, ActiveStress convention) {
  MuscleTendon m;
  m.muscle = {1e-60, 0.0, 0.0, 2.0};
  m.tendon = m.muscle;
  m.max_stress_pa = 1.0;
  m.force_length = f;
  m.active_stress = convention;
  return m;
}

double energy(const MuscleTendon& m, double stretch) {
  const Matrix3d C = Vector3d(stretch * stretch, 1, 1).asDiagonal();
  return respond({"", m, 1.0}, C, Vector3d::UnitX()).energy;
}

double bell(const ForceLength& f, double l) {
  const double x = l / f.optimal_stretch - 1;
  return x <= 0 ? std::exp(-std::pow(-x / f.ascending_width, f.ascending_exponent))
                : std::exp(-std::pow(x / f.descending_width, f.descending_exponent));
}

// tanh-sinh rule, which does not mind that the bell is not smooth at the end at lambda_opt.
template <class Function>
double integral(const Function& f, double a, double b) {
  double sum = 0.0;
  const double h = 0.01;
  for (int i = -400; i <= 400; ++i) {
    const double t = i * h, s = M_PI / 2 * std::sinh(t), u = 0.5 * (1 + std::tanh(s));
    const double w = h * M_PI / 4 * std::cosh(t) / (std::cosh(s) * std::cosh(s));
    if (w > 1e-30) sum += w * f(a + (b - a) * u);
  }
  return (b - a) * sum;
}

TEST(ActiveWork, IsTheIntegralOfTheStressToTenDigits) {
  const double exponents[] = {1.2, 1.5, 2.0, 2.5, 3.0, 3.9, 4.0, 5.0, 8.0};
  double worst = 0.0;
  for (ActiveStress convention : {ActiveStress::nominal, ActiveStress::cauchy}) {
    for (double nu : exponents) {
      for (double width : {0.14, 0.3, 0.57}) {
        const ForceLength f{1.2, width, nu, width, nu};
        const MuscleTendon m = bare(f, convention);
        for (double l = 0.4; l < 2.45; l += 0.1) {
          const double expected = integral(
              [&](double s) { return bell(f, s) / (convention == ActiveStress::cauchy ? s : 1.0); }, 1.2, l);
          worst = std::max(worst, std::abs(energy(m, l) - expected));
        }
      }
    }
  }
  EXPECT_LT(worst, 1e-10);
}

TEST(ActiveFibre, HasItsTopAndNoSlopeAtTheOptimalStretch) {
  const MuscleTendon m = bare({1.3, 0.57, 4.0, 0.14, 3.0}, ActiveStress::nominal);
  const Matrix3d C = Vector3d(1.69, 1, 1).asDiagonal();
  const auto r = respond({"", m, 1.0}, C, Vector3d::UnitX());
  EXPECT_NEAR(1.3 * r.S[0], 1.0, 1e-11);             // nominal stress
  EXPECT_NEAR(r.CC[0] * 1.69 + r.S[0], 0.0, 1e-11);  // its slope
  EXPECT_NEAR(r.energy, 0.0, 1e-11);
}

TEST(ActiveFibre, IsNothingFarAwayAndNeverNan) {
  const MuscleTendon m = bare({1.3, 0.57, 10.0, 0.01, 10.0}, ActiveStress::nominal);
  for (double l : {1e-3, 0.1, 5.0, 100.0, 1e6}) {
    const Matrix3d C = Vector3d(l * l, 1, 1).asDiagonal();
    const auto r = respond({"", m, 1.0}, C, Vector3d::UnitX());
    for (double s : r.S) EXPECT_NEAR(s, 0.0, 1e-10) << l;
    for (double s : r.CC) EXPECT_TRUE(std::isfinite(s)) << l;
    EXPECT_TRUE(std::isfinite(r.energy)) << l;
  }
}

// f_v as a ratio of stresses with and without rate.
double force_velocity(double v, double dt = 0.01) {
  MuscleTendon m = bare({1.3, 0.57, 4.0, 0.14, 3.0}, ActiveStress::nominal);
  m.rate_dependent = true;
  m.force_velocity = {8.0, 0.25, 1.5};
  const double l = 1.2, before = l - v * 8.0 * 1.3 * dt;
  const Matrix3d C = Vector3d(l * l, 1, 1).asDiagonal();
  const double rated = respond({"", m, 1.0, 1.0, 0.0, 1 / dt, before}, C, Vector3d::UnitX()).S[0];
  const double still = respond({"", m, 1.0}, C, Vector3d::UnitX()).S[0];
  return rated / still;
}

TEST(ForceVelocityFactor, IsHillsHyperbolaWhenShortening) {
  // (1 + f/k)(v' + k) = k + 1 with v' = -v: Hill's (F + a)(V + b) = (F0 + a) b in units of F0 and vmax
  for (double v : {-0.9, -0.5, -0.25, -0.1, -0.01}) {
    EXPECT_NEAR((force_velocity(v) + 0.25) * (-v + 0.25), 1.25 * 0.25, 1e-10) << v;
  }
  EXPECT_NEAR(force_velocity(-1.0), 0.0, 1e-10);
  EXPECT_NEAR(force_velocity(-1.5), 0.0, 1e-50);
}

TEST(ForceVelocityFactor, RisesSmoothlyToTheEccentricForce) {
  EXPECT_NEAR(force_velocity(0.0), 1.0, 1e-10);
  const double h = 1e-6;
  EXPECT_NEAR((force_velocity(0.0) - force_velocity(-h)) / h, 5.0, 1e-4);
  EXPECT_NEAR((force_velocity(h) - force_velocity(0.0)) / h, 5.0, 1e-4);
  EXPECT_NEAR(force_velocity(0.1), 1.25, 1e-10);  // half way at v = (e - 1)/slope
  EXPECT_NEAR(force_velocity(1000.0, 1e-6), 1.5, 1e-4);
}

TEST(ForceVelocityFactor, IsOneWithoutATimeStep) {
  MuscleTendon m = muscle_tendon();
  const Matrix3d C = gradients()[1].transpose() * gradients()[1];
  const auto still = respond({"", m, 0.7}, C, directions()[0]);
  m.rate_dependent = true;
  m.force_velocity = {5.0, 0.25, 1.5};
  const auto slow = respond({"", m, 0.7, 1.0, 0.0, 0.0, 0.3}, C, directions()[0]);
  for (int i = 0; i < 6; ++i) EXPECT_EQ(still.S[i], slow.S[i]);
}

}  // namespace
}  // namespace brachium::fem::test
