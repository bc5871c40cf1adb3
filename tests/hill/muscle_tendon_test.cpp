#include "hill/muscle_tendon.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "data/model/error.hpp"

namespace brachium::hill {
namespace {

data::MuscleParameters brachialis() {
  data::MuscleParameters p;
  p.max_isometric_force_N = 987.26;
  p.optimal_fibre_length_m = 0.0858;
  p.tendon_slack_length_m = 0.0535;
  return p;
}

TEST(MuscleTendon, NamesEveryParameterOutsideItsRange) {
  data::MuscleParameters p = brachialis();
  p.max_isometric_force_N = -1.0;
  p.optimal_fibre_length_m = std::nan("");
  p.pennation_at_optimal_rad = 1.6;
  p.strength = 0.0;
  MuscleModelOptions options;
  options.optimal_length_coupling = 1.5;
  try {
    MuscleTendon("BRA", p, options);
    FAIL();
  } catch (const data::InputError& e) {
    ASSERT_EQ(e.diagnostics().size(), 5u);
    EXPECT_EQ(e.diagnostics()[0].code, "bad-parameter");
    EXPECT_EQ(e.diagnostics()[0].message, "`max_isometric_force_N` of muscle `BRA` is -1");
    EXPECT_EQ(e.diagnostics()[0].help, "it must be positive and finite");
    EXPECT_EQ(e.diagnostics()[1].message, "`optimal_fibre_length_m` of muscle `BRA` is nan");
    EXPECT_EQ(e.diagnostics()[2].message, "`pennation_at_optimal_rad` of muscle `BRA` is 1.6");
    EXPECT_EQ(e.diagnostics()[2].help, "it must be in [0, pi/2)");
    EXPECT_EQ(e.diagnostics()[3].message, "`strength` of muscle `BRA` is 0");
    EXPECT_EQ(e.diagnostics()[4].message, "`optimal_length_coupling` of muscle `BRA` is 1.5");
  }
}

TEST(MuscleTendon, AnElasticTendonNeedsALength) {
  data::MuscleParameters p = brachialis();
  p.tendon_slack_length_m = 0.0;
  MuscleModelOptions options;
  EXPECT_NO_THROW(MuscleTendon("BRA", p, options));
  options.tendon = TendonKind::elastic;
  try {
    MuscleTendon("BRA", p, options);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].message, "`tendon_slack_length_m` of muscle `BRA` is 0");
    EXPECT_EQ(e.diagnostics()[0].help, "it must be positive and finite for an elastic tendon");
  }
}

TEST(MuscleModelOptions, ChoicesGoToTextAndBack) {
  for (const auto kind : {TendonKind::rigid, TendonKind::elastic})
    EXPECT_EQ(parse_tendon(to_string(kind)), kind);
  for (const auto kind : {FibreVelocity::zero_lag, FibreVelocity::causal, FibreVelocity::none}) {
    EXPECT_EQ(parse_fibre_velocity(to_string(kind)), kind);
  }
  for (const auto kind : {Compatibility::none, Compatibility::ceinms})
    EXPECT_EQ(parse_compatibility(to_string(kind)), kind);
  try {
    parse_tendon("elastik");
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].code, "unknown-choice");
    EXPECT_EQ(e.diagnostics()[0].message, "`elastik` is not a kind of tendon");
    EXPECT_EQ(e.diagnostics()[0].help, "did you mean `elastic`?");
  }
}

}  // namespace
}  // namespace brachium::hill
