#include "data/limb/muscle_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "data/model/error.hpp"

namespace {
using namespace brachium;
using data::PathGeometry;

constexpr double degree = std::numbers::pi / 180.0;

data::Coordinate elbow(double lower_deg = 0.0, double upper_deg = 150.0) {
  data::Coordinate c;
  c.name = "elbow_flexion";
  c.lower_rad = lower_deg * degree;
  c.upper_rad = upper_deg * degree;
  return c;
}

// A single-joint path with a closed form: origin at distance a above the hinge, insertion at distance b on
// the forearm, L^2 = a^2 + b^2 + 2 a b cos q (q = 0 straight), r = -dL/dq = a b sin(q) / L.
struct StraightPath {
  double a = 0.30, b = 0.04;
  double length(double q) const { return std::sqrt(a * a + b * b + 2.0 * a * b * std::cos(q)); }
  double arm(double q) const { return a * b * std::sin(q) / length(q); }
  double slope(double q) const { return a * b * std::cos(q) / length(q) + arm(q) * arm(q) / length(q); }
};

PathGeometry table(double step_deg, bool lengths, bool arms) {
  const StraightPath path;
  PathGeometry g;
  g.kind = PathGeometry::Kind::table;
  for (double d = 0.0; d <= 150.0 + 1e-9; d += step_deg) {
    const double q = d * degree;
    g.angle_rad.push_back(q);
    if (lengths) g.length_m.push_back(path.length(q));
    if (arms) g.moment_arm_m.push_back(path.arm(q));
  }
  if (!lengths) {
    g.reference_angle_rad = 90.0 * degree;
    g.reference_length_m = path.length(90.0 * degree);
  }
  return g;
}

struct Errors {
  double length = 0.0, arm = 0.0, slope = 0.0;
};

Errors errors_of(const limb::MusclePath& path) {
  const StraightPath exact;
  Errors e;
  for (int i = 0; i <= 1000; ++i) {
    const double q = std::min(150.0 * degree, 150.0 * degree * i / 1000.0);
    const auto v = path(q);
    e.length = std::max(e.length, std::abs(v.length_m - exact.length(q)));
    e.arm = std::max(e.arm, std::abs(v.moment_arm_m - exact.arm(q)));
    e.slope = std::max(e.slope, std::abs(v.dmoment_arm_dq_m - exact.slope(q)));
  }
  return e;
}

TEST(MusclePath, TablesAtTenDegreesReproduceAStraightLineMuscle) {
  // Largest moment arm 40 mm. A monotone interpolant is flattened where the moment arm peaks: allow it 0.5 %
  // of that, the two others 0.1 %.
  const Errors both = errors_of(limb::MusclePath("M", table(10.0, true, true), elbow()));
  EXPECT_LT(both.length, 1e-7);
  EXPECT_LT(both.arm, 0.001 * 0.04);
  const Errors lengths = errors_of(limb::MusclePath("M", table(10.0, true, false), elbow()));
  EXPECT_LT(lengths.length, 1e-5);
  EXPECT_LT(lengths.arm, 0.001 * 0.04);
  const Errors arms = errors_of(limb::MusclePath("M", table(10.0, false, true), elbow()));
  EXPECT_LT(arms.length, 1e-4);
  EXPECT_LT(arms.arm, 0.005 * 0.04);
}

TEST(MusclePath, HermiteTableConvergesWithFourthOrderInLength) {
  const double coarse = errors_of(limb::MusclePath("M", table(10.0, true, true), elbow())).length;
  const double fine = errors_of(limb::MusclePath("M", table(5.0, true, true), elbow())).length;
  EXPECT_NEAR(std::log2(coarse / fine), 4.0, 0.3);
}

// Largest |r + dL/dq| and |r' - dr/dq| by central differences.
std::pair<double, double> difference_check(const limb::MusclePath& path, double wrong_sign = 1.0) {
  const double h = 1e-5;
  double arm = 0.0, slope = 0.0;
  for (int i = 1; i < 300; ++i) {
    const double q = (0.25 + i * 0.4963) * degree;  // steers clear of the knots, where r' may jump
    arm = std::max(arm, std::abs(wrong_sign * path(q).moment_arm_m +
                                 (path(q + h).length_m - path(q - h).length_m) / (2 * h)));
    slope = std::max(slope, std::abs(path(q).dmoment_arm_dq_m -
                                     (path(q + h).moment_arm_m - path(q - h).moment_arm_m) / (2 * h)));
  }
  return {arm, slope};
}

TEST(MusclePath, MomentArmIsTheNegativeSlopeOfTheLengthAndItsDerivativeIsExact) {
  PathGeometry p;
  p.kind = PathGeometry::Kind::polynomial;
  p.length_m = {0.42, -0.014, -0.0152, 0.0026, 0.00015};
  const limb::MusclePath paths[] = {{"M", table(10.0, true, true), elbow()},
                                    {"M", table(10.0, true, false), elbow()},
                                    {"M", table(10.0, false, true), elbow()},
                                    {"M", p, elbow()}};
  for (const auto& path : paths) {
    const auto [arm, slope] = difference_check(path);
    EXPECT_LT(arm, 1e-9);
    EXPECT_LT(slope, 1e-8);
    EXPECT_GT(difference_check(path, -1.0).first, 1e-2) << "the check must notice r = +dL/dq";
  }
}

TEST(MusclePath, PolynomialMomentArmAloneIsIntegratedFromTheReferenceLength) {
  PathGeometry g;
  g.kind = PathGeometry::Kind::polynomial;
  g.moment_arm_m = {0.014, 0.030, -0.008};
  g.reference_length_m = 0.40;
  g.reference_angle_rad = 0.5;
  const limb::MusclePath path("M", g, elbow());
  EXPECT_NEAR(path(0.5).length_m, 0.40, 1e-15);
  const auto primitive = [](double q) { return 0.014 * q + 0.015 * q * q - 0.008 / 3 * q * q * q; };
  EXPECT_NEAR(path(2.0).length_m, 0.40 - (primitive(2.0) - primitive(0.5)), 1e-15);
  EXPECT_FALSE(path.consistency().both_given);
}

TEST(MusclePath, BatchGivesLengtheningVelocityAgainstTheMomentArm) {
  const limb::MusclePath path("M", table(10.0, true, true), elbow());
  const std::vector<double> q{0.3, 1.0, 2.2}, qdot{1.0, -2.0, 0.5};
  std::vector<double> length(3), arm(3), velocity(3);
  path.evaluate(q, qdot, length, arm, velocity);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(length[i], path(q[i]).length_m);
    EXPECT_EQ(arm[i], path(q[i]).moment_arm_m);
    EXPECT_EQ(velocity[i], -arm[i] * qdot[i]);
  }
}

std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const data::InputError& e) {
    return e.diagnostics().front().code + ": " + e.what();
  }
  return "nothing was thrown";
}

TEST(MusclePath, RefusesAnAngleOutsideTheRange) {
  const limb::MusclePath path("BIClong", table(10.0, true, true), elbow());
  EXPECT_EQ(message_of([&] { path(152.3 * degree); }),
            "angle-out-of-range: angle 152.30 deg is outside the range 0 to 150 deg of coordinate "
            "`elbow_flexion` for which "
            "the geometry of muscle `BIClong` holds");
  EXPECT_EQ(message_of([&] { path(std::numeric_limits<double>::quiet_NaN()); }).substr(0, 35),
            "angle-out-of-range: angle nan deg i");
}

TEST(MusclePath, RefusesLengthAndMomentArmThatContradictEachOther) {
  PathGeometry g = table(10.0, true, true);
  for (double& r : g.moment_arm_m) r = -r;
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
            "inconsistent-geometry: length and moment arm of muscle `BRA` disagree: at 95 deg the moment arm "
            "is -39.85 mm, but "
            "-dL/dq is 39.91 mm; they differ by 79.8 mm, more than 1 mm");
  g = table(10.0, true, true);
  g.moment_arm_m[5] += 0.004;  // a slip in one knot: seen as about half its size in the two means beside it
  EXPECT_THAT(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
              ::testing::StartsWith("inconsistent-geometry"));
  g.consistency_tolerance_m = 0.005;
  const limb::MusclePath tolerated("BRA", g, elbow());
  EXPECT_GT(tolerated.consistency().worst_disagreement_m, 0.0015);
  EXPECT_LT(tolerated.consistency().worst_disagreement_m, 0.003);
  EXPECT_NEAR(tolerated.consistency().worst_angle_rad / degree, 50.0, 5.001);
}

TEST(MusclePath, RefusesTablesThatAreNotTables) {
  PathGeometry g = table(10.0, true, false);
  std::swap(g.angle_rad[3], g.angle_rad[4]);
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
            "bad-geometry: the angles of muscle `BRA` must increase, but 30 deg follows 40 deg");
  g = table(10.0, true, false);
  g.length_m.pop_back();
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
            "bad-geometry: the table of muscle `BRA` has 16 angles but 15 lengths");
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", table(10.0, true, false), elbow(-5.0, 150.0)); }),
            "bad-geometry: the table of muscle `BRA` covers 0 to 150 deg, less than the range -5 to 150 deg "
            "of coordinate "
            "`elbow_flexion`");
  g = table(10.0, true, false);
  g.length_m[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
            "bad-geometry: length entry 3 of muscle `BRA` is not a finite number");
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", PathGeometry{}, elbow()); }),
            "missing-geometry: muscle `BRA` has no geometry");
  g = table(10.0, false, true);
  g.reference_length_m = 0.0;
  EXPECT_EQ(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
            "bad-geometry: muscle `BRA` has a moment arm but neither a length nor a reference length");
  g = table(10.0, false, true);
  g.reference_length_m = 0.005;
  EXPECT_THAT(message_of([&] { limb::MusclePath("BRA", g, elbow()); }),
              ::testing::StartsWith("bad-geometry: muscle `BRA` has a length of -"));
}

}  // namespace
