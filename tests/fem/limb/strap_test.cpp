#include "fem/limb/strap.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "data/model/error.hpp"
#include "fem/limb/upper_limb.hpp"

namespace brachium::fem {
namespace {

// Incompressible and uniaxial, sides free: P = 2 (l - l^-2)(c1 + c2/l) + c3/l (l^c4 - 1) + a s f_l.
double closed_form_pa(const MuscleTendon& m, double l, double activation) {
  double p = 2.0 * (l - 1.0 / (l * l)) * (m.muscle.c1_pa + m.muscle.c2_pa / l);
  if (l > 1.0) p += m.muscle.c3_pa / l * (std::pow(l, m.muscle.c4) - 1.0);
  const ForceLength& f = m.force_length;
  const double x = l / f.optimal_stretch - 1.0;
  const double width = x <= 0.0 ? f.ascending_width : f.descending_width;
  const double exponent = x <= 0.0 ? f.ascending_exponent : f.descending_exponent;
  return p + activation * m.max_stress_pa * std::exp(-std::pow(std::abs(x) / width, exponent));
}

TEST(Strap, HasTheUniaxialStressOfTheContinuumsLaw) {
  const MuscleTendon law = generic_arm().biceps.material;
  for (const double stretch : {0.8, 1.0, 1.2, 1.4, 1.5}) {
    for (const double activation : {0.0, 0.3, 1.0}) {
      const double expected = closed_form_pa(law, stretch, activation);
      EXPECT_NEAR(uniaxial_stress_pa(law, stretch, activation), expected, 1e-12 * law.max_stress_pa)
          << stretch << ", " << activation;
    }
  }
}

TEST(Strap, AreaIsTheVolumeOverTheLength) {
  MuscleBody cone = generic_arm().biceps;
  cone.profile_m = {0.01, 0.02, 0.03};
  cone.flatness = 1.5;
  // A truncated cone: pi/3 (r1^2 + r1 r2 + r2^2).
  EXPECT_NEAR(mean_area_m2(cone), 1.5 * std::numbers::pi / 3.0 * (1e-4 + 3e-4 + 9e-4), 1e-12);
}

TEST(Strap, IsAsLongAsThePreStretchSaysAtTheReferenceAngle) {
  const MuscleBody biceps = generic_arm().biceps;
  EXPECT_NEAR(strap_stretch(biceps, biceps.reference_rad), biceps.pre_stretch, 1e-14);
  const double longer =
      (CablePath(biceps.cable, 1.0).length_m() - CablePath(biceps.cable, biceps.reference_rad).length_m()) /
      biceps.belly_length_m;
  EXPECT_NEAR(strap_stretch(biceps, 1.0), biceps.pre_stretch + longer, 1e-14);
}

TEST(Strap, RefusesMeshedTendons) {
  MuscleBody complex = generic_arm().biceps;
  complex.tendon_origin_m = 0.02;
  EXPECT_THROW(strap_force_n(complex, 1.0, 0.0), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
