#include "optimise/cross_validation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"
#include "elbow_study.hpp"

namespace brachium::optimise {
namespace {

using tests::elbow;
using tests::exact_options;
using tests::free;

std::vector<CalibrationTrial> trials() {
  TwinOptions options = exact_options(5.0);
  options.moment_noise_sd_N_m = 0.3;
  return noise_free_trials(make_twin(elbow(), options), "elbow_flexion");
}

CrossValidationOptions strengths_only() {
  CrossValidationOptions options;
  options.calibration.problem.free = {free(Quantity::strength, Scope::group)};
  return options;
}

TEST(CrossValidation, HoldsEveryTrialOutOnce) {
  const CrossValidationResult result = cross_validate(elbow(), trials(), strengths_only());
  ASSERT_EQ(result.folds.size(), 3u);
  ASSERT_EQ(result.models.size(), 4u);
  EXPECT_EQ(result.models[0].model, "muscle model");
  EXPECT_EQ(result.models[1].model, "linear_envelope");
  EXPECT_EQ(result.models[2].model, "angle_polynomial_3");
  EXPECT_EQ(result.models[3].model, "flexible");
  for (std::size_t f = 0; f < 3; ++f) {
    EXPECT_EQ(result.folds[f].held_out, std::vector<std::string>{trials()[f].name});
    EXPECT_EQ(result.folds[f].training.size(), 2u);
    EXPECT_TRUE(check_split(result.folds[f].training, result.folds[f].held_out).empty());
  }
  // With the true model and 0.3 N m of noise, the held-out error is the noise.
  EXPECT_NEAR(result.models[0].pooled_held_out.rmse, 0.3, 0.06);
  EXPECT_GT(result.models[1].pooled_held_out.rmse, result.models[0].pooled_held_out.rmse);
  EXPECT_EQ(result.table().rows(), 4u * 3u + 8u);
}

TEST(CrossValidation, NothingOfAHeldOutTrialReachesItsFold) {
  auto data = trials();
  CrossValidationOptions options = strengths_only();
  options.hold_out = {"random-1"};
  options.normalise_by_training_maximum = true;
  const CrossValidationResult plain = cross_validate(elbow(), data, options);
  for (double& v : data[0].moment.samples) v += 25.0;
  for (data::Signal& channel : data[0].excitations) channel.samples[10] = 0.999;  // would be the maximum
  const CrossValidationResult spoiled = cross_validate(elbow(), data, options);
  EXPECT_TRUE((plain.folds[0].calibration.x.array() == spoiled.folds[0].calibration.x.array()).all());
  EXPECT_EQ(plain.folds[0].channel_maximum, spoiled.folds[0].channel_maximum);
  for (std::size_t m = 0; m < plain.models.size(); ++m)
    EXPECT_EQ(plain.models[m].pooled_training.rmse, spoiled.models[m].pooled_training.rmse)
        << plain.models[m].model;
  EXPECT_GT(spoiled.models[0].pooled_held_out.rmse, plain.models[0].pooled_held_out.rmse + 10.0);
}

TEST(CrossValidation, DoesNotDependOnThreads) {
  CrossValidationOptions options = strengths_only();
  const CrossValidationResult one = cross_validate(elbow(), trials(), options);
  options.threads = 2;
  const CrossValidationResult two = cross_validate(elbow(), trials(), options);
  for (std::size_t m = 0; m < one.models.size(); ++m)
    EXPECT_EQ(one.models[m].pooled_held_out.rmse, two.models[m].pooled_held_out.rmse);
}

TEST(CrossValidation, FlagsATrialThatIsTrainedAndJudged) {
  const auto found = check_split({"a", "b"}, {"b", "c"});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].message,
            "trial `b` is used for both training and verdict: its error says nothing of unseen trials");
}

TEST(CrossValidation, NeedsTrialsToTrainOn) {
  CrossValidationOptions options = strengths_only();
  options.hold_out = {"*"};
  try {
    cross_validate(elbow(), trials(), options);
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message, "every trial is held out: none is left to train on");
  }
}

TEST(Baseline, RecoversAMomentOfItsOwnForm) {
  auto data = trials();
  for (CalibrationTrial& trial : data)
    for (std::size_t i = 0; i < trial.moment.samples.size(); ++i)
      trial.moment.samples[i] =
          2.0 + 30.0 * trial.excitations[0].samples[i] - 4.0 * std::sin(trial.angle.samples[i]);
  const Baseline linear = fit_baseline({BaselineSpec::Kind::linear_envelope}, {data[0], data[1]}, 0.0);
  const BaselinePrediction p = predict(linear, data[2], 0.0);
  for (std::size_t i = 0; i < p.time_s.size(); ++i) ASSERT_NEAR(p.modelled_N_m[i], p.reference_N_m[i], 1e-9);
  const Baseline cubic = fit_baseline({BaselineSpec::Kind::angle_polynomial}, {data[0], data[1]}, 0.0);
  EXPECT_EQ(cubic.columns, (std::vector<std::string>{"q^1", "q^2", "q^3"}));
  EXPECT_GT(
      metrics(predict(cubic, data[2], 0.0).reference_N_m, predict(cubic, data[2], 0.0).modelled_N_m).rmse,
      0.5);
}

TEST(Baseline, FlexibleHasFiftyTwoColumnsWithThreeChannels) {
  auto data = trials();
  for (CalibrationTrial& trial : data) trial.excitations.resize(3);
  const Baseline flexible = fit_baseline({BaselineSpec::Kind::flexible}, data, 0.0);
  EXPECT_EQ(flexible.columns.size(), 52u);
  EXPECT_EQ(flexible.title, "flexible regression, 52 columns of delayed envelopes times angle and velocity");
}

TEST(Baseline, RefusesOtherChannelsThanItsOwn) {
  auto data = trials();
  const Baseline linear = fit_baseline({BaselineSpec::Kind::linear_envelope}, data, 0.0);
  data[0].excitations.pop_back();
  try {
    predict(linear, data[0], 0.0);
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics()[0].message,
              "trial `random-1` does not have the channels that `linear_envelope` was fitted with");
  }
}

}  // namespace
}  // namespace brachium::optimise
