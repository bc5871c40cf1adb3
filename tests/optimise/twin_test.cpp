#include "optimise/twin.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"
#include "elbow_study.hpp"

namespace brachium::optimise {
namespace {

using tests::plan;

TwinOptions every_programme() {
  TwinOptions options;
  options.raw_emg = false;
  for (Programme p : {Programme::mvc, Programme::isometric_ramp, Programme::isometric_hold, Programme::curl,
                      Programme::isokinetic, Programme::passive_sweep, Programme::random})
    options.trials.push_back(plan(to_string(p), p, 10.0));
  return options;
}

TEST(Twin, IsTheSameForTheSameSeedAndAnotherForAnother) {
  TwinOptions options = every_programme();
  options.raw_emg = true;
  options.trials = {plan("random", Programme::random, 2.0)};
  const Twin a = make_twin(tests::elbow(), options), b = make_twin(tests::elbow(), options);
  options.seed = 2;
  const Twin c = make_twin(tests::elbow(), options);
  const auto& signals = a.recordings.trials[0].signals;
  ASSERT_EQ(signals.size(), 5u + 3u);
  for (std::size_t s = 0; s < signals.size(); ++s) {
    EXPECT_EQ(signals[s].samples, b.recordings.trials[0].signals[s].samples);
    EXPECT_NE(signals[s].samples, c.recordings.trials[0].signals[s].samples);
  }
}

TEST(Twin, VelocityIsTheDerivativeOfAngleInEveryProgramme) {
  const Twin twin = make_twin(tests::elbow(), every_programme());
  for (const data::Trial& trial : twin.recordings.trials) {
    const auto &q = trial.signal("joint_angle").samples, &v = trial.signal("joint_velocity").samples;
    for (std::size_t i = 1; i + 1 < q.size(); ++i)
      ASSERT_NEAR(v[i], (q[i + 1] - q[i - 1]) * 100.0, 0.02) << trial.name << ", sample " << i;
  }
}

TEST(Twin, ExcitationsStayInRangeAndTheMvcReachesOne) {
  const Twin twin = make_twin(tests::elbow(), every_programme());
  for (const data::Trial& trial : twin.truth.trials) {
    for (const data::Signal& s : trial.signals) {
      if (s.info.quantity != data::Quantity::excitation) continue;
      double largest = 0.0;
      for (double e : s.samples) {
        ASSERT_TRUE(e >= 0.0 && e <= 1.0) << trial.name << " " << s.info.name;
        largest = std::max(largest, e);
      }
      if (trial.name == "mvc") {
        EXPECT_DOUBLE_EQ(largest, 1.0);
      }
      if (trial.name == "passive_sweep") {
        EXPECT_EQ(largest, 0.0);
      }
    }
  }
}

// In a ramp of flexors, then of extensors: the antagonists' excitation is the level's share of the agonists'.
TEST(Twin, AntagonistsFollowAtTheLevelOfCocontraction) {
  TwinOptions options = every_programme();
  options.trials = {plan("ramp", Programme::isometric_ramp, 8.0, 0.8)};
  options.independence = 0.0;
  double before_net = 1e300, before_force = 0.0;
  for (const double level : {0.0, 0.1, 0.35, 1.0}) {
    options.cocontraction = level;
    const Twin twin = make_twin(tests::elbow(), options);
    const data::Trial& trial = twin.truth.trials[0];
    const auto &flexor = trial.signal("biceps").samples, &extensor = trial.signal("triceps_long").samples;
    const std::size_t plateau = 3 * flexor.size() / 10, later = 29 * flexor.size() / 40;
    EXPECT_NEAR(flexor[plateau], 0.8, 1e-12);
    EXPECT_NEAR(extensor[plateau], level * 0.8, 1e-12);
    EXPECT_NEAR(extensor[later], 0.8, 1e-12);
    EXPECT_NEAR(flexor[later], level * 0.8, 1e-12);
    // More force in all muscles together, less of it as a moment.
    double net = trial.signal("joint_moment").samples[plateau], force = 0.0;
    for (const data::Signal& s : trial.signals)
      if (s.info.quantity == data::Quantity::muscle_force) force += s.samples[plateau];
    EXPECT_LT(net, before_net) << level;
    EXPECT_GT(force, before_force) << level;
    before_net = net;
    before_force = force;
  }
}

TEST(Twin, IsRecoveredAtEveryLevelOfCocontraction) {
  for (const double level : {0.0, 0.35, 1.0}) {
    TwinOptions options = tests::exact_options(6.0);
    options.cocontraction = level;
    CalibrationOptions calibration;
    calibration.problem.free = {
        tests::free(Quantity::strength, Scope::group), tests::free(Quantity::tendon_slack_length),
        tests::free(Quantity::delay, Scope::global), tests::free(Quantity::shape, Scope::global)};
    calibration.problem.decimate = 4;
    data::Scene start = tests::disturbed(tests::elbow());
    for (data::SceneMuscle& m : start.muscles) {
      const data::SceneMuscle truth = tests::elbow().muscle(m.name);
      m.parameters.optimal_fibre_length_m = truth.parameters.optimal_fibre_length_m;
      m.activation.time_constant_1_s = truth.activation.time_constant_1_s;
      m.activation.time_constant_2_s = truth.activation.time_constant_2_s;
    }
    const CalibrationResult result = calibrate(start, tests::exact_trials(options), calibration);
    const Eigen::VectorXd truth = start_of(
        CalibrationProblem(tests::elbow(), tests::exact_trials(options), calibration.problem).parameters());
    for (Eigen::Index j = 0; j < truth.size(); ++j)
      EXPECT_NEAR(result.x[j], truth[j], 1e-6 * std::abs(truth[j]))
          << level << ": " << result.parameters[static_cast<std::size_t>(j)].label();
  }
}

TEST(Twin, MomentIsTheSumOfTheMusclesShares) {
  const Twin twin = make_twin(tests::elbow(), every_programme());
  const data::Trial& trial = twin.truth.trial("curl");
  std::vector<double> sum(trial.signal("joint_moment").samples.size(), 0.0);
  for (const data::Signal& s : trial.signals)
    if (s.info.quantity == data::Quantity::joint_moment && !s.info.muscle.empty())
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += s.samples[i];
  for (std::size_t i = 0; i < sum.size(); ++i)
    ASSERT_NEAR(sum[i], trial.signal("joint_moment").samples[i], 1e-12);
}

TEST(Twin, DynamometerAtRestReadsPassiveMomentAndGravity) {
  TwinOptions options = every_programme();
  options.dynamometer = true;
  options.trials = {plan("hold", Programme::isometric_hold, 6.0, 0.0)};
  const data::Scene scene = tests::elbow();
  const Twin twin = make_twin(scene, options);
  const data::Trial& trial = twin.recordings.trials[0];
  double S = 0.0;
  for (const data::Segment& segment : scene.segments) S += segment.mass_kg * segment.centre_of_mass_m;
  const double gravity = -S * 9.80665 * std::sin(1.2 + scene.upper_arm_inclination_rad);
  for (std::size_t i = 0; i < 100; ++i)
    EXPECT_NEAR(trial.signal("dynamometer_torque").samples[i] - trial.signal("joint_moment").samples[i],
                gravity, 1e-9);
}

TEST(Twin, AGainShowsInTheRecordedExcitationOnly) {
  TwinOptions options = every_programme();
  options.trials = {plan("random", Programme::random, 4.0)};
  const Twin plain = make_twin(tests::elbow(), options);
  options.channel_gains = {{"biceps", 2.0}};
  const Twin gained = make_twin(tests::elbow(), options);
  const auto &e = plain.truth.trials[0].signal("biceps").samples,
             &g = gained.truth.trials[0].signal("biceps").samples;
  for (std::size_t i = 0; i < e.size(); ++i) ASSERT_NEAR(2.0 * g[i], e[i], 1e-15);
  const auto &m = plain.truth.trials[0].signal("joint_moment").samples,
             &n = gained.truth.trials[0].signal("joint_moment").samples;
  for (std::size_t i = 0; i < m.size(); ++i) ASSERT_NEAR(m[i], n[i], 1e-9);
}

TEST(Twin, ListsEveryOptionOutsideItsRange) {
  TwinOptions options = every_programme();
  options.trials = {plan("wide", Programme::random, 4.0)};
  options.trials[0].upper_rad = 4.0;
  options.cocontraction = -0.1;
  try {
    make_twin(tests::elbow(), options);
    FAIL();
  } catch (const data::InputError& error) {
    ASSERT_EQ(error.diagnostics().size(), 2u);
    EXPECT_EQ(error.diagnostics()[0].message, "`cocontraction` -0.1 must be in [0, 1]");
    EXPECT_EQ(error.diagnostics()[1].message,
              "trial `wide`: angles 20.1 to 229.2 deg are not inside the scene's 0.0 to 150.0 deg");
  }
}

}  // namespace
}  // namespace brachium::optimise
