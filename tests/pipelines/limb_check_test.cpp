// What `brachium check` says of definitions with a continuum limb: every mistake at once, before anything runs.

#include <gmock/gmock.h>

#include <fstream>

#include "pipelines/definition.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class LimbCheck : public ::testing::Test {
 protected:
  /// Mistakes of a definition whose stages' options stand where they are given.
  std::string check(const std::string& stages) {
    std::ofstream(folder_ / "study.toml") << "[pipeline]\ntitle = \"t\"\n" << stages;
    try {
      read_definition(folder_ / "study.toml", {}, catalogue(), StageChecks::run);
    } catch (const data::InputError& e) {
      return data::render(e.diagnostics());
    }
    return {};
  }
  static std::string map(const std::string& name, const std::string& more) {
    return "[[stage]]\nname = \"" + name + "\"\nrun = \"fem.muscle_map\"\nmesh = { belly_cells = 4 }\n" +
           more;
  }
  const std::filesystem::path folder_ = brachium::tests::scratch_dir();
  const std::string limb =
      "limb = \"" + (brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml").string() + "\"\n";
  const std::string grid = "angle_deg = [20, 60, 100, 140]\nactivation = [0, 1]\n";
};

TEST_F(LimbCheck, HasNothingToSayOfASoundMap) {
  EXPECT_EQ(check(map("a", limb + grid)), "");
}

TEST_F(LimbCheck, TellsMistakesOfAllStagesWithTheirPlaces) {
  const std::string said =
      check(map("a", limb + grid + "max_stress_Pa = { biceps = 1e5 }\npre_stretch = { bicepts = 1.1 }\n") +
            map("b", limb + "angle_deg = [5, 20, 60, 100]\nactivation = [0, 1]\nmuscles = [\"tricep\"]\n") +
            map("c", limb + "angle_deg = [20]\n") + map("e", limb + grid + "scale_to = \"subject\"\n"));
  EXPECT_THAT(said, AllOf(HasSubstr("error[missing-muscle]: the limb `Generic arm: biceps and triceps over a "
                                    "hinge` has no muscle `bicepts`\n"),
                          HasSubstr("study.toml:11:"), HasSubstr("error[limb-range]: `angle_deg`: "),
                          HasSubstr("error[no-match]: "), HasSubstr("error[missing-key]: `angle_deg` and "),
                          HasSubstr("error[missing-scene]: ")));
}

TEST_F(LimbCheck, TellsMistakesOfTheLimbsFileInThatFile) {
  std::ofstream(folder_ / "limb.toml") << "[limb]\ntitle = \"x\"\nsource = \"y\"\nrange_deg = [150, 10]\n";
  EXPECT_THAT(check(map("a", "limb = \"limb.toml\"\n" + grid)),
              AllOf(HasSubstr("error[out-of-range]: `range_deg` must be two increasing angles"),
                    HasSubstr("limb.toml:4:13")));
}

TEST_F(LimbCheck, LeavesOpenWhatFittedParametersWillDecide) {
  const std::string fit =
      "[[stage]]\nname = \"fit\"\nrun = \"optimise.muscle_forces\"\nmesh = { belly_cells = 4 }\n" + limb +
      "muscles = [\"biceps\"]\nreference = [{ muscle = \"biceps\", set = \"one\", angle_deg = [20, 80], "
      "activation = 1.0, force_N = [300, 400] }]\n";
  const std::string fitted =
      map("a", limb + grid + "pre_stretch = { biceps = 1.9 }\ninput = { fitted = \"fit\" }\n");
  const std::string free = "free = [{ parameter = \"pre_stretch\" }]\n";
  EXPECT_EQ(check(fit + free + fitted), "");
  EXPECT_THAT(check(fit + "free = [{ parameter = \"pre_stretch\", muscle = \"brachialis\" }]\n"),
              HasSubstr("has no muscle `brachialis`"));
  EXPECT_THAT(check(fit + "hold = [{ parameter = \"pre_stretched\", value = 1.1 }]\n" + free),
              HasSubstr("pre_stretched"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
