// Values from elsewhere: closed forms under uniaxial stretch, and solutions that FEBio publishes for its own
// tests.

#include <gtest/gtest.h>

#include <cmath>

#include "fem/material/parameter_sets.hpp"
#include "laws_under_test.hpp"

namespace brachium::fem::test {
namespace {

/// Nominal stress along the fibre of an incompressible bar with traction-free sides: P = lambda (S11 - S22
/// C22/C11).
double uniaxial(const Material& material, double stretch, double activation) {
  Case c{"bar", material, activation};
  const Matrix3d C = Vector3d(stretch * stretch, 1 / stretch, 1 / stretch).asDiagonal();
  const auto r = respond(c, C, Vector3d::UnitX());
  return stretch * (r.S[0] - r.S[1] * C(1, 1) / C(0, 0));
}

// (c1 + c2/l) 2 (l - l^-2) and c3/l (l^c4 - 1), tabulated in kPa for sprenger_muscle.
TEST(SprengerMuscle, GivesTheTabulatedUniaxialStresses) {
  struct Row {
    double stretch, isotropic_kpa, isotropic_digit, passive_kpa, passive_digit;
  };
  const Row rows[] = {{1.1, 21.422, 1e-3, 2e-5, 1e-5},
                      {1.2, 39.295, 1e-3, 0.00141, 1e-5},
                      {1.3, 54.701, 1e-3, 0.0573, 1e-4},
                      {1.4, 68.342, 1e-3, 1.766, 1e-3},
                      {1.5, 80.685, 1e-3, 42.994, 1e-3}};
  MuscleTendon whole = muscle_tendon_named("sprenger");
  MuscleTendon ground = whole;
  ground.muscle.c3_pa = 0.0;
  for (const Row& row : rows) {
    const double isotropic = uniaxial(ground, row.stretch, 0.0);
    EXPECT_NEAR(isotropic / 1e3, row.isotropic_kpa, 0.51 * row.isotropic_digit) << row.stretch;
    EXPECT_NEAR((uniaxial(whole, row.stretch, 0.0) - isotropic) / 1e3, row.passive_kpa,
                0.51 * row.passive_digit)
        << row.stretch;
  }
}

TEST(MuscleTendonLaw, HasTheClosedFormOfABarAtAnyStretchAndActivation) {
  for (ActiveStress convention : {ActiveStress::nominal, ActiveStress::cauchy}) {
    MuscleTendon m = muscle_tendon_named("sprenger");
    m.active_stress = convention;
    for (double l = 0.8; l < 1.61; l += 0.1) {
      for (double alpha : {0.0, 0.25, 1.0}) {
        const double x = l / 1.4 - 1.0;
        const double f = x <= 0 ? std::exp(-std::pow(-x / 0.57, 4)) : std::exp(-std::pow(x / 0.14, 3));
        const double passive = l >= 1 ? m.muscle.c3_pa / l * (std::pow(l, m.muscle.c4) - 1) : 0.0;
        const double active = alpha * 0.3e6 * f / (convention == ActiveStress::nominal ? 1.0 : l);
        const double isotropic = 2 * (l - 1 / (l * l)) * (m.muscle.c1_pa + m.muscle.c2_pa / l);
        const double expected = isotropic + passive + active;
        EXPECT_NEAR(uniaxial(m, l, alpha), expected, 1e-12 * (std::abs(isotropic) + passive + active));
      }
    }
  }
}

// Fibre stress at 1.1 [MPa] with sprenger: tendon 28, in between 73 and 77 when parameters are blended, 6 at
// .99.
TEST(MuscleTendonLaw, IsStifferThanTendonBetweenTheTissuesOnlyIfParametersAreBlended) {
  MuscleTendon m = muscle_tendon_named("sprenger");
  const auto fibre_stress = [&](double gamma) {
    Case c{"", m, 0.0, gamma};
    MuscleTendon ground = m;
    ground.muscle.c3_pa = ground.tendon.c3_pa = 0.0;
    const Case g{"", ground, 0.0, gamma};
    const Matrix3d C = Vector3d(1.21, 1 / 1.1, 1 / 1.1).asDiagonal();
    return 1.1 * (respond(c, C, Vector3d::UnitX()).S[0] - respond(g, C, Vector3d::UnitX()).S[0]) / 1e6;
  };
  EXPECT_NEAR(fibre_stress(0.0), 28.0, 0.5);
  EXPECT_NEAR(fibre_stress(0.5), 14.0, 0.3);
  m.blending = Blending::parameters;
  EXPECT_NEAR(fibre_stress(0.0), 28.0, 0.5);
  EXPECT_NEAR(fibre_stress(0.5), 73.0, 0.5);
  EXPECT_NEAR(fibre_stress(0.75), 77.0, 0.5);
  EXPECT_NEAR(fibre_stress(0.99), 6.0, 0.5);
}

// A muscle-tendon interface at rest bears no stress on either side, so that no pressure has to jump.
TEST(MuscleTendonLaw, IsFreeOfStressAtRestForEveryBlend) {
  const MuscleTendon m = muscle_tendon_named("sprenger");
  for (double gamma : {0.0, 0.3, 1.0}) {
    const auto r = respond({"", m, 0.0, gamma}, Matrix3d::Identity(), Vector3d::UnitZ());
    for (double s : r.S) EXPECT_LT(std::abs(s), 1e-9);  // of 5e6 Pa
  }
}

/// FEBio's test problem: Blemker's muscle with U = k/2 (ln J)^2, stretched along the fibre with free sides.
struct FreeSides {
  double lateral = 0.0;
  double cauchy_pa = 0.0;
};

FreeSides stretch_with_free_sides(const BlemkerMuscle& law, double k, double stretch, double activation) {
  const Case c{"", law, activation};
  double y = 1.0 / std::sqrt(stretch);
  const auto side = [&](double l, double& along) {
    const Matrix3d C = Vector3d(stretch * stretch, l * l, l * l).asDiagonal();
    const auto r = respond(c, C, Vector3d::UnitX());
    const double J = stretch * l * l, p = k * std::log(J) / J;
    along = stretch * stretch * r.S[0] / J + p;
    return l * l * r.S[1] / J + p;
  };
  double along = 0.0;
  for (int i = 0; i < 30; ++i) {
    const double h = 1e-7, s = side(y, along);
    y -= s * 2 * h / (side(y + h, along) - side(y - h, along));
  }
  side(y, along);
  return {y, along};
}

TEST(BlemkerMuscleLaw, GivesWhatFebioGivesForAStretchedHexahedron) {
  const BlemkerMuscle law{500.0, 500.0, 0.05, 6.6, 1.0, 3e5, 1.4};
  const FreeSides found = stretch_with_free_sides(law, 1e7, 1.2, 0.0);
  EXPECT_NEAR(found.lateral, 0.9136177286, 1e-9);
  EXPECT_NEAR(found.cauchy_pa, 48984.424, 1e-3);
  // the four nodes of the free faces move in y, four in z; two have both
  EXPECT_NEAR(std::sqrt(8.0) * (1.0 - found.lateral), 0.244325959214, 1e-9);
}

}  // namespace
}  // namespace brachium::fem::test
