#include "hill/curve_set.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <utility>

#include "data/model/error.hpp"
#include "tests/hill/finite_difference.hpp"

namespace brachium::hill {
namespace {

using tests::slope_of;

struct Anchor {
  double x, y;
};

TEST(DeGrooteFregly2016Curves, MeetThePublishedAnchors) {
  const DeGrooteFregly2016 set;
  for (const Anchor a : {Anchor{0.5, 0.054112153014},
                         {0.8, 0.836439566115},
                         {1.0, 1.0},
                         {1.2, 0.793689718066},
                         {1.5, 0.226148627897}}) {
    EXPECT_NEAR(set.active(a.x).value, a.y, 1e-11) << a.x;
  }
  for (const Anchor a :
       {Anchor{-1.0, 0.0}, {-0.5, 0.234036393549}, {0.0, 1.0}, {0.5, 1.58842340125}, {1.0, 1.794342963555}}) {
    EXPECT_NEAR(set.velocity(a.x, 0.5).value, a.y, 1e-11) << a.x;
  }
  for (const Anchor a : {Anchor{1.0, 0.01822882382}, {1.2, 0.06940116117}, {1.6, 1.0}})
    EXPECT_NEAR(set.passive(a.x).value, a.y, 1e-11) << a.x;
  EXPECT_NEAR(set.tendon(0.02).value, 0.215568624601, 1e-11);
  EXPECT_NEAR(set.tendon(0.049).value, 1.0, 1e-12);
}

TEST(DeGrooteFregly2016Curves, TheWidthsSquareMatters) {
  // The supplement prints the Gaussians without the square on the width; at x = 1.2 that is off by 1.4 % of
  // F0.
  const double x = 1.2, b2 = 1.055033428970575, width = 0.162384573599574 + 0.063303448465465 * x;
  const double printed = 0.8150671134243542 * std::exp(-0.5 * (x - b2) * (x - b2) / width);
  EXPECT_GT(std::abs(printed - DeGrooteFregly2016().active(x).value), 0.01);
}

TEST(Thelen2003Curves, MeetTheAnchorsOfBothParameterSets) {
  const Thelen2003 arm(Thelen2003::arm26());
  EXPECT_NEAR(arm.active(0.5).value, 0.606531, 5e-7);
  EXPECT_NEAR(arm.passive(1.3).value, 0.119203, 5e-7);
  const Thelen2003 standard;
  EXPECT_NEAR(standard.active(0.5).value, 0.573753, 5e-7);
  EXPECT_NEAR(standard.passive(1.3).value, 0.0758582, 5e-8);
  for (const Thelen2003& set : {arm, standard}) {
    EXPECT_NEAR(set.tendon(set.parameters().tendon_strain_at_one_force).value, 1.0, 1e-14);
    EXPECT_NEAR(set.passive(1.6).value, 1.0, 1e-14);
    EXPECT_DOUBLE_EQ(set.active(1.0).value, 1.0);
    EXPECT_DOUBLE_EQ(set.velocity(0.0, 0.3).value, 1.0);
  }
}

// Equations 6 and 7 as printed: v~ from the active force F.
double published_velocity(double F, double a, double fl, const Thelen2003::Parameters& p) {
  const double afl = a * fl;
  const double b = F <= afl ? afl + F / p.velocity_shape
                            : (2.0 + 2.0 / p.velocity_shape) * (afl * p.max_lengthening_force - F) /
                                  (p.max_lengthening_force - 1.0);
  return (0.25 + 0.75 * a) * (F - afl) / b;
}

TEST(Thelen2003Curves, ForceVelocityInvertsThePublishedVelocity) {
  for (const Thelen2003::Parameters& p : {Thelen2003::Parameters(), Thelen2003::arm26()}) {
    const Thelen2003 set(p);
    for (const double a : {0.01, 0.3, 1.0}) {
      for (const double fl : {0.2, 1.0}) {
        for (double multiplier = 0.01; multiplier < 0.95 * p.max_lengthening_force; multiplier += 0.037) {
          const double v = published_velocity(multiplier * a * fl, a, fl, p);
          EXPECT_NEAR(set.velocity(v, a).value, multiplier, 1e-12) << a << ' ' << fl;
        }
      }
    }
  }
}

TEST(Thelen2003Curves, ActiveFibresNeverPush) {
  const Thelen2003 set;
  EXPECT_EQ(set.velocity(-1.5, 1.0).value, 0.0);
  EXPECT_EQ(set.velocity(-0.6, 0.2).value, 0.0);  // k = 0.4
  EXPECT_GT(set.velocity(-0.6, 1.0).value, 0.0);
}

TEST(Millard2012Curves, HaveThePrescribedValuesAndSlopes) {
  const Millard2012 set;
  EXPECT_NEAR(set.active(0.4441).value, 0.1, 1e-14);
  EXPECT_NEAR(set.active(1.0).value, 1.0, 1e-14);
  EXPECT_NEAR(set.active(1.0).slope, 0.0, 1e-12);
  EXPECT_NEAR(set.active(1.8123).value, 0.1, 1e-14);
  EXPECT_NEAR(set.active(0.3).value, 0.1, 1e-14);
  EXPECT_NEAR(set.passive(1.0).value, 0.0, 1e-14);
  EXPECT_NEAR(set.passive(1.7).value, 1.0, 1e-14);
  EXPECT_NEAR(set.passive(1.7).slope, 2.857, 2e-4);
  EXPECT_NEAR(set.tendon(0.0).value, 0.0, 1e-14);
  EXPECT_NEAR(set.tendon(0.049).value, 1.0, 1e-13);
  EXPECT_NEAR(set.tendon(0.049).slope, 28.06, 2e-3);
  EXPECT_NEAR(set.velocity(-1.0, 1.0).value, 0.0, 1e-14);
  EXPECT_NEAR(set.velocity(-1.0, 1.0).slope, 0.0, 1e-14);
  EXPECT_NEAR(set.velocity(-0.9, 1.0).slope, 0.25, 1e-12);
  EXPECT_NEAR(set.velocity(0.0, 1.0).value, 1.0, 1e-14);
  EXPECT_NEAR(set.velocity(0.0, 1.0).slope, 5.0, 1e-12);
  EXPECT_NEAR(set.velocity(0.9, 1.0).slope, 0.15, 1e-12);
  EXPECT_NEAR(set.velocity(1.0, 1.0).value, 1.4, 1e-14);
}

TEST(Millard2012Curves, SolveTheirQuinticToRounding) {
  // A piece whose ends have equal control points in x and y is the line y = x, whatever u(x) is.
  const QuinticBezier line({{0.0, 0.0, 1.0}, {0.4, 0.4, 1.0}, {1.0, 1.0, 1.0}}, 0.9);
  for (double x = 0.0005; x < 1.0; x += 0.0013) {
    EXPECT_NEAR(line(x).value, x, 4e-16 * 4);
    EXPECT_NEAR(line(x).slope, 1.0, 1e-13);
  }
}

// One piece drawn point by point from its control points; the largest errors of value and slope.
struct Drawn {
  double value = 0.0, slope = 0.0;
};
template <class Curve>
Drawn error_against_casteljau(const QuinticBezier::Knot& a, const QuinticBezier::Knot& b, double curviness,
                              const Curve& curve) {
  const double xc = (b.y - a.y - b.x * b.slope + a.x * a.slope) / (a.slope - b.slope),
               yc = a.y + a.slope * (xc - a.x), cut = 0.1 + 0.8 * curviness;
  const auto towards = [cut](double end, double corner) { return end + cut * (corner - end); };
  const std::array<double, 6>
      px = {a.x, towards(a.x, xc), towards(a.x, xc), towards(b.x, xc), towards(b.x, xc), b.x},
      py = {a.y, towards(a.y, yc), towards(a.y, yc), towards(b.y, yc), towards(b.y, yc), b.y};
  // The point and, five times the last difference, its rate.
  const auto casteljau = [](std::array<double, 6> p, double u) {
    for (int level = 5; level > 1; --level) {
      for (int j = 0; j < level; ++j) p[j] += u * (p[j + 1] - p[j]);
    }
    return std::pair{p[0] + u * (p[1] - p[0]), 5.0 * (p[1] - p[0])};
  };
  Drawn worst;
  for (int i = 0; i <= 3000; ++i) {
    const auto [x, dx] = casteljau(px, i / 3000.0);
    const auto [y, dy] = casteljau(py, i / 3000.0);
    const data::CurveValue v = curve(x);
    worst.value = std::max(worst.value, std::abs(v.value - y));
    worst.slope = std::max(worst.slope, std::abs(v.slope - dy / dx));
  }
  return worst;
}

TEST(Millard2012Curves, EqualBezierCurvesDrawnByDeCasteljau) {
  const Millard2012 set;
  // Rounding in x shows in y multiplied by the slope.
  const auto hold = [](const Drawn& error, const char* what, double steepest = 1.0) {
    EXPECT_LT(error.value, 1e-14 * steepest) << what;
    EXPECT_LT(error.slope, 1e-12 * steepest) << what;
  };
  const double foot = 0.1 * 0.7 / 2.0;
  hold(error_against_casteljau({1.0 + foot, 0.1 * foot, 0.2}, {1.7, 1.0, 2.0 / 0.7}, 0.75,
                               [&](double x) { return set.passive(x); }),
       "passive");
  // The sharpest corners there are.
  const double descent = -1.0 / (1.8123 - 1.0 - 2.0 * 0.0259);
  hold(error_against_casteljau({1.0, 1.0, 0.0}, {0.5 * 2.8123, 0.5, descent}, 1.0,
                               [&](double x) { return set.active(x); }),
       "active, descending");
  const auto velocity = [&](double v) {
    const VelocityValue f = set.velocity(v, 1.0);
    return data::CurveValue{f.value, f.slope};
  };
  hold(error_against_casteljau({-0.9, 0.0125, 0.25}, {0.0, 1.0, 5.0}, 0.6, velocity), "shortening");
  hold(error_against_casteljau({0.0, 1.0, 5.0}, {0.9, 1.4 - 0.0075, 0.15}, 0.9, velocity), "lengthening");
  // And one that no muscle has: the guess is a hundred times worse there.
  const QuinticBezier sharp({{0.0, 0.0, 0.0}, {1.0, 2.0, 100.0}}, 1.0);
  hold(error_against_casteljau({0.0, 0.0, 0.0}, {1.0, 2.0, 100.0}, 1.0, sharp), "sharp", 100.0);
}

TEST(Lloyd2003Curves, PassThroughTheirPoints) {
  const Lloyd2003::Table t = Lloyd2003::published();
  for (const auto kind : {Lloyd2003::Interpolant::monotone, Lloyd2003::Interpolant::spline}) {
    const Lloyd2003 set(kind);
    for (std::size_t i = 0; i < t.active.x.size(); ++i)
      EXPECT_NEAR(set.active(t.active.x[i]).value, t.active.y[i], 1e-14);
    for (std::size_t i = 0; i < t.passive.x.size(); ++i)
      EXPECT_NEAR(set.passive(t.passive.x[i]).value, t.passive.y[i], 1e-14);
    for (std::size_t i = 0; i < t.velocity.x.size(); ++i)
      EXPECT_NEAR(set.velocity(t.velocity.x[i], 1.0).value, t.velocity.y[i], 1e-14);
    for (std::size_t i = 0; i < t.tendon.x.size(); ++i)
      EXPECT_NEAR(set.tendon(t.tendon.x[i]).value, t.tendon.y[i], 1e-11);
  }
}

TEST(Lloyd2003Curves, AreTheInterpolantsOfTheModelFolderToTheLastBit) {
  const Lloyd2003::Table t = Lloyd2003::published();
  const Lloyd2003 monotone, spline(Lloyd2003::Interpolant::spline);
  const auto compare = [](const Lloyd2003::Points& points, double from, double to, const auto& a,
                          const auto& b) {
    const auto pa = data::PiecewiseCubic::monotone(points.x, points.y),
               pb = data::PiecewiseCubic::forsythe(points.x, points.y);
    for (int i = 0; i <= 4001; ++i) {
      // Also exactly at knots, and outside.
      const double x = i < 4000 ? from + (to - from) * i / 3999.0
                                : points.x[static_cast<std::size_t>(i) % points.x.size()];
      EXPECT_EQ(a(x).value, pa(x).value) << x;
      EXPECT_EQ(a(x).slope, pa(x).slope) << x;
      EXPECT_EQ(b(x).value, pb(x).value) << x;
      EXPECT_EQ(b(x).slope, pb(x).slope) << x;
    }
  };
  compare(
      t.active, -6.0, 6.0, [&](double x) { return monotone.active(x); },
      [&](double x) { return spline.active(x); });
  compare(
      t.active, 0.39, 1.63, [&](double x) { return monotone.active(x); },
      [&](double x) { return spline.active(x); });
  compare(
      t.passive, 0.99, 1.61, [&](double x) { return monotone.passive(x); },
      [&](double x) { return spline.passive(x); });
  compare(
      t.velocity, -11.0, 11.0, [&](double x) { return monotone.velocity(x, 1.0); },
      [&](double x) { return spline.velocity(x, 1.0); });
  compare(
      t.tendon, -0.01, 0.02, [&](double x) { return monotone.tendon(x); },
      [&](double x) { return spline.tendon(x); });
  compare(
      t.tendon, -11.0, 21.0, [&](double x) { return monotone.tendon(x); },
      [&](double x) { return spline.tendon(x); });
}

TEST(Lloyd2003Curves, OnlyTheSplineOvershoots) {
  const Lloyd2003 monotone, spline(Lloyd2003::Interpolant::spline);
  double lowest_monotone = 0.0, lowest_spline = 0.0;
  for (double x = 0.0; x < 2.2; x += 0.001) {
    lowest_monotone = std::min(lowest_monotone, monotone.active(x).value);
    lowest_spline = std::min(lowest_spline, spline.active(x).value);
  }
  EXPECT_EQ(lowest_monotone, 0.0);
  EXPECT_LT(lowest_spline, -1e-4);
}

TEST(Guenther2007Curves, AreABellWithTwoFlanks) {
  const Guenther2007 set;
  EXPECT_EQ(set.active(1.0).value, 1.0);
  EXPECT_NEAR(set.active(1.0 - 0.57).value, std::exp(-1.0), 1e-15);
  EXPECT_NEAR(set.active(1.0 + 0.14).value, std::exp(-1.0), 1e-15);
  EXPECT_NEAR(set.active(1.0 - 0.285).value, std::exp(-0.0625), 1e-15);
  EXPECT_NEAR(set.active(1.0 + 0.07).value, std::exp(-0.125), 1e-15);
  const DeGrooteFregly2016 lender;
  EXPECT_STREQ(Guenther2007::kBorrowed, lender.name());
  EXPECT_EQ(set.passive(1.3).value, lender.passive(1.3).value);
  EXPECT_EQ(set.velocity(-0.3, 1.0).value, lender.velocity(-0.3, 1.0).value);
  EXPECT_EQ(set.tendon(0.03).value, lender.tendon(0.03).value);
}

class EverySet : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Curves, EverySet, ::testing::ValuesIn(CurveSet::names()),
                         [](const auto& set) { return set.param; });

// Points away from the kinks of the piecewise sets.
constexpr double kLengths[] = {0.4733, 0.5771, 0.6913, 0.8137, 0.9513,
                               1.0377, 1.1291, 1.2731, 1.4133, 1.5577};
constexpr double kVelocities[] = {-0.9513, -0.7719, -0.4417, -0.2123, -0.0517,
                                  0.0531,  0.2153,  0.4477,  0.7711,  0.9211};
constexpr double kStrains[] = {0.0007, 0.0021, 0.0077, 0.0133, 0.0197, 0.0311, 0.0443};

// The whole comparison, so that a wrong slope can be shown to fail it.
template <class Change>
double worst_slope_error(const CurveSet& set, const Change& change) {
  double worst = 0.0;
  const auto hold = [&](double analytic, double numeric) {
    worst = std::max(worst, std::abs(change(analytic) - numeric) / std::max(1.0, std::abs(numeric)));
  };
  const double h = 2e-5;
  for (const double x : kLengths) {
    hold(set.active(x).slope, slope_of([&](double t) { return set.active(t).value; }, x, h));
    hold(set.passive(x).slope, slope_of([&](double t) { return set.passive(t).value; }, x, h));
  }
  for (const double v : kVelocities) {
    for (const double a : {0.2, 0.9}) {
      hold(set.velocity(v, a).slope, slope_of([&](double t) { return set.velocity(t, a).value; }, v, h));
      hold(set.velocity(v, a).slope_activation,
           slope_of([&](double t) { return set.velocity(v, t).value; }, a, h));
    }
  }
  for (const double e : kStrains)
    hold(set.tendon(e).slope, slope_of([&](double t) { return set.tendon(t).value; }, e, 0.1 * h));
  return worst;
}

TEST_P(EverySet, SlopesAreThoseOfTheValues) {
  const CurveSet set = CurveSet::named(GetParam());
  EXPECT_LT(worst_slope_error(set, [](double s) { return s; }), 2e-9);
}

TEST_P(EverySet, AWrongSlopeIsFound) {
  const CurveSet set = CurveSet::named(GetParam());
  EXPECT_GT(worst_slope_error(set, [](double s) { return 1.0001 * s; }), 5e-5);
}

TEST_P(EverySet, IsNormalisedAndOrdered) {
  const CurveSet set = CurveSet::named(GetParam());
  EXPECT_EQ(set.name(), GetParam());
  EXPECT_NEAR(set.active(1.0).value, 1.0, 0.02);  // the points of Lloyd & Besier peak at 1.045
  EXPECT_NEAR(set.velocity(0.0, 1.0).value, 1.0, 1e-12);
  EXPECT_NEAR(set.tendon(0.0).value, 0.0, 1e-15);
  const double step =
      GetParam() == "lloyd_2003_spline" ? 0.1 : 0.01;  // its points are in order, not what lies between
  for (double v = -1.0; v < 0.99; v += step)
    EXPECT_LE(set.velocity(v, 1.0).value, set.velocity(v + step, 1.0).value + 1e-12) << v;
  for (double e = 0.0; e < 0.05; e += 0.001)
    EXPECT_LE(set.tendon(e).value, set.tendon(e + 0.001).value + 1e-12) << e;
  const CurveDomains d = set.domains();
  for (const data::Domain& domain : {d.active, d.passive, d.velocity, d.tendon})
    EXPECT_LT(domain.lower, domain.upper);
  EXPECT_TRUE(d.active.contains(1.0));
  EXPECT_TRUE(d.velocity.contains(0.0));
  EXPECT_TRUE(d.tendon.contains(0.0));
}

TEST(CurveSet, AnUnknownNameGetsTheNearest) {
  try {
    CurveSet::named("thelen_2013");
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].code, "unknown-curve-set");
    EXPECT_EQ(e.diagnostics()[0].message, "`thelen_2013` is not a set of muscle curves");
    EXPECT_EQ(e.diagnostics()[0].help, "did you mean `thelen_2003`?");
  }
}

TEST(CurveSet, ParametersOutsideTheirRangeAreAllNamed) {
  Thelen2003::Parameters p;
  p.active_width = std::nan("");
  p.max_lengthening_force = 1.0;
  try {
    Thelen2003 set(p);
    FAIL();
  } catch (const data::InputError& e) {
    ASSERT_EQ(e.diagnostics().size(), 3u);
    EXPECT_EQ(e.diagnostics()[0].message, "`active_width` of curve set `thelen_2003` is nan");
    EXPECT_EQ(e.diagnostics()[1].message, "`max_lengthening_force` of curve set `thelen_2003` is 1");
    EXPECT_EQ(e.diagnostics()[1].help, "it must be above 1");
  }
  EXPECT_THROW(DeGrooteFregly2016({0.6, 4.0, -0.049}), data::InputError);
  EXPECT_THROW(Guenther2007({0.57, 1.0, 0.14, 3.0}), data::InputError);
  Millard2012::Parameters m;
  m.active_transition_length = 0.4;
  EXPECT_THROW(Millard2012{m}, data::InputError);
}

}  // namespace
}  // namespace brachium::hill
