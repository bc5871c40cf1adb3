/// Ten seeds of the stochastic twin (100 in the benchmark): intervals that cover the truth, and combinations that no data
/// can tell apart named as such.

#include "stochastic_twin.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elbow_study.hpp"

namespace brachium::optimise {
namespace {

using tests::elbow;
using tests::free;
using tests::StochasticOutcome;
using tests::StochasticStudy;
using tests::verdict;

constexpr int kSeeds = 10;

bool covers(const data::ParameterVerdict& v, double truth) {
  return v.interval_lower <= truth && truth <= v.interval_upper;
}

TEST(StochasticTwin, IntervalsCoverTheTruthOverTenSeeds) {
  const data::Scene scene = elbow();
  StochasticStudy study;
  study.replicates = 6;
  int covered = 0, total = 0;
  double error = 0.0, uncorrected = 0.0, stated = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const StochasticOutcome out = tests::stochastic_seed(scene, seed, study);
    for (std::size_t j = 0; j < out.result.subject.verdicts.size(); ++j) {
      const auto& v = out.result.subject.verdicts[j];
      const double truth = out.truth[static_cast<Eigen::Index>(j)];
      ++total;
      covered += covers(v, truth) ? 1 : 0;
      if (v.muscle == "biceps" && v.parameter == "strength") {
        error += (v.fitted - truth) / kSeeds;
        uncorrected += (out.result.x_uncorrected[static_cast<Eigen::Index>(j)] - truth) / kSeeds;
        stated += v.bias / kSeeds;
      }
    }
  }
  EXPECT_GE(covered, static_cast<int>(0.9 * total)) << covered << " of " << total;
  // Least squares are off by a fifth; most of it is stated, and taken off.
  EXPECT_LT(uncorrected, -0.15);
  EXPECT_LT(stated, -0.10);
  EXPECT_LT(std::abs(error), 0.5 * std::abs(uncorrected));
}

TEST(StochasticTwin, GainAndStrengthWithoutAnMvcAreNamedInEverySeed) {
  const data::Scene scene = elbow();
  StochasticStudy study;
  study.duration_s = 3.0;
  study.replicates = 4;
  study.free = {free(Quantity::strength, Scope::group), free(Quantity::gain)};
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const data::Subject subject = tests::stochastic_seed(scene, seed, study).result.subject;
    for (const auto& [channel, group] : {std::pair{"biceps", "biceps"},
                                         {"brachialis", "brachialis"},
                                         {"brachioradialis", "brachioradialis"},
                                         {"triceps_long", "triceps"},
                                         {"triceps_lateral", "triceps"}}) {
      const auto &gain = verdict(subject, channel, "gain"), &strength = verdict(subject, group, "strength");
      EXPECT_EQ(gain.verdict, "NOT IDENTIFIED") << "seed " << seed << "\n" << verdict_text(subject);
      EXPECT_EQ(strength.verdict, "NOT IDENTIFIED") << "seed " << seed << "\n" << verdict_text(subject);
      EXPECT_NE(gain.remark.find(std::string("one parameter with ") + group + " strength"),
                std::string::npos);
      EXPECT_NE(strength.remark.find(std::string("one parameter with ") + channel + " gain"),
                std::string::npos);
    }
  }
}

// C1 = C2, as CEINMS starts them: the residuals fix little more than their sum.
TEST(StochasticTwin, RecursionCoefficientsAreNeverAConfidentWrongPair) {
  data::Scene scene = elbow();
  for (data::SceneMuscle& m : scene.muscles)
    m.activation.time_constant_1_s = m.activation.time_constant_2_s = emg::time_constant(-0.5, 100.0);
  StochasticStudy study;
  study.duration_s = 3.0;
  study.replicates = 4;
  study.model.activation.form = emg::ActivationForm::recursive;
  study.model.recursion_rate_hz = 100.0;
  study.free = {free(Quantity::strength, Scope::group), free(Quantity::recursion_1, Scope::global),
                free(Quantity::recursion_2, Scope::global)};
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const data::Subject subject = tests::stochastic_seed(scene, seed, study).result.subject;
    for (const char* name : {"recursion_1", "recursion_2"}) {
      const auto& v = verdict(subject, "*", name);
      EXPECT_NE(v.remark.find("interchangeable with recursion_"), std::string::npos) << v.remark;
      EXPECT_NE(v.verdict, "identified") << "seed " << seed << "\n" << verdict_text(subject);
      EXPECT_TRUE(covers(v, -0.5)) << "seed " << seed << "\n" << verdict_text(subject);
    }
    EXPECT_EQ(verdict(subject, "*", "recursion_2").verdict, "NOT IDENTIFIED") << verdict_text(subject);
  }
}

}  // namespace
}  // namespace brachium::optimise
