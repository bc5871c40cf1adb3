#include "optimise/calibration_problem.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "data/model/error.hpp"
#include "elbow_study.hpp"
#include "optimise/derivative_checker.hpp"

namespace brachium::optimise {
namespace {

using tests::elbow;
using tests::exact_options;
using tests::free;

std::vector<CalibrationTrial> trials(const TwinOptions& options = exact_options(2.0)) {
  return noise_free_trials(make_twin(elbow(), options), "elbow_flexion");
}

CalibrationProblemOptions everything_free(const ModelChoice& model = {}) {
  CalibrationProblemOptions options;
  options.model = model;
  options.free = {free(Quantity::strength, Scope::group),
                  free(Quantity::optimal_fibre_length),
                  free(Quantity::tendon_slack_length),
                  free(Quantity::max_contraction_velocity, Scope::global),
                  free(Quantity::delay),
                  free(Quantity::shape),
                  free(Quantity::gain)};
  const bool recursive = model.activation.form == emg::ActivationForm::recursive;
  options.free.push_back(free(recursive ? Quantity::recursion_1 : Quantity::time_constant_1, Scope::group));
  options.free.push_back(free(recursive ? Quantity::recursion_2 : Quantity::time_constant_2, Scope::global));
  FreeQuantity pennation = free(Quantity::pennation, Scope::group);
  pennation.only = {"triceps"};
  options.free.push_back(pennation);
  return options;
}

std::string error_of(const std::function<void()>& task) {
  try {
    task();
  } catch (const data::InputError& error) {
    return error.diagnostics().front().code + ": " + error.diagnostics().front().message;
  }
  return "accepted";
}

/// Biceps and triceps above the node of the piecewise nonlinearity, the others below it: its curvature jumps there, and a
/// difference across it is no derivative.
std::vector<CalibrationTrial> on_both_pieces(std::vector<CalibrationTrial> trials) {
  for (CalibrationTrial& trial : trials) {
    double phase = 0.0;
    for (data::Signal& e : trial.excitations) {
      const bool above = e.info.name.starts_with("biceps") || e.info.name.starts_with("triceps");
      phase += 1.0;
      for (std::size_t k = 0; k < e.samples.size(); ++k)
        e.samples[k] = (above ? 0.65 : 0.12) * (1.0 + 0.3 * std::sin(0.03 * static_cast<double>(k) + phase));
    }
  }
  return trials;
}

using Case = std::tuple<hill::TendonKind, hill::FibreVelocity, emg::ActivationForm, emg::Nonlinearity>;
class WholeChain : public ::testing::TestWithParam<Case> {};

TEST_P(WholeChain, HasExactDerivativesInEveryParameter) {
  ModelChoice model;
  // A curve set without corners: differences across the knots of a piecewise cubic are no derivative.
  model.curves = "degroote_fregly_2016";
  std::tie(model.tendon, model.fibre_velocity, model.activation.form, model.activation.nonlinearity) =
      GetParam();
  if (model.activation.form == emg::ActivationForm::recursive) model.recursion_rate_hz = 200.0;
  data::Scene scene = elbow();
  std::vector<CalibrationTrial> data = trials();
  if (model.activation.nonlinearity == emg::Nonlinearity::piecewise) {
    for (data::SceneMuscle& m : scene.muscles) m.activation.shape = 0.06;
    data = on_both_pieces(std::move(data));
  }
  CalibrationProblemOptions options = everything_free(model);
  options.decimate = 7;
  const CalibrationProblem problem(scene, data, options);
  Eigen::VectorXd x = start_of(problem.parameters());
  const Eigen::VectorXd lower = lower_of(problem.parameters()), upper = upper_of(problem.parameters());
  for (Eigen::Index j = 0; j < x.size(); ++j)
    x[j] += 0.13 * ((j % 2 == 0 ? upper : lower)[j] - x[j]) * (j % 3 == 0 ? 1.0 : 0.4);
  for (std::size_t j = 0; j < problem.parameters().size(); ++j)  // activation stays inside [0, 1]
    if (problem.parameters()[j].name == "gain") x[static_cast<Eigen::Index>(j)] = 0.93;
  DerivativeCheckOptions check_options;
  check_options.initial_step = 2e-3;
  const DerivativeCheck check = check_derivatives(problem, x, check_options);
  EXPECT_TRUE(check.passed) << check.text();
}

std::string name_of(const ::testing::TestParamInfo<Case>& test) {
  const auto& [tendon, velocity, form, nonlinearity] = test.param;
  return hill::to_string(tendon) + "_" + hill::to_string(velocity) + "_" + to_string(form) + "_" +
         emg::to_string(nonlinearity);
}
INSTANTIATE_TEST_SUITE_P(
    Models, WholeChain,
    ::testing::Combine(::testing::Values(hill::TendonKind::rigid, hill::TendonKind::elastic),
                       ::testing::Values(hill::FibreVelocity::zero_lag, hill::FibreVelocity::causal),
                       ::testing::Values(emg::ActivationForm::continuous, emg::ActivationForm::recursive),
                       ::testing::Values(emg::Nonlinearity::exponential, emg::Nonlinearity::piecewise)),
    name_of);

TEST(CalibrationProblem, ResidualsVanishAtTheTruth) {
  const CalibrationProblem problem(elbow(), trials(), everything_free());
  Eigen::VectorXd r;
  problem.evaluator()->evaluate(start_of(problem.parameters()), r, nullptr);
  EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-12);
}

TEST(CalibrationProblem, RunsAgainOnlyMusclesWhoseParametersChanged) {
  CalibrationProblemOptions options;
  options.free = {free(Quantity::strength), free(Quantity::tendon_slack_length), free(Quantity::gain)};
  const CalibrationProblem problem(elbow(), trials(), options);
  const std::size_t runs = 7 * 3;  // muscles x trials
  const auto evaluator = problem.evaluator();
  Eigen::VectorXd x = start_of(problem.parameters()), r;
  Eigen::MatrixXd J;
  const auto ran = [&](bool jacobian) {
    const std::size_t before = CalibrationProblem::count(*evaluator).muscle_trials;
    evaluator->evaluate(x, r, jacobian ? &J : nullptr);
    return CalibrationProblem::count(*evaluator).muscle_trials - before;
  };
  const auto nudge = [&](const std::string& label) {
    for (std::size_t j = 0; j < problem.parameters().size(); ++j)
      if (problem.parameters()[j].label() == label) x[static_cast<Eigen::Index>(j)] *= 1.01;
  };
  EXPECT_EQ(ran(false), runs);
  EXPECT_EQ(ran(false), 0u);
  EXPECT_EQ(ran(true), runs);  // derivatives were not asked for before
  EXPECT_EQ(ran(true), 0u);
  nudge("BRA strength");
  EXPECT_EQ(ran(true), 0u);  // the force is linear in it
  nudge("BRA tendon_slack_length_m");
  EXPECT_EQ(ran(true), 3u);
  nudge("biceps gain");
  EXPECT_EQ(ran(false), 6u);  // both heads of the biceps, three trials
  EXPECT_EQ(CalibrationProblem::count(*evaluator).points, 7u);
  // What the cache serves is what a fresh evaluator computes.
  Eigen::VectorXd fresh;
  evaluator->evaluate(x, r, &J);
  problem.evaluator()->evaluate(x, fresh, nullptr);
  EXPECT_TRUE((fresh.array() == r.array()).all());
}

TEST(CalibrationProblem, DoesNotDependOnThreads) {
  CalibrationProblemOptions options = everything_free();
  const auto data = trials();
  Eigen::VectorXd r1, r4;
  Eigen::MatrixXd J1, J4;
  const CalibrationProblem one(elbow(), data, options);
  options.threads = 4;
  const CalibrationProblem four(elbow(), data, options);
  const Eigen::VectorXd x = 0.97 * start_of(one.parameters());
  one.evaluator()->evaluate(x, r1, &J1);
  four.evaluator()->evaluate(x, r4, &J4);
  EXPECT_TRUE((r1.array() == r4.array()).all());
  EXPECT_TRUE((J1.array() == J4.array()).all());
}

TEST(CalibrationProblem, ComparesAtTheReferencesOwnTimeStamps) {
  // The same trial with a reference at 50 Hz that starts 33 ms late and ends early.
  auto full = trials();
  CalibrationTrial sparse = full[0];
  sparse.moment.samples.clear();
  data::Signal& m = sparse.moment;
  m.info.rate_hz = 50.0;
  m.info.start_time_s = 0.035;
  for (std::size_t i = 7; i < full[0].moment.samples.size() - 20; i += 4)
    m.samples.push_back(full[0].moment.samples[i]);
  m.info.count = m.samples.size();
  CalibrationProblemOptions options;
  options.scale_N_m = 1.0;
  options.edge_s = 0.05;
  const CalibrationProblem problem(elbow(), {sparse}, options);
  Eigen::VectorXd r;
  problem.evaluator()->evaluate(Eigen::VectorXd(), r, nullptr);
  EXPECT_LT(r.cwiseAbs().maxCoeff(), 1e-9);
  const TrialWindow& w = problem.windows()[0];
  EXPECT_EQ(w.before + w.used + w.after, m.samples.size());
  EXPECT_EQ(w.before, 3u);  // 0.05 s are two and a half periods at 50 Hz
  EXPECT_EQ(w.after, 3u);
}

TEST(CalibrationProblem, AHoldWeighsNoMoreThanItsSamples) {
  // One scale for the set: a trial of constant moment does not blow up.
  auto data = trials();
  CalibrationTrial hold = data[0];
  hold.name = "hold";
  std::fill(hold.moment.samples.begin(), hold.moment.samples.end(), 20.0);
  data.push_back(hold);
  const CalibrationProblem problem(elbow(), data, {});
  EXPECT_GT(problem.scale_N_m(), 1.0);
  EXPECT_DOUBLE_EQ(problem.residual_weight(3), problem.residual_weight(0));
}

TEST(CalibrationProblem, ExcitationsBeyondTheUnitRangeAreCounted) {
  auto data = trials();
  data[0].excitations[0].samples[5] = 1.2;
  data[0].excitations[1].samples[6] = -0.01;
  const CalibrationProblem problem(elbow(), data, {});
  EXPECT_EQ(problem.windows()[0].above_one, 1u);
  EXPECT_EQ(problem.windows()[0].below_zero, 1u);
  EXPECT_EQ(problem.windows()[1].above_one, 0u);
}

TEST(CalibrationProblem, SharedLengthsAreFactorsAndOthersValues) {
  CalibrationProblemOptions options;
  options.free = {free(Quantity::tendon_slack_length, Scope::group), free(Quantity::delay, Scope::global),
                  free(Quantity::strength, Scope::group)};
  options.free[2].only = {"triceps", "BRA"};
  const CalibrationProblem problem(elbow(), trials(), options);
  std::vector<std::string> labels;
  for (const Parameter& p : problem.parameters()) labels.push_back(p.label());
  EXPECT_EQ(labels, (std::vector<std::string>{
                        "triceps tendon_slack_length_factor", "biceps tendon_slack_length_factor",
                        "brachialis tendon_slack_length_factor", "brachioradialis tendon_slack_length_factor",
                        "* delay_s", "triceps strength", "brachialis strength"}));
  Eigen::VectorXd x = start_of(problem.parameters());
  x[0] = 1.02;
  const data::Subject subject = problem.subject(x);
  EXPECT_DOUBLE_EQ(subject.muscle("TRIlat").parameters.tendon_slack_length_m,
                   1.02 * elbow().muscle("TRIlat").parameters.tendon_slack_length_m);
}

TEST(CalibrationProblem, BoundsOfTheShapeAreThoseOfTheNonlinearity) {
  data::Scene scene = elbow();
  CalibrationProblemOptions options;
  options.model.activation.nonlinearity = emg::Nonlinearity::piecewise;
  options.free = {free(Quantity::shape, Scope::global)};
  EXPECT_EQ(error_of([&] { CalibrationProblem(scene, trials(), options); }),
            "bad-parameter: parameter `* shape`: start -1.5 is outside the bounds [0.001, 0.119]");
  for (data::SceneMuscle& m : scene.muscles) m.activation.shape = 0.06;
  const CalibrationProblem problem(scene, trials(), options);
  EXPECT_EQ(problem.parameters()[0].lower, 0.001);
  EXPECT_EQ(problem.parameters()[0].upper, 0.119);
}

TEST(CalibrationProblem, RefusesAMomentThatDoesNotVary) {
  auto data = trials();
  for (auto& trial : data) std::fill(trial.moment.samples.begin(), trial.moment.samples.end(), 12.5);
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), data, {}); }),
            "zero-variance-moment: the reference moment does not vary over the training trials (constant "
            "12.5 N m): no scale can be "
            "taken from it");
}

TEST(CalibrationProblem, RefusesWhatIsMissingDoubleOrOffTheGrid) {
  const auto good = trials();
  auto data = good;
  data[1].moment.samples.clear();
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), data, {}); }),
            "missing-moment: trial `random-2` has no reference moment");
  data = good;
  data[1].name = "random-1";
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), data, {}); }),
            "duplicate-trial: trial `random-1` stands twice in the training set");
  data = good;
  data[0].excitations[1].info.rate_hz = 100.0;
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), data, {}); }).substr(0, 53),
            "rate-mismatch: trial `random-1`: excitations `triceps");
  data = good;
  data[0].moment.samples[3] = std::nan("");
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), data, {}); }),
            "not-finite: trial `random-1`: sample 3 of signal `joint_moment` is not finite (0.015 s)");
  data = good;
  data[0].moment.info.start_time_s = 100.0;
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), data, {}); }),
            "empty-window: trial `random-1`: excitation, angle and moment share 0.000 s (100.000 to 2.000 "
            "s), too little after 0.000 s are "
            "dropped at each end");
  EXPECT_EQ(error_of([&] { CalibrationProblem(elbow(), {}, {}); }),
            "no-trials: a calibration needs at least one trial");
  data::Trial bare;
  bare.name = "bare";
  EXPECT_EQ(error_of([&] { calibration_trial(bare, "elbow_flexion"); }),
            "missing-signal: trial `bare` has no excitation");
}

TEST(CalibrationProblem, RefusesImpossibleFreeParameters) {
  const auto data = trials();
  const auto message = [&](FreeQuantity f) {
    CalibrationProblemOptions options;
    options.free = {f};
    return error_of([&] { CalibrationProblem(elbow(), data, options); });
  };
  FreeQuantity f = free(Quantity::strength);
  f.only = {"bicepts"};
  EXPECT_EQ(message(f), "no-match: `bicepts` (of free `strength`) matches no name");
  f = free(Quantity::recursion_1);
  EXPECT_EQ(message(f),
            "bad-parameter: `recursion_1` cannot be free in the continuous form of activation dynamics");
  f = free(Quantity::tendon_slack_length, Scope::group);
  f.lower = 0.1;
  f.upper = 0.2;
  EXPECT_EQ(message(f).substr(0, 82),
            "bad-bounds: `triceps tendon_slack_length_factor` is shared as a factor: its bounds");
  f = free(Quantity::delay);
  f.lower = 0.05;
  f.upper = 0.10;
  EXPECT_EQ(message(f),
            "bad-parameter: parameter `TRIlong delay_s`: start 0.04 is outside the bounds [0.05, 0.1]");
  f = free(Quantity::gain, Scope::group);
  EXPECT_EQ(
      message(f),
      "bad-parameter: `gain` belongs to channels: its scope is \"channel\" or \"global\", not \"group\"");
  EXPECT_EQ(error_of([] { parse_quantity("strenght"); }),
            "unknown-parameter: `strenght` is not a parameter that can be set free");
}

}  // namespace
}  // namespace brachium::optimise
