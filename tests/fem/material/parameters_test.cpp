#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <map>

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

TEST(ParameterSets, HaveTheirPublishedNumbers) {
  const auto tissue = [](const std::string& name) {
    const FibrousTissue t = fibrous_tissue_named(name);
    return std::array{t.c1_pa, t.c2_pa, t.c3_pa, t.c4};
  };
  const auto bell = [](const std::string& name) {
    const ForceLength f = force_length_named(name, 1.4);
    return std::array{f.ascending_width, f.ascending_exponent, f.descending_width, f.descending_exponent};
  };
  EXPECT_EQ(fibrous_tissue_sets().size(), 3u);
  EXPECT_EQ(tissue("sprenger_muscle"),
            (std::array{3.56463903963e4, 3.859558659683e3, 3.05907e-4, 47.270456264135881}));
  EXPECT_EQ(tissue("roehrle_2017_muscle"), (std::array{3.56e4, 3.86e3, 3.57e-2, 42.6}));
  EXPECT_EQ(tissue("sprenger_tendon"), (std::array{2.31e6, 1.15, 7.99e6, 16.6}));
  EXPECT_EQ(force_length_sets().size(), 3u);
  EXPECT_EQ(bell("guenther_2007"), (std::array{0.57, 4.0, 0.14, 3.0}));
  EXPECT_EQ(bell("symmetric_wide"), (std::array{0.3, 4.0, 0.3, 4.0}));
  EXPECT_EQ(bell("narrow_2017"), (std::array{0.15, 2.0, 0.16, 4.0}));
  const std::map<std::string, double> optimum{
      {"sprenger", 1.4}, {"sprenger_early", 1.3}, {"sprenger_wide", 1.4}, {"roehrle_2017", 1.4}};
  EXPECT_EQ(muscle_tendon_sets().size(), optimum.size());
  for (const auto& [name, stretch] : optimum) {
    const MuscleTendon m = muscle_tendon_named(name);
    EXPECT_EQ(m.max_stress_pa, 0.3e6) << name;
    EXPECT_EQ(m.force_length.optimal_stretch, stretch) << name;
    EXPECT_EQ(m.tendon.c4, 16.6) << name;
    EXPECT_EQ(m.blending, Blending::energies) << name;
    EXPECT_EQ(m.active_stress, ActiveStress::nominal) << name;
  }
}

TEST(ParameterSets, SayWhereTheyComeFrom) {
  for (const auto& set : fibrous_tissue_sets()) EXPECT_FALSE(set.source.empty()) << set.name;
  for (const auto& set : force_length_sets()) EXPECT_FALSE(set.source.empty()) << set.name;
  for (const auto& set : muscle_tendon_sets()) EXPECT_FALSE(set.source.empty()) << set.name;
}

}  // namespace
}  // namespace brachium::fem::test
