/// A twin without noise: what a calibration finds is the truth, to a millionth.

#include <gtest/gtest.h>

#include <cmath>

#include "elbow_study.hpp"

namespace brachium::optimise {
namespace {

using tests::disturbed;
using tests::elbow;
using tests::exact_options;
using tests::exact_trials;
using tests::free;
using tests::verdict;

class NoiseFreeTwin : public ::testing::TestWithParam<hill::TendonKind> {
 protected:
  static data::Subject calibrated(const data::Scene& start, const std::vector<FreeQuantity>& quantities,
                                  TwinOptions twin = exact_options()) {
    twin.model.tendon = GetParam();
    CalibrationOptions options;
    options.problem.model.tendon = GetParam();
    options.problem.free = quantities;
    options.problem.decimate = 4;
    const CalibrationResult result = calibrate(start, exact_trials(twin), options);
    EXPECT_TRUE(result.summary.converged) << result.summary.message();
    EXPECT_LT(result.pooled.rmse, 1e-6);
    return result.subject;
  }

  /// Every parameter of every muscle.
  static void expect_truth(const data::Subject& subject) {
    const data::Scene scene = elbow();
    for (const data::SubjectMuscle& m : subject.muscles) {
      const data::SceneMuscle& t = scene.muscle(m.name);
      const auto close = [&](double fitted, double exact, const char* what) {
        EXPECT_NEAR(fitted, exact, 1e-6 * std::abs(exact)) << m.name << " " << what;
      };
      close(m.parameters.strength, t.parameters.strength, "strength");
      close(m.parameters.tendon_slack_length_m, t.parameters.tendon_slack_length_m, "tendon slack length");
      close(m.parameters.optimal_fibre_length_m, t.parameters.optimal_fibre_length_m, "optimal fibre length");
      close(m.parameters.max_contraction_velocity, t.parameters.max_contraction_velocity, "v_max");
      close(m.parameters.pennation_at_optimal_rad, t.parameters.pennation_at_optimal_rad, "pennation");
      close(m.activation.delay_s, t.activation.delay_s, "delay");
      close(m.activation.time_constant_1_s, t.activation.time_constant_1_s, "first time constant");
      close(m.activation.time_constant_2_s, t.activation.time_constant_2_s, "second time constant");
      close(m.activation.shape, t.activation.shape, "shape");
    }
  }
};

TEST_P(NoiseFreeTwin, GivesEveryIdentifiableParameterToAMillionth) {
  const data::Subject subject =
      calibrated(disturbed(elbow()),
                 {free(Quantity::strength, Scope::group), free(Quantity::tendon_slack_length),
                  free(Quantity::optimal_fibre_length), free(Quantity::delay, Scope::global),
                  free(Quantity::time_constant_1, Scope::global),
                  free(Quantity::time_constant_2, Scope::global), free(Quantity::shape, Scope::global)});
  expect_truth(subject);
  const std::string remark = verdict(subject, "*", "time_constant_1_s").remark;
  EXPECT_NE(remark.find("interchangeable with time_constant_2_s: the pair is determined, not which is which"),
            std::string::npos);
}

// Gains in the place of strengths, which are one parameter with them; v_max a muscle; pennation where there is one.
TEST_P(NoiseFreeTwin, GivesGainsVelocitiesAndPennationToAMillionth) {
  TwinOptions twin = exact_options();
  twin.channel_gains = {{"biceps", 1.3},
                        {"brachialis", 0.9},
                        {"triceps_long", 1.2},
                        {"triceps_lateral", 0.8},
                        {"brachioradialis", 1.1}};
  data::Scene start = disturbed(elbow());
  double sign = 1.0;
  for (data::SceneMuscle& m : start.muscles) {
    sign = -sign;
    m.parameters.strength = 1.0;
    m.parameters.max_contraction_velocity *= 1.0 + 0.15 * sign;
    m.parameters.pennation_at_optimal_rad *= 1.1;
  }
  FreeQuantity pennation = free(Quantity::pennation, Scope::group);
  pennation.only = {"triceps"};
  const data::Subject subject =
      calibrated(start,
                 {free(Quantity::gain), free(Quantity::max_contraction_velocity), pennation,
                  free(Quantity::tendon_slack_length), free(Quantity::optimal_fibre_length),
                  free(Quantity::delay, Scope::global), free(Quantity::time_constant_1, Scope::global),
                  free(Quantity::time_constant_2, Scope::global), free(Quantity::shape, Scope::global)},
                 twin);
  expect_truth(subject);
  for (const auto& [channel, gain] : twin.channel_gains)
    EXPECT_NEAR(subject.channel_gains.at(channel), gain, 1e-6 * gain) << channel;
  for (const auto& v : subject.verdicts)
    EXPECT_EQ(v.verdict, "identified") << v.muscle << " " << v.parameter << ": " << v.remark;
}

INSTANTIATE_TEST_SUITE_P(Tendons, NoiseFreeTwin,
                         ::testing::Values(hill::TendonKind::rigid, hill::TendonKind::elastic),
                         [](const auto& one) { return hill::to_string(one.param); });

}  // namespace
}  // namespace brachium::optimise
