#include "data/limb/drive.hpp"

#include <gtest/gtest.h>

namespace {
using namespace brachium;

data::SceneMuscle by_channel(const std::string& name, std::map<std::string, double> channels) {
  data::SceneMuscle m;
  m.name = name;
  m.drive.kind = data::MuscleDrive::Kind::channels;
  m.drive.channels = std::move(channels);
  return m;
}

data::SceneMuscle by_rule(const std::string& name, const std::string& rule,
                          std::vector<std::string> muscles) {
  data::SceneMuscle m;
  m.name = name;
  m.drive.kind = data::MuscleDrive::Kind::rule;
  m.drive.rule = rule;
  m.drive.muscles = std::move(muscles);
  return m;
}

TEST(DriveMap, ResolvesChannelsRulesAndRulesOfRules) {
  data::Scene scene;
  scene.muscles = {by_channel("A", {{"one", 0.75}, {"two", 0.25}}), by_rule("B", "mean_of", {"A", "C"}),
                   by_rule("C", "same_as", {"D"}), by_channel("D", {{"two", 1.0}}), data::SceneMuscle{}};
  scene.muscles.back().name = "E";
  const std::vector<std::string> available{"spare", "two", "one"};
  const limb::DriveMap map = limb::drive_map(scene, available);
  EXPECT_EQ(map.channels, (std::vector<std::string>{"two", "one"}));
  EXPECT_EQ(map.undriven, std::vector<std::string>{"E"});
  Eigen::MatrixXd expected(5, 2);
  expected << 0.25, 0.75, 0.625, 0.375, 1, 0, 1, 0, 0, 0;
  EXPECT_EQ(map.weights, expected);
  const Eigen::MatrixXd channels = Eigen::MatrixXd::Random(2, 7);
  EXPECT_EQ(limb::mix_excitations(map, channels), expected * channels);
  EXPECT_EQ(limb::drive_map(scene).channels, (std::vector<std::string>{"one", "two"}));
}

TEST(DriveMap, NamesEveryMistakeAtOnce) {
  data::Scene scene;
  scene.muscles = {by_channel("A", {{"biseps", 1.0}}),
                   by_rule("B", "same_as", {"C"}),
                   by_rule("C", "same_as", {"B"}),
                   by_rule("D", "mena_of", {"A", "B"}),
                   by_rule("E", "same_as", {"X"}),
                   by_rule("F", "same_as", {"G"}),
                   data::SceneMuscle{}};
  scene.muscles.back().name = "G";
  const std::vector<std::string> available{"biceps"};
  try {
    limb::drive_map(scene, available);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(data::render(e.diagnostics()),
              "error[unmapped-channel]: muscle `A` is driven by channel `biseps`, which is not recorded\n"
              "  help: did you mean `biceps`?\n"
              "error[rule-cycle]: the drive rules of `B` form a cycle: B -> C -> B\n"
              "  help: drive one of them by channels\n"
              "error[unknown-rule]: `mena_of` is not a drive rule (muscle `D`)\n"
              "  help: did you mean `mean_of`?\n"
              "error[unknown-muscle]: the drive rule of muscle `E` names `X`, which is not in the scene\n"
              "  help: did you mean `A`?\n"
              "error[undriven-source]: the drive rule of muscle `F` names `G`, which has no drive itself\n");
  }
}

}  // namespace
