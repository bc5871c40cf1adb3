#include "fem/limb/body_parameters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "fem/limb/upper_limb.hpp"

namespace brachium::fem {
namespace {

TEST(BodyParameters, AnswerWhatWasSetAndLeaveTheOthers) {
  for (const BodyParameter& set : body_parameters()) {
    MuscleBody body = generic_arm().triceps;
    const double value = set.lower + 0.37 * (set.upper - set.lower);
    std::vector<double> before;
    for (const BodyParameter& p : body_parameters()) before.push_back(body_value(body, p.name));
    set_body_value(body, set.name, value);
    EXPECT_NEAR(body_value(body, set.name), value, 1e-12 * std::abs(value)) << set.name;
    for (std::size_t i = 0; i < before.size(); ++i) {
      const std::string& name = body_parameters()[i].name;
      if (name == set.name) continue;
      // Volume is length, radius and shape of the profile; setting it moves the radius.
      const bool size =
          set.name == "belly_length_m" || set.name == "greatest_radius_m" || set.name == "end_radius_norm";
      if ((name == "volume_m3" && size) || (name == "greatest_radius_m" && set.name == "volume_m3")) continue;
      EXPECT_NEAR(body_value(body, name), before[i], 1e-12 * std::abs(before[i]))
          << name << " by " << set.name;
    }
  }
}

TEST(BodyParameters, PassiveStretchIsWhereFibresBearATenthOfAMegapascal) {
  MuscleBody body = generic_arm().biceps;
  set_body_value(body, "passive_exponent", 6.0);
  set_body_value(body, "passive_stretch", 1.3);
  const FibrousTissue& t = body.material.muscle;
  EXPECT_NEAR(t.c3_pa / 1.3 * (std::pow(1.3, t.c4) - 1.0), 1e5, 1e-8);
}

TEST(BodyParameters, ScaleTheProfileAsAWhole) {
  MuscleBody body = generic_arm().biceps;
  const std::vector<double> before = body.profile_m;
  set_body_value(body, "greatest_radius_m", 2.0 * *std::max_element(before.begin(), before.end()));
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(body.profile_m[i], 2.0 * before[i], 1e-15);
}

TEST(BodyParameters, VolumeIsThatOfTheProfileWhateverTheOrderOfWhatIsSet) {
  MuscleBody cylinder = generic_arm().biceps;
  cylinder.profile_m = {0.01, 0.01, 0.01};
  EXPECT_NEAR(body_value(cylinder, "volume_m3"), 3.14159265358979 * 1e-4 * cylinder.belly_length_m, 1e-15);
  const std::vector<std::pair<std::string, double>> values{
      {"volume_m3", 2e-4}, {"belly_length_m", 0.18}, {"end_radius_norm", 0.5}};
  MuscleBody body = generic_arm().biceps, reversed = body;
  set_body_values(body, values);
  set_body_values(reversed, {values.rbegin(), values.rend()});
  for (const auto& [name, value] : values) {
    EXPECT_NEAR(body_value(body, name), value, 1e-12 * value) << name;
    EXPECT_NEAR(body_value(reversed, name), value, 1e-12 * value) << name;
  }
  try {
    set_body_values(body, {{"volume_m3", 2e-4}, {"greatest_radius_m", 0.02}});
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().code, "contradiction");
  }
}

TEST(BodyParameters, NameTheNearestOfAnUnknownOne) {
  try {
    body_value(generic_arm().biceps, "pre_strech");
    FAIL();
  } catch (const data::InputError& error) {
    EXPECT_EQ(error.diagnostics().front().code, "unknown-body-parameter");
    EXPECT_NE(error.diagnostics().front().help.find("pre_stretch"), std::string::npos);
  }
}

}  // namespace
}  // namespace brachium::fem
