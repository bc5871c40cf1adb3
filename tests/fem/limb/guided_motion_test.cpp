#include "fem/solve/guided_motion.hpp"

#include <gtest/gtest.h>

namespace brachium::fem {
namespace {

GuidedMotion parabola() {
  GuidedMotion m;
  m.amplitude = Eigen::Vector4d(0.0, 0.5, 1.5, 2.0);
  m.place_m = Eigen::Matrix3Xd::Zero(3, 4);
  m.place_m.row(0) = m.amplitude.array().square().matrix().transpose();
  m.angle_rad = 0.3 * m.amplitude;
  return m;
}

TEST(GuidedMotion, PassesThroughItsPlaces) {
  const GuidedMotion m = parabola();
  for (int i = 0; i < 4; ++i) {
    EXPECT_DOUBLE_EQ(guided_place(m, m.amplitude[i]).place_m.x(), m.place_m(0, i));
    EXPECT_DOUBLE_EQ(guided_place(m, m.amplitude[i]).angle_rad, m.angle_rad[i]);
  }
}

TEST(GuidedMotion, ReproducesAParabolaBetweenInnerKnots) {
  for (double a = 0.5; a <= 1.5; a += 0.1) EXPECT_NEAR(guided_place(parabola(), a).place_m.x(), a * a, 1e-14);
}

TEST(GuidedMotion, ReproducesALineEverywhereAndStaysBeyondItsEnds) {
  for (double a = 0.0; a <= 2.0; a += 0.1) EXPECT_NEAR(guided_place(parabola(), a).angle_rad, 0.3 * a, 1e-15);
  EXPECT_DOUBLE_EQ(guided_place(parabola(), 3.0).angle_rad, 0.6);
}

TEST(GuidedMotion, NamesFaults) {
  EXPECT_EQ(guided_motion_fault(parabola()), "");
  GuidedMotion falling = parabola();
  falling.amplitude[2] = 0.4;
  EXPECT_NE(guided_motion_fault(falling).find("amplitude 2 does not rise"), std::string::npos);
  GuidedMotion moved = parabola();
  moved.centre_m.x() = 0.1;
  EXPECT_NE(guided_motion_fault(moved).find("first entry"), std::string::npos);
  GuidedMotion few = parabola();
  few.angle_rad = Eigen::Vector3d::Zero();
  EXPECT_NE(guided_motion_fault(few).find("4 amplitudes, 4 places and 3 angles"), std::string::npos);
}

}  // namespace
}  // namespace brachium::fem
