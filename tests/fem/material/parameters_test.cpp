#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "data/model/error.hpp"
#include "fem/material/parameter_sets.hpp"
#include "laws_under_test.hpp"

namespace brachium::fem::test {
namespace {

using testing::ElementsAre;

std::vector<std::string> complaints(const Material& material) {
  std::vector<std::string> list;
  try {
    check(material);
  } catch (const data::InputError& error) {
    for (const data::Diagnostic& d : error.diagnostics()) {
      EXPECT_EQ(d.code, "bad-parameter");
      list.push_back(d.message + "; " + d.help);
    }
  }
  return list;
}

TEST(MaterialCheck, AcceptsEveryNamedSetAndEveryLawUnderTest) {
  for (const auto& set : muscle_tendon_sets()) EXPECT_THAT(complaints(set.values), ElementsAre()) << set.name;
  for (const Case& c : all_cases()) EXPECT_THAT(complaints(c.material), ElementsAre()) << c.name;
}

TEST(MaterialCheck, RefusesWhatIsNotGiven) {
  EXPECT_THAT(complaints(NeoHooke{}),
              ElementsAre("`shear_modulus_pa` of material law `neo_hooke` is not given; it must be above 0"));
  EXPECT_EQ(complaints(MuscleTendon{}).size(), 14u);
  EXPECT_EQ(complaints(MooneyRivlin{}).size(), 2u);
  EXPECT_EQ(complaints(FungGuccione{}).size(), 4u);
  EXPECT_EQ(complaints(BlemkerMuscle{}).size(), 7u);
}

TEST(MaterialCheck, NamesLawParameterValueAndRange) {
  MuscleTendon m = muscle_tendon();
  m.tendon.c4 = 0.5;
  m.force_length.ascending_exponent = 1.0;
  m.max_stress_pa = -1.0;
  EXPECT_THAT(
      complaints(m),
      ElementsAre("`tendon.c4` of material law `muscle_tendon` is 0.5; it must be in [1, 200]",
                  "`max_stress_pa` of material law `muscle_tendon` is -1; it must be 0 or above",
                  "`force_length.ascending_exponent` of material law `muscle_tendon` is 1; it must be in "
                  "[1.2, 10]"));
  m = muscle_tendon();
  m.rate_dependent = true;
  m.force_velocity = {0.0, 0.25, 1.0};
  EXPECT_THAT(
      complaints(m),
      ElementsAre("`force_velocity.max_rate_per_s` of material law `muscle_tendon` is 0; it must be above 0",
                  "`force_velocity.eccentric_force` of material law `muscle_tendon` is 1; it must be in (1, "
                  "10]"));
  EXPECT_THAT(complaints(MooneyRivlin{0.0, 0.0, false}),
              ElementsAre("`c10_pa + c01_pa` of material law `mooney_rivlin` is 0; it must be above 0"));
  EXPECT_THAT(complaints(FungGuccione{2e3, 8.0, std::numeric_limits<double>::infinity(), 4.0, false}),
              ElementsAre("`bt` of material law `fung_guccione` is inf; it must be above 0"));
  EXPECT_THAT(complaints(BlemkerMuscle{500, 500, 0.05, 6.6, 1.4, 3e5, 1.4}),
              ElementsAre("`straightening_stretch` of material law `blemker_muscle` is 1.4; it must be above "
                          "`optimal_stretch` and at most 100"));
}

TEST(MaterialCheck, TakesAnInfiniteBulkModulusButNoneThatIsNotPositive) {
  EXPECT_NO_THROW(check(Volumetric{VolumetricLaw::quadratic, std::numeric_limits<double>::infinity()}));
  EXPECT_THROW(check(Volumetric{}), data::InputError);
  EXPECT_THROW(check(Volumetric{VolumetricLaw::quadratic, 0.0}), data::InputError);
}

TEST(ParameterSets, NameTheNearestWhenOneIsMissing) {
  try {
    muscle_tendon_named("sprengr");
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().code, "unknown-parameter-set");
    EXPECT_EQ(error.diagnostics().front().message, "there is no muscle-tendon set named `sprengr`");
    EXPECT_EQ(error.diagnostics().front().help, "did you mean `sprenger`?");
  }
  EXPECT_THROW(fibrous_tissue_named("fat"), data::InputError);
  EXPECT_THROW(force_length_named("bell", 1.4), data::InputError);
}

TEST(ParameterSets, SayWhereTheyComeFrom) {
  for (const auto& set : fibrous_tissue_sets()) EXPECT_FALSE(set.source.empty()) << set.name;
  for (const auto& set : force_length_sets()) EXPECT_FALSE(set.source.empty()) << set.name;
  for (const auto& set : muscle_tendon_sets()) EXPECT_FALSE(set.source.empty()) << set.name;
}

}  // namespace
}  // namespace brachium::fem::test
