// The equivalent static system and its scenarios on the published forces of the Upper Limb Model.

#include "optimise/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "data/model/error.hpp"
#include "fem/surrogate/sparse_spline.hpp"
#include "snapping_system.hpp"
#include "upper_limb_forces.hpp"

namespace brachium::optimise::test {
namespace {

struct Case {
  double triceps, biceps, load, angle_deg;
  double tolerance_deg = 0.3;
};
// Equilibrium angles of the published forces (theory of the model; activations of triceps and biceps, load in
// N).
constexpr Case known[] = {
    {0, 0, 0, 63.9},  {0, 1, 0, 100.5}, {0.5, 0.5, 0, 64.0},       {1, 0, 0, 28.6},        {1, 1, 0, 64.2},
    {0, 0, 22, 48.5}, {0, 1, 22, 83.9}, {0.5, 0.5, 22, 49.5, 1.5}, {1, 0, 22, 21.9, 0.75}, {1, 1, 22, 52.7}};

TEST(StaticSystem, OfThePublishedForcesHasThePublishedEquilibria) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem system = published_system(model);
  for (const Case& c : known) {
    const Equilibria e = equilibria(system, Eigen::Vector2d(c.triceps, c.biceps), c.load);
    ASSERT_EQ(e.all.size(), 1u) << c.triceps << " " << c.biceps << " " << c.load;
    EXPECT_NEAR(e.all[0].angle_rad / deg, c.angle_deg, c.tolerance_deg)
        << c.triceps << " " << c.biceps << " " << c.load;
    EXPECT_TRUE(e.all[0].stable);
    EXPECT_GT(thesis::moment(e.all[0].stiffness_N_m_per_rad), 13.0 - 1.0);
    EXPECT_LT(thesis::moment(e.all[0].stiffness_N_m_per_rad), 63.0 + 1.0);
  }
}

TEST(StaticSystem, HasNoEquilibriumWhereThePublishedForcesHaveNone) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem system = published_system(model);
  for (const Case& c : {Case{0, 0, -60, 0}, Case{0, 1, -60, 0}, Case{1, 0, 180, 0}}) {
    const Equilibria e = equilibria(system, Eigen::Vector2d(c.triceps, c.biceps), c.load);
    EXPECT_TRUE(e.all.empty()) << c.triceps << " " << c.biceps << " " << c.load;
    EXPECT_GT(std::abs(e.nearest_moment_N_m), 0.1);
  }
}

TEST(StaticSystem, MomentsAtFullActivationAndNinetyDegreesAreThePublishedOnes) {
  const fem::SurrogateModel model = published_model();
  const MomentState m = moment_at(published_system(model), 90.0 * deg, Eigen::Vector2d(1, 1), 0.0);
  EXPECT_NEAR(thesis::moment(m.force_N(0) * m.moment_arm_m(0)), 25.26, 0.01);
  EXPECT_NEAR(thesis::moment(m.force_N(1) * m.moment_arm_m(1)), -14.30, 0.01);
}

TEST(StaticSystem, OfTheFortyNineStatesAgrees) {
  const std::string folder = BRACHIUM_REFERENCE_DIR;
  std::ifstream file(folder + "/upper_limb_forces_49.csv");
  if (folder.empty() || !file) GTEST_SKIP() << "the published states are not at hand";
  fem::SampleSet triceps{{"force_n"}, {}}, biceps{{"force_n"}, {}};
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#' || line.starts_with("theta")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    double theta = 0.0, alpha = 0.0, t = 0.0, b = 0.0;
    row >> theta >> alpha >> t >> b;
    triceps.samples.push_back({{theta * deg, alpha}, Eigen::VectorXd::Constant(1, t)});
    biceps.samples.push_back({{theta * deg, alpha}, Eigen::VectorXd::Constant(1, -b)});
  }
  const fem::StateBounds bounds{10.0 * deg, 150.0 * deg, 0.0, 1.0};
  fem::SurrogateMuscle muscles[] = {published_muscle(false, fem::ThetaCurve::cubic),
                                    published_muscle(true, fem::ThetaCurve::cubic)};
  muscles[0].surrogate =
      std::make_shared<fem::Surrogate>(fem::sparse_surrogate(triceps, bounds, fem::SparseBoundary::modified));
  muscles[1].surrogate =
      std::make_shared<fem::Surrogate>(fem::sparse_surrogate(biceps, bounds, fem::SparseBoundary::modified));
  const fem::SurrogateModel model("elbow_flexion", {muscles[0], muscles[1]});
  const StaticSystem system = published_system(model);
  for (const Case& c : known) {
    const Equilibria e = equilibria(system, Eigen::Vector2d(c.triceps, c.biceps), c.load);
    ASSERT_EQ(e.all.size(), 1u);
    // 0.886 deg is the published error; near 20 deg a passive biceps lies in the corner where this choice of
    // states extrapolates in both directions (45 N of 392 N at 10 deg).
    EXPECT_NEAR(e.all[0].angle_rad / deg, c.angle_deg, c.angle_deg < 25.0 ? 1.5 : 0.886)
        << c.triceps << " " << c.biceps << " " << c.load;
  }
  EXPECT_TRUE(equilibria(system, Eigen::Vector2d(1, 0), 180.0).all.empty());
}

// ---------------------------------------------------------------- derivatives

double moment_mismatch(double wrong) {
  const fem::SurrogateModel model = published_model(fem::ThetaCurve::cubic);
  const StaticSystem s = published_system(model);
  const double h = 1e-6, q = 1.1, L = 15.0;
  const Eigen::Vector2d a(0.3, 0.6);
  const MomentState m = moment_at(s, q, a, L);
  const auto M = [&](double dq, double dt, double db, double dl) {
    return moment_at(s, q + dq, a + Eigen::Vector2d(dt, db), L + dl).moment_N_m;
  };
  const double d[] = {wrong * m.dangle_N_m_per_rad - (M(h, 0, 0, 0) - M(-h, 0, 0, 0)) / (2 * h),
                      wrong * m.dactivation_N_m(0) - (M(0, h, 0, 0) - M(0, -h, 0, 0)) / (2 * h),
                      wrong * m.dactivation_N_m(1) - (M(0, 0, h, 0) - M(0, 0, -h, 0)) / (2 * h),
                      wrong * m.dload_m - (M(0, 0, 0, h) - M(0, 0, 0, -h)) / (2 * h)};
  return std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2]), std::abs(d[3])});
}

TEST(StaticSystem, MomentsDerivativesAreRightAndAWrongOneIsFound) {
  EXPECT_LT(moment_mismatch(1.0), 1e-7);
  EXPECT_GT(moment_mismatch(1.001), 1e-3);
}

ScenarioOptions exact() {
  ScenarioOptions options;
  options.relative_tolerance = 1e-13;
  return options;
}

double angle_mismatch(double wrong) {
  const fem::SurrogateModel model = published_model(fem::ThetaCurve::cubic);
  const StaticSystem s = published_system(model);
  const auto angle = [&](double t, double b, double L) {
    return equilibria(s, Eigen::Vector2d(t, b), L, exact()).all.at(0).angle_rad;
  };
  const EquilibriumAngle e = equilibria(s, Eigen::Vector2d(0.4, 0.5), 10.0, exact()).all.at(0);
  const double h = 1e-4;
  return std::max({std::abs(wrong * e.dangle_dactivation_rad(0) -
                            (angle(0.4 + h, 0.5, 10) - angle(0.4 - h, 0.5, 10)) / (2 * h)),
                   std::abs(wrong * e.dangle_dactivation_rad(1) -
                            (angle(0.4, 0.5 + h, 10) - angle(0.4, 0.5 - h, 10)) / (2 * h)),
                   std::abs(wrong * e.dangle_dload_rad_per_N -
                            (angle(0.4, 0.5, 10 + h) - angle(0.4, 0.5, 10 - h)) / (2 * h))});
}

TEST(Equilibria, MoveWithActivationAndLoadAsTheImplicitFunctionSays) {
  EXPECT_LT(angle_mismatch(1.0), 1e-6);
  EXPECT_GT(angle_mismatch(1.001), 3e-4);
}

TEST(HeldAngle, MovesWithAngleLoadAndTheOtherMuscleAsTheImplicitFunctionSays) {
  const fem::SurrogateModel model = published_model(fem::ThetaCurve::cubic);
  const StaticSystem s = published_system(model);
  const auto biceps = [&](double q, double t, double L) {
    return held_angle(s, q, 1, Eigen::Vector2d(t, 0.5), L, exact());
  };
  const HeldAngle at = biceps(1.3, 0.2, 5.0);
  ASSERT_TRUE(at.activation);
  const double h = 1e-5;
  const auto difference = [&](const HeldAngle& high, const HeldAngle& low) {
    return (*high.activation - *low.activation) / (2 * h);
  };
  EXPECT_NEAR(at.dactivation_dangle, difference(biceps(1.3 + h, 0.2, 5), biceps(1.3 - h, 0.2, 5)), 1e-6);
  EXPECT_NEAR(at.dactivation_dload, difference(biceps(1.3, 0.2, 5 + h), biceps(1.3, 0.2, 5 - h)), 1e-6);
  EXPECT_NEAR(at.dactivation_dactivation(0), difference(biceps(1.3, 0.2 + h, 5), biceps(1.3, 0.2 - h, 5)),
              1e-6);
  EXPECT_EQ(at.dactivation_dactivation(1), 0.0);
}

// ---------------------------------------------------------------- position-driven

TEST(HeldAngle, IsTheInverseOfTheEquilibrium) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  for (const double t : {0.0, 0.3, 0.8}) {
    for (const double b : {0.1, 0.7}) {
      const double q = equilibria(s, Eigen::Vector2d(t, b), 0.0, exact()).all.at(0).angle_rad;
      const HeldAngle held = held_angle(s, q, 1, Eigen::Vector2d(t, 0.5), 0.0, exact());
      ASSERT_TRUE(held.activation);
      EXPECT_NEAR(*held.activation, b, 1e-9);
      EXPECT_LE(held.history.size(), 6u);
      EXPECT_LT(std::abs(held.remaining_moment_N_m), 1e-10);
    }
  }
}

TEST(HeldAngle, OutsideWhatActivationCanHoldSaysHowFarOffItIs) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  // Without load, angles outside about 28.6 to 100.5 deg cannot be held.
  const HeldAngle high = held_angle(s, 110.0 * deg, 1, Eigen::Vector2d(0, 0.5), 0.0);
  EXPECT_FALSE(high.activation);
  EXPECT_EQ(high.nearest, 1.0);
  EXPECT_LT(high.remaining_moment_N_m, 0.0);
  ASSERT_TRUE(high.remaining_load_N);
  EXPECT_NEAR(moment_at(s, 110.0 * deg, Eigen::Vector2d(0, 1), *high.remaining_load_N).moment_N_m, 0.0,
              1e-12);
  const HeldAngle low = held_angle(s, 25.0 * deg, 0, Eigen::Vector2d(0.5, 0), 0.0);
  EXPECT_FALSE(low.activation);
  EXPECT_EQ(low.nearest, 1.0);
  EXPECT_TRUE(held_angle(s, 100.0 * deg, 1, Eigen::Vector2d(0, 0.5), 0.0).activation);
  EXPECT_TRUE(held_angle(s, 29.0 * deg, 0, Eigen::Vector2d(0.5, 0), 0.0).activation);
}

TEST(HeldAngle, OverTimeStartsFromTheFrameBefore) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  const int n = 101;
  std::vector<double> time;
  Eigen::VectorXd angle(n);
  Eigen::MatrixXd a(2, n);
  for (int i = 0; i < n; ++i) {
    time.push_back(0.01 * i);
    angle(i) = (78.0 + 12.0 * std::sin(0.06 * i)) * deg;
    a.col(i) = Eigen::Vector2d(0.1, 0.5);
  }
  const auto frames = hold(s, time, angle, 1, a, Eigen::VectorXd::Zero(n));
  std::size_t rows = 0;
  for (int i = 0; i < n; ++i) {
    const HeldAngle& held = frames[static_cast<std::size_t>(i)].held;
    ASSERT_TRUE(held.activation) << i;
    EXPECT_NEAR(equilibria(s, Eigen::Vector2d(0.1, *held.activation), 0.0).all.at(0).angle_rad, angle(i),
                1e-5);
    rows += held.history.size();
  }
  EXPECT_LE(rows, 3u * n);
}

// ---------------------------------------------------------------- activation-driven

TEST(Equilibria, IterateToTheStoppingRuleWithAHistory) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  const Eigen::Vector2d a(0.3, 0.6);
  for (const double start : {80.0, 40.0, 120.0}) {
    const FromStart from = equilibrium_from(s, a, 0.0, start * deg);
    ASSERT_TRUE(from.equilibrium) << start;
    EXPECT_NEAR(from.equilibrium->angle_rad, equilibria(s, a, 0.0).all.at(0).angle_rad, 1e-5);
    EXPECT_EQ(from.history.front().at, start * deg);
    EXPECT_EQ(from.history.front().step, 0.0);
    for (std::size_t i = 1; i < from.history.size(); ++i) {
      EXPECT_EQ(from.history[i].iteration, static_cast<int>(i));
      EXPECT_NEAR(from.history[i].at, from.history[i - 1].at + from.history[i].step, 1e-14);
    }
    const MomentState m = moment_at(s, from.equilibrium->angle_rad, a, 0.0);
    EXPECT_LT(std::abs(m.moment_N_m), 1e-6 * m.scale_N_m);
    EXPECT_LE(from.history.size(), 9u);
  }
}

TEST(Equilibria, StopAtTenTimesThePropagatedTolerance) {
  const fem::SurrogateModel model = published_model();
  const StaticSystem s = published_system(model);
  ScenarioOptions coarse;
  coarse.propagated_tolerance_N_m = 0.05;
  const FromStart from = equilibrium_from(s, Eigen::Vector2d(0.3, 0.6), 0.0, 80.0 * deg, coarse);
  EXPECT_LT(std::abs(from.history.back().moment_N_m), 0.5);
  EXPECT_LT(from.history.size(),
            equilibrium_from(s, Eigen::Vector2d(0.3, 0.6), 0.0, 80.0 * deg).history.size());
}

TEST(Equilibria, FromAStartThatLeadsNowhereAreNone) {
  const fem::SurrogateModel model = published_model();
  const FromStart from = equilibrium_from(published_system(model), Eigen::Vector2d(1, 0), 180.0, 80.0 * deg);
  EXPECT_FALSE(from.equilibrium);
  EXPECT_GE(from.history.size(), 2u);
}

TEST(Equilibria, AreAllFoundWithTheirStability) {
  const Idle idle;
  const Equilibria e = equilibria(snapping(idle), Eigen::VectorXd::Zero(1), 0.0);
  ASSERT_EQ(e.all.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) {
    const double q = e.all[i].angle_rad;
    EXPECT_NEAR(4.0 * std::sin(3.0 * q) - q, 0.0, 1e-5);
    EXPECT_EQ(e.all[i].stable, i % 2 == 0) << q;
    EXPECT_NEAR(q, -e.all[6 - i].angle_rad, 1e-6);
  }
}

TEST(Equilibria, TwoBetweenNeighbouringScanPointsAreFound) {
  const Idle idle;
  StaticSystem s = snapping(idle);
  s.external_moment = [](double q) { return data::CurveValue{(q - 0.511) * (q - 0.512), 2.0 * q - 1.023}; };
  ScenarioOptions options;
  options.scan_points = 11;
  options.relative_tolerance = 1e-12;
  ASSERT_EQ(equilibria(s, Eigen::VectorXd::Zero(1), 0.0, options).all.size(), 2u);
  s.external_moment = [](double q) {
    return data::CurveValue{(q - 0.511) * (q - 0.511) + 1e-3, 2.0 * q - 1.022};
  };
  const Equilibria none = equilibria(s, Eigen::VectorXd::Zero(1), 0.0, options);
  EXPECT_TRUE(none.all.empty());
  EXPECT_NEAR(none.nearest_rad, 0.511, 1e-9);
  EXPECT_NEAR(none.nearest_moment_N_m, 1e-3, 1e-12);
}

TEST(Scenarios, RefuseSystemsAndSeriesThatAreNone) {
  const fem::SurrogateModel model = published_model();
  StaticSystem s = published_system(model);
  EXPECT_THROW(moment_at(s, 1.0, Eigen::VectorXd::Zero(3), 0.0), data::InputError);
  EXPECT_THROW(held_angle(s, 1.0, 2, Eigen::Vector2d(0, 0), 0.0), data::InputError);
  EXPECT_THROW(equilibrium_from(s, Eigen::Vector2d(0, 0), 0.0, 4.0), data::InputError);
  EXPECT_THROW(follow(s, {0.0}, Eigen::MatrixXd::Zero(2, 2), Eigen::VectorXd::Zero(1), 1.0),
               data::InputError);
  s.load_arm = nullptr;
  EXPECT_THROW(moment_at(s, 1.0, Eigen::Vector2d(0, 0), 5.0), data::InputError);
  s.upper_rad = s.lower_rad;
  EXPECT_THROW(moment_at(s, 1.0, Eigen::Vector2d(0, 0), 0.0), data::InputError);
  EXPECT_THROW(moment_at({}, 1.0, Eigen::Vector2d(0, 0), 0.0), data::InputError);
}

}  // namespace
}  // namespace brachium::optimise::test
