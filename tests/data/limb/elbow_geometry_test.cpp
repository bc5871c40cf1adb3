#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "data/io/scene_file.hpp"
#include "data/limb/muscle_path.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/python.hpp"

namespace {
using namespace brachium;

constexpr double degree = std::numbers::pi / 180.0;

std::filesystem::path scene_path(const std::string& name) {
  return tests::source_dir() / "pipelines" / "scenes" / name;
}

struct Elbow {
  data::Scene scene;
  limb::MusclePath path(const data::SceneMuscle& m) const {
    return {m.name, m.path, scene.coordinates.at(0)};
  }
  limb::MusclePath path(const std::string& name) const { return path(scene.muscle(name)); }
};

class ShippedElbow : public testing::TestWithParam<const char*> {
 protected:
  const Elbow elbow{io::read_scene(scene_path(GetParam()))};
};
INSTANTIATE_TEST_SUITE_P(, ShippedElbow, testing::Values("elbow.toml", "elbow_twin.toml"), [](const auto& p) {
  return std::string(p.param) == "elbow.toml" ? "Curls" : "Twin";
});

TEST_P(ShippedElbow, ExtendsByTheTricepsAndFlexesByTheOthersOverItsWholeRange) {
  for (const auto& m : elbow.scene.muscles) {
    const auto path = elbow.path(m);
    const double sign = m.group == "triceps" ? -1.0 : 1.0;
    for (double s = 0.0; s <= 1.0; s += 0.005) {
      const double q = std::lerp(path.lower_rad(), path.upper_rad(), s);
      EXPECT_GT(sign * path(q).moment_arm_m, 0.005) << m.name << " at " << q / degree << " deg";
    }
  }
}

TEST_P(ShippedElbow, HasMomentArmsThatAreTheSlopesOfItsLengths) {
  const double h = 1e-5;
  for (const auto& m : elbow.scene.muscles) {
    const auto path = elbow.path(m);
    EXPECT_TRUE(path.consistency().both_given) << m.name;
    EXPECT_LT(path.consistency().worst_disagreement_m, 1e-12) << m.name;
    for (double q = path.lower_rad() + h; q < path.upper_rad() - h; q += 5.0 * degree) {
      const double slope = (path(q + h).length_m - path(q - h).length_m) / (2.0 * h);
      EXPECT_NEAR(path(q).moment_arm_m, -slope, 1e-9) << m.name << " at " << q / degree << " deg";
      EXPECT_GT(std::abs(path(q).moment_arm_m - slope), 0.01) << "the wrong sign would not be seen";
    }
  }
}

// A rigid tendon: l = hypot(L - l_slack, l_opt sin(pennation)), the fibre keeping its thickness.
TEST_P(ShippedElbow, KeepsItsFibresBetween40And145PercentOfTheirOptimum) {
  for (const auto& m : elbow.scene.muscles) {
    const auto path = elbow.path(m);
    const auto& p = m.parameters;
    for (double q = 0.0; q <= 150.0; q += 1.0) {
      const double along = path(q * degree).length_m - p.tendon_slack_length_m;
      ASSERT_GT(along, 0.0) << m.name << " is shorter than its tendon at " << q << " deg";
      const double fibre = std::hypot(along / p.optimal_fibre_length_m, std::sin(p.pennation_at_optimal_rad));
      EXPECT_GT(fibre, 0.40) << m.name << " at " << q << " deg";
      EXPECT_LT(fibre, 1.45) << m.name << " at " << q << " deg";
    }
  }
}

// Means of ten arms: Murray, Buchanan & Delp 2000, doi:10.1016/S0021-9290(00)00051-8.
TEST_P(ShippedElbow, ReachesTheLargestMeasuredMomentArmsWithinATenth) {
  const auto largest = [&](const std::string& name) {
    const auto path = elbow.path(name);
    double r = 0.0;
    for (double q = 0.0; q <= 130.0; q += 1.0) r = std::max(r, std::abs(path(q * degree).moment_arm_m));
    return r;
  };
  EXPECT_NEAR(largest("BIClong"), 0.047, 0.0047);
  EXPECT_NEAR(largest("TRIlong"), 0.023, 0.0023);
  EXPECT_NEAR(largest("BRD"), 0.077, 0.0077);
}

// arm26 lies with the recordings.
struct Script {
  std::filesystem::path model = tests::sessions_dir() / "opensim" / "arm26";
  int operator()(const std::string& arguments) const {
    return std::system(fmt::format("/usr/bin/python3 '{}' '{}' {} > /dev/null",
                                   (tests::source_dir() / "tests/data/limb/elbow_geometry.py").string(),
                                   (model / "arm26.osim").string(), arguments)
                           .c_str());
  }
};

TEST(ElbowGeometry, IsReproducedFromArm26AndAChangedCoefficientIsNoticed) {
  BRACHIUM_NEEDS_SESSIONS();
  BRACHIUM_NEEDS_SCIPY();
  const Script script;
  EXPECT_EQ(script(fmt::format("--check '{}' '{}'", scene_path("elbow.toml").string(),
                               scene_path("elbow_twin.toml").string())),
            0);
  std::ifstream file(scene_path("elbow.toml"));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::string key = "length_polynomial_m = [0.";
  const auto found = text.find(key);
  ASSERT_NE(found, std::string::npos);
  const auto at = found + key.size() + 3;  // a fourth digit is put in: less than 1 mm
  const auto changed = tests::scratch_dir() / "elbow.toml";
  std::ofstream(changed) << text.substr(0, at) << '9' << text.substr(at);
  EXPECT_NE(script(fmt::format("--check '{}'", changed.string())), 0);
}

TEST(ElbowGeometry, ComputesTheLengthsAndTheElbowMomentThatOpenSimComputes) {
  BRACHIUM_NEEDS_SESSIONS();
  BRACHIUM_NEEDS_SCIPY();
  const Script script;
  EXPECT_EQ(script(fmt::format("--validate '{}'", (script.model / "OutputReference").string())), 0);
}

}  // namespace
