#include "optimise/calibration.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"
#include "elbow_study.hpp"
#include "optimise/cross_validation.hpp"

namespace brachium::optimise {
namespace {

using tests::disturbed;
using tests::elbow;
using tests::exact_options;
using tests::exact_trials;
using tests::free;
using tests::verdict;

TEST(Calibration, LinearStrengthFitAloneFindsTheStrengths) {
  data::Scene start = elbow();
  for (data::SceneMuscle& m : start.muscles) m.parameters.strength = 1.7;
  CalibrationOptions options;
  options.problem.free = {free(Quantity::strength, Scope::group)};
  options.solver.max_iterations = 1;
  const CalibrationResult result = calibrate(start, exact_trials(), options);
  for (double s : result.x) EXPECT_NEAR(s, 1.0, 1e-9);
}

TEST(Calibration, EveryGradientSolverFindsTheSameOptimum) {
  TwinOptions twin = exact_options(4.0);
  twin.moment_noise_sd_N_m = 0.5;
  const auto trials = exact_trials(twin);
  CalibrationOptions options;
  options.problem.free = {free(Quantity::strength, Scope::group), free(Quantity::delay, Scope::global),
                          free(Quantity::shape, Scope::global)};
  options.problem.decimate = 4;
  const CalibrationResult reference = calibrate(disturbed(elbow()), trials, options);
  for (Solver solver : {Solver::gsl_levenberg_marquardt, Solver::slsqp, Solver::lbfgs}) {
    options.solver.solver = solver;
    const CalibrationResult other = calibrate(disturbed(elbow()), trials, options);
    EXPECT_NEAR(other.summary.cost / reference.summary.cost, 1.0, 1e-6)
        << to_string(solver) << other.summary.message();
  }
}

TEST(Calibration, SaysThatRecursionCoefficientsAreInterchangeable) {
  // As CEINMS has them: C1 = C2 = -0.5. The cost depends on their difference to fourth order only.
  data::Scene truth = elbow();
  for (data::SceneMuscle& m : truth.muscles)
    m.activation.time_constant_1_s = m.activation.time_constant_2_s = emg::time_constant(-0.5, 200.0);
  TwinOptions twin = exact_options();
  twin.moment_noise_sd_N_m = 0.3;
  twin.model.activation.form = emg::ActivationForm::recursive;
  twin.model.recursion_rate_hz = 200.0;
  CalibrationOptions options;
  options.problem.model = twin.model;
  options.problem.free = {free(Quantity::strength, Scope::group), free(Quantity::recursion_1, Scope::global),
                          free(Quantity::recursion_2, Scope::global)};
  data::Scene start = truth;
  for (data::SceneMuscle& m : start.muscles) m.activation.time_constant_1_s = emg::time_constant(-0.3, 200.0);
  const CalibrationResult result =
      calibrate(start, noise_free_trials(make_twin(truth, twin), "elbow_flexion"), options);
  for (const char* name : {"recursion_1", "recursion_2"}) {
    const auto& v = verdict(result.subject, "*", name);
    EXPECT_NE(v.remark.find("interchangeable with"), std::string::npos) << v.remark;
    const bool covers = v.interval_lower <= -0.5 && -0.5 <= v.interval_upper;
    EXPECT_TRUE(v.verdict != "identified" || covers) << verdict_text(result.subject);
  }
}

TEST(Calibration, NamesGainAndStrengthAsOneWithoutAnMvc) {
  TwinOptions twin = exact_options();
  twin.channel_gains = {{"biceps", 2.0},
                        {"brachialis", 1.5},
                        {"triceps_long", 1.7},
                        {"triceps_lateral", 1.7},
                        {"brachioradialis", 1.5}};
  twin.moment_noise_sd_N_m = 1.0;
  twin.model.activation.nonlinearity = emg::Nonlinearity::none;
  CalibrationOptions options;
  options.problem.model = twin.model;
  options.problem.free = {free(Quantity::strength, Scope::group), free(Quantity::gain)};
  const CalibrationResult result = calibrate(elbow(), exact_trials(twin), options);
  const auto& strength = verdict(result.subject, "biceps", "strength");
  const auto& gain = verdict(result.subject, "biceps", "gain");
  EXPECT_NE(strength.remark.find("one parameter with biceps gain: without a maximal contraction or a prior "
                                 "only their product is known"),
            std::string::npos)
      << verdict_text(result.subject);
  EXPECT_NE(gain.remark.find("one parameter with biceps strength"), std::string::npos)
      << verdict_text(result.subject);
  EXPECT_NEAR(strength.fitted * gain.fitted, 2.0, 0.2);
  EXPECT_EQ(strength.verdict, "NOT IDENTIFIED") << verdict_text(result.subject);
  EXPECT_EQ(gain.verdict, "NOT IDENTIFIED") << verdict_text(result.subject);
}

TEST(Calibration, ReportsABoundThatIsHit) {
  data::Scene start = elbow();
  for (data::SceneMuscle& m : start.muscles) m.parameters.strength = 1.5;
  CalibrationOptions options;
  FreeQuantity strength = free(Quantity::strength, Scope::global);
  strength.lower = 1.2;
  strength.upper = 2.0;
  options.problem.free = {strength};
  const CalibrationResult result = calibrate(start, exact_trials(), options);
  const auto& v = verdict(result.subject, "*", "strength");
  EXPECT_EQ(v.verdict, "AT LOWER BOUND");
  EXPECT_EQ(v.fitted, 1.2);
  EXPECT_NE(verdict_text(result.subject).find("AT LOWER BOUND"), std::string::npos);
  EXPECT_EQ(result.diagnostics[0].code, "at-bound");
}

TEST(Calibration, SaysWhenAPriorDecides) {
  TwinOptions twin = exact_options();
  twin.moment_noise_sd_N_m = 1.0;
  CalibrationOptions options;
  FreeQuantity velocity = free(Quantity::max_contraction_velocity, Scope::global);
  velocity.relative = true;
  velocity.prior_sd = 1e-4;
  options.problem.free = {free(Quantity::strength, Scope::group), velocity};
  const CalibrationResult result = calibrate(elbow(), exact_trials(twin), options);
  const auto& v = verdict(result.subject, "*", "max_contraction_velocity_factor");
  EXPECT_EQ(v.verdict, "NOT IDENTIFIED");
  EXPECT_NE(v.remark.find("determined by its prior (posterior / prior sd 1.00)"), std::string::npos)
      << v.remark;
}

TEST(Calibration, OfNothingIsRefused) {
  try {
    calibrate(elbow(), exact_trials(exact_options(2.0)), {});
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message, "the calibration has no free parameter");
  }
}

TEST(Calibration, SubjectPredictsWhatTheCalibrationModelled) {
  TwinOptions twin = exact_options(4.0);
  twin.moment_noise_sd_N_m = 0.5;
  const auto trials = exact_trials(twin);
  CalibrationOptions options;
  options.problem.free = {free(Quantity::strength, Scope::group), free(Quantity::gain)};
  const CalibrationResult result = calibrate(elbow(), trials, options);
  const Prediction p = predict(elbow(), result.subject, trials[1], options.problem);
  const Metrics m = metrics(p.reference_N_m, p.modelled_N_m);
  EXPECT_NEAR(m.rmse, result.trial_metrics[1].rmse, 1e-12);
}

}  // namespace
}  // namespace brachium::optimise
