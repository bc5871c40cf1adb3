#include "data/io/scene_file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "data/limb/drive.hpp"
#include "data/limb/muscle_path.hpp"
#include "tests/support/paths.hpp"

namespace {
using namespace brachium;

constexpr double degree = std::numbers::pi / 180.0;

const char* const head = R"([scene]
title = "t"
wanted = ["elbow.moment"]
body_mass_kg = 80.0
body_mass_source = "measured"
[[coordinate]]
name = "elbow"
range_deg = [0, 150]
)";

std::string muscle(const std::string& name, const std::string& drive, const std::string& more = {}) {
  return "[[muscle]]\nname = \"" + name + "\"\nsource = \"s\"\ndrive = " + drive + "\n" + more +
         "parameters = { max_isometric_force_N = 500, optimal_fibre_length_m = 0.1, tendon_slack_length_m = "
         "0.2 }\n"
         "geometry = { length_polynomial_m = [0.35, -0.03] }\n";
}

data::Scene parse(const std::string& text, const std::vector<std::string>& channels = {}) {
  return io::parse_scene(text, "scene.toml", ".", channels);
}

std::string errors(const std::string& text, const std::vector<std::string>& channels = {}) {
  try {
    parse(text, channels);
  } catch (const data::InputError& e) {
    return data::render(e.diagnostics());
  }
  return "nothing was thrown";
}

TEST(SceneFile, ReadsEveryPartInSi) {
  const data::Scene s = parse(std::string(head) + R"(
[[segment]]
name = "hand"
mass_fraction_of_body = 0.006
mass_relative_sd = 0.1
length_m = 0.2
offset_m = 0.25
centre_of_mass_fraction = 0.5
radius_of_gyration_fraction = 0.3
source = "s"
[[load]]
name = "dumbbell"
mass_condition = "load_mass_kg"
distance_m = 0.33
distance_sd_m = 0.02
source = "s"
)" +
                              muscle("BIC", "{ channels = { biceps = 0.8, other = 0.2 } }",
                                     "group = \"flexors\"\nactivation = { delay_s = 0.05 }\n"));
  EXPECT_EQ(s.coordinate("elbow").angle_signal, "elbow");
  EXPECT_DOUBLE_EQ(s.coordinate("elbow").upper_rad, 150.0 * degree);
  ASSERT_EQ(s.segments.size(), 1u);
  EXPECT_DOUBLE_EQ(s.segments[0].mass_kg, 0.48);
  EXPECT_DOUBLE_EQ(s.segments[0].body_mass_fraction, 0.006);
  EXPECT_DOUBLE_EQ(s.segments[0].centre_of_mass_m, 0.35);
  EXPECT_DOUBLE_EQ(s.segments[0].inertia_kg_m2, 0.48 * 0.06 * 0.06);
  EXPECT_EQ(s.segments[0].coordinate, "elbow");
  EXPECT_EQ(s.loads.at(0).mass_condition, "load_mass_kg");
  EXPECT_EQ(s.muscle("BIC").group, "flexors");
  EXPECT_EQ(s.muscle("BIC").activation.delay_s, 0.05);
  EXPECT_EQ(s.muscle("BIC").activation.time_constant_1_s, 0.015);
  EXPECT_EQ(s.muscle("BIC").drive.channels.at("other"), 0.2);
  EXPECT_TRUE(s.notes.empty());
}

TEST(SceneFile, ReportsEveryMistakeOfAFileAtOnceWithItsPlace) {
  EXPECT_EQ(errors(std::string(head) + R"(
[[segment]]
name = "forearm"
mass_kg = -1.2
centre_of_mas_m = 0.1
centre_of_mass_m = 0.11
inertia_kg_m2 = 0.01
source = "s"
[[segment]]
name = "forearm"
mass_kg = 1.0
mass_fraction_of_body = 0.02
centre_of_mass_fraction = 0.4
inertia_kg_m2 = "much"
source = "s"
)"),
            "error[out-of-range]: `mass_kg` of segment `forearm` must be greater than 0, not -1.2\n"
            "  --> scene.toml:12:11\n"
            "   |\n"
            "12 | mass_kg = -1.2\n"
            "   |           ^^^^\n"
            "error[unknown-key]: `centre_of_mas_m` is not a key of [[segment]]\n"
            "  --> scene.toml:13:1\n"
            "   |\n"
            "13 | centre_of_mas_m = 0.1\n"
            "   | ^^^^^^^^^^^^^^^ did you mean `centre_of_mass_m`?\n"
            "error[duplicate-segment]: segment `forearm` is defined twice\n"
            "  --> scene.toml:18:8\n"
            "   |\n"
            "18 | name = \"forearm\"\n"
            "   |        ^^^^^^^^^ names are unique in a scene\n"
            "error[contradiction]: segment `forearm` takes only one of `mass_kg` or `mass_fraction_of_body`\n"
            "  --> scene.toml:19:11\n"
            "   |\n"
            "19 | mass_kg = 1.0\n"
            "   |           ^^^\n"
            "error[missing-key]: `centre_of_mass_fraction` of segment `forearm` needs `length_m`\n"
            "  --> scene.toml:21:27\n"
            "   |\n"
            "21 | centre_of_mass_fraction = 0.4\n"
            "   |                           ^^^\n"
            "error[wrong-type]: `inertia_kg_m2` of [[segment]] must be a number, not a text\n"
            "  --> scene.toml:22:17\n"
            "   |\n"
            "22 | inertia_kg_m2 = \"much\"\n"
            "   |                 ^^^^^^\n");
}

// The first finding only: code and message.
std::string first(const std::string& text, const std::vector<std::string>& channels = {}) {
  const std::string all = errors(text, channels);
  return all.substr(0, all.find('\n'));
}

TEST(SceneFile, NamesWhatIsWrongWithTheFrame) {
  EXPECT_EQ(first("wnted = 1\n"), "error[missing-key]: the table [scene] is missing");
  EXPECT_EQ(first("[scene]\ntitle = \"t\"\n[[coordinate]]\nname = \"e\"\nrange_deg = [0, 1]\n"),
            "error[missing-key]: `wanted` is missing in `scene`");
  EXPECT_EQ(first("[scene]\ntitle = \"t\"\nwanted = []\n[[coordinate]]\nname = \"e\"\nrange_deg = [0, 1]\n"),
            "error[out-of-range]: `wanted` must name at least one quantity");
  EXPECT_EQ(errors("[scene]\ntitle = \"t\"\nwanted = [\"elbw.moment\"]\n[[coordinate]]\nname = "
                   "\"elbow\"\nrange_deg = [0, 1]\n"),
            "error[unknown-quantity]: `elbw.moment` is not a quantity this scene can give\n"
            "  --> scene.toml:3:11\n"
            "  |\n"
            "3 | wanted = [\"elbw.moment\"]\n"
            "  |           ^^^^^^^^^^^^^ did you mean `elbow.moment`?\n");
  EXPECT_EQ(first("[scene]\ntitle = \"t\"\nwanted = [\"e.moment\"]\n[[coordinate]]\nname = \"e\"\nrange_deg "
                  "= [90, 10]\n"),
            "error[out-of-range]: `range_deg` of coordinate `e` must be two increasing angles");
  EXPECT_EQ(first("[scene]\ntitle = \"t\"\nwanted = [\"e.moment\"]\nbody_mass_kg = 0\nbody_mass_source = "
                  "\"s\"\n[[coordinate]]\n"
                  "name = \"e\"\nrange_deg = [0, 10]\n"),
            "error[out-of-range]: `body_mass_kg` of the scene must be greater than 0, not 0");
  EXPECT_EQ(first("[scene]\ntitle = \"t\"\nwanted = [\"e.moment\"]\nbody_mass_kg = 70\n[[coordinate]]\n"
                  "name = \"e\"\nrange_deg = [0, 10]\n"),
            "error[missing-key]: `body_mass_source` is missing in `scene`");
  EXPECT_EQ(first(std::string(head) + "parent = \"shoulder\"\ndistance_from_parent_m = 0.3\n"),
            "error[unknown-coordinate]: coordinate `elbow` has the parent `shoulder`, which is not defined "
            "before it");
  EXPECT_EQ(first(std::string(head) + "[[load]]\nname = \"l\"\ndistance_m = 0.3\nsource = \"s\"\n"),
            "error[missing-key]: load `l` needs `mass_kg` or `mass_condition`");
  EXPECT_EQ(
      first(std::string(head) + "[[load]]\nname = \"l\"\nmass_kg = -2\ndistance_m = 0.3\nsource = \"s\"\n"),
      "error[out-of-range]: `mass_kg` of load `l` must be 0 or greater, not -2");
  EXPECT_EQ(first("[scene\n").substr(0, 19), "error[toml-syntax]:");
  EXPECT_EQ(
      [] {
        try {
          io::read_scene("no/such/scene.toml");
        } catch (const data::InputError& e) {
          return data::render(e.diagnostics());
        }
        return std::string();
      }(),
      "error[missing-file]: cannot read the scene `no/such/scene.toml`\n  help: check the path\n");
}

TEST(SceneFile, AnEmptyFileIsToldWhatASceneNeeds) {
  EXPECT_EQ(errors(""),
            "error[missing-key]: the table [scene] is missing\n"
            "  --> scene.toml:1:1\n"
            "error[missing-key]: the scene has no [[coordinate]]\n"
            "  --> scene.toml:1:1\n");
}

TEST(SceneFile, ANumberInAnotherUnitIsToldItsUnit) {
  EXPECT_EQ(errors(std::string(head) + "[[segment]]\nname = \"hand\"\nmass_g = 400\nlength_mm = 200\n"
                                       "centre_of_mass_m = 0.1\ninertia_kg_m2 = 0.01\nsource = \"s\"\n"),
            "error[missing-key]: segment `hand` needs `mass_kg` or `mass_fraction_of_body`\n"
            "  --> scene.toml:9:1\n"
            "  |\n"
            "9 | [[segment]]\n"
            "  | ^^^^^^^^^^^\n"
            "error[wrong-unit]: `mass_g` is not a key of [[segment]]: it is given in kg\n"
            "  --> scene.toml:11:1\n"
            "   |\n"
            "11 | mass_g = 400\n"
            "   | ^^^^^^ write `mass_kg`, with the value in kg\n"
            "error[wrong-unit]: `length_mm` is not a key of [[segment]]: it is given in m\n"
            "  --> scene.toml:12:1\n"
            "   |\n"
            "12 | length_mm = 200\n"
            "   | ^^^^^^^^^ write `length_m`, with the value in m\n");
}

TEST(SceneFile, NamesWhatIsWrongWithAMuscle) {
  const std::string good = muscle("BIC", "{ channels = { biceps = 1 } }");
  const auto with = [&](const std::string& what, const std::string& by) {
    std::string text = std::string(head) + good;
    const auto at = text.find(what);
    EXPECT_NE(at, std::string::npos);
    return text.replace(at, what.size(), by);
  };
  EXPECT_EQ(first(std::string(head) + good + good), "error[duplicate-muscle]: muscle `BIC` is defined twice");
  EXPECT_EQ(first(with("source = \"s\"\ndrive", "drive")),
            "error[missing-key]: `source` is missing in [[muscle]]");
  EXPECT_EQ(first(with("= 500", "= 0")),
            "error[out-of-range]: `max_isometric_force_N` of muscle `BIC` must be greater than 0, not 0");
  EXPECT_EQ(first(with("optimal_fibre_length_m = 0.1", "optimal_fibre_length_m = nan")),
            "error[out-of-range]: `optimal_fibre_length_m` must be a finite number");
  EXPECT_EQ(first(with("= 0.2 }", "= 0.2, pennation_at_optimal_deg = 90 }")),
            "error[out-of-range]: `pennation_at_optimal_deg` of muscle `BIC` must be below 90, not 90");
  EXPECT_EQ(first(with("= 0.2 }", "= 0.2, penation_at_optimal_deg = 9 }")),
            "error[unknown-key]: `penation_at_optimal_deg` is not a key of `parameters` of muscle `BIC`");
  EXPECT_EQ(first(with("geometry", "activation = { shape = -3 }\ngeometry")),
            "error[out-of-range]: `shape` of muscle `BIC` must be above -3 and at most 0.12, not -3");
  EXPECT_EQ(first(with("geometry", "activation = { delay_s = -0.01 }\ngeometry")),
            "error[out-of-range]: `delay_s` of muscle `BIC` must be 0 or greater, not -0.01");
  EXPECT_EQ(first(with("length_polynomial_m = [0.35, -0.03]", "")),
            "error[missing-key]: the geometry of muscle `BIC` must be given in one way");
  EXPECT_EQ(first(with("-0.03]", "-0.03], moment_arm_polynomial_m = [0.04]")),
            "error[inconsistent-geometry]: length and moment arm of muscle `BIC` disagree: at 0 deg the "
            "moment arm is 40 mm, but "
            "-dL/dq is 30 mm; they differ by 10 mm, more than 1 mm");
  EXPECT_EQ(
      first(with("length_polynomial_m = [0.35, -0.03]", "angle_deg = [10, 150], length_m = [0.3, 0.28]")),
      "error[bad-geometry]: the table of muscle `BIC` covers 10 to 150 deg, less than the range 0 to 150 deg "
      "of coordinate "
      "`elbow`");
  EXPECT_EQ(first(with("{ channels = { biceps = 1 } }", "{ }")),
            "error[missing-key]: the drive of muscle `BIC` must be given in one way");
  EXPECT_EQ(first(with("{ channels = { biceps = 1 } }", "{ same_as = \"X\", none = \"deep\" }")),
            "error[contradiction]: the drive of muscle `BIC` must be given in one way");
  EXPECT_EQ(
      first(with("biceps = 1", "biceps = -1")),
      "error[out-of-range]: the weight of channel `biceps` for muscle `BIC` must be 0 or greater, not -1");
}

TEST(SceneFile, NamesUnmappedChannelsUnknownRuleMusclesAndCyclesWhereTheyStand) {
  const std::string text = std::string(head) + muscle("BIC", "{ channels = { biseps = 1 } }") +
                           muscle("BRA", "{ mean_of = [\"BIC\", \"BRX\"] }") +
                           muscle("A", "{ same_as = \"B\" }") + muscle("B", "{ same_as = \"A\" }");
  EXPECT_EQ(errors(text, {"biceps", "triceps"}),
            "error[unmapped-channel]: muscle `BIC` is driven by channel `biseps`, which is not recorded\n"
            "  --> scene.toml:12:24\n"
            "   |\n"
            "12 | drive = { channels = { biseps = 1 } }\n"
            "   |                        ^^^^^^ did you mean `biceps`?\n"
            "error[unknown-muscle]: the drive rule of muscle `BRA` names `BRX`, which is not in the scene\n"
            "  --> scene.toml:18:29\n"
            "   |\n"
            "18 | drive = { mean_of = [\"BIC\", \"BRX\"] }\n"
            "   |                             ^^^^^ did you mean `BRA`?\n"
            "error[rule-cycle]: the drive rules of `A` form a cycle: A -> B -> A\n"
            "  --> scene.toml:24:9\n"
            "   |\n"
            "24 | drive = { same_as = \"B\" }\n"
            "   |         ^^^^^^^^^^^^^^^^^ drive one of them by channels\n");
}

TEST(SceneFile, LeavesOutWhatNoWantedQuantityDependsOnAndSaysSo) {
  std::string text = head;
  text +=
      "[[coordinate]]\nname = \"wrist\"\nrange_deg = [-60, 60]\nparent = \"elbow\"\ndistance_from_parent_m = "
      "0.25\n"
      "[[coordinate]]\nname = \"knee\"\nrange_deg = [0, 90]\n"
      "[[segment]]\nname = \"hand\"\ncoordinate = \"wrist\"\nmass_kg = 0.4\ncentre_of_mass_m = "
      "0.07\ninertia_kg_m2 = 0.001\nsource = \"s\"\n"
      "[[segment]]\nname = \"shank\"\ncoordinate = \"knee\"\nmass_kg = 3\ncentre_of_mass_m = "
      "0.2\ninertia_kg_m2 = 0.05\nsource = \"s\"\n";
  const auto on = [](std::string m, const std::string& coordinate) {
    const std::string key = "geometry = { ";
    return m.replace(m.find(key), key.size(), key + "coordinate = \"" + coordinate + "\", ");
  };
  text += on(muscle("BIC", "{ same_as = \"FCR\" }"), "elbow") +
          on(muscle("FCR", "{ channels = { c = 1 } }"), "wrist") +
          on(muscle("ECR", "{ channels = { d = 1 } }"), "wrist") +
          on(muscle("ANC", "{ none = \"too deep for surface EMG\" }"), "elbow") +
          on(muscle("VAS", "{ channels = { e = 1 } }"), "knee");
  const data::Scene s = parse(text);
  std::vector<std::string> notes;
  for (const auto& n : s.notes) notes.push_back(n.code + ": " + n.message);
  EXPECT_EQ(notes,
            (std::vector<std::string>{
                "left-out: muscle `ECR` is left out: no wanted quantity (elbow.moment) depends on it",
                "left-out: muscle `VAS` is left out: no wanted quantity (elbow.moment) depends on it",
                "left-out: segment `shank` is left out: no wanted quantity (elbow.moment) depends on it",
                "left-out: coordinate `knee` is left out: no wanted quantity (elbow.moment) depends on it",
                "undriven-muscle: muscle `ANC` has no drive and is modelled as passive: too deep for surface "
                "EMG"}));
  EXPECT_EQ(s.muscles.size(), 3u) << "FCR stays: the rule of BIC needs it";
  EXPECT_EQ(s.segments.size(), 1u) << "the hand hangs on the elbow";
}

TEST(SceneFile, ReadsGeometryFromACsvBesideTheScene) {
  const auto dir = tests::scratch_dir();
  std::ofstream(dir / "bic.csv")
      << "\xEF\xBB\xBF# a comment\r\nangle_deg,moment_arm_mm\r\n0,10\r\n75,40\r\n150,20\r\n";
  std::ofstream(dir / "bad.csv") << "angle_deg,length_m\n0,0.3\n90,x\n";
  std::ofstream(dir / "short.csv") << "angle_deg,length_m\n0\n";
  std::ofstream(dir / "column.csv") << "angle_deg,lenght_m\n0,0.3\n";
  std::ofstream(dir / "empty.csv");
  const auto text = [](const std::string& file) {
    std::string m = muscle("BIC", "{ channels = { c = 1 } }");
    const std::string key = "length_polynomial_m = [0.35, -0.03]";
    return head + m.replace(m.find(key), key.size(),
                            "csv = \"" + file + "\", reference_length_m = 0.38, reference_angle_deg = 0");
  };
  const data::Scene s = io::parse_scene(text("bic.csv"), "scene.toml", dir);
  EXPECT_EQ(s.muscle("BIC").path.moment_arm_m, (std::vector<double>{0.010, 0.040, 0.020}));
  EXPECT_DOUBLE_EQ(
      limb::MusclePath("BIC", s.muscle("BIC").path, s.coordinate("elbow"))(75.0 * degree).moment_arm_m, 0.04);
  const auto message = [&](const std::string& file) {
    try {
      io::parse_scene(text(file), "scene.toml", dir);
    } catch (const data::InputError& e) {
      const auto& d = e.diagnostics().front();
      return fmt::format("{}:{}: {}", d.code, d.where ? d.where->line : -1, d.message);
    }
    return std::string("nothing was thrown");
  };
  EXPECT_EQ(message("bad.csv"), "not-a-number:3: `x` in column `length_m` is not a finite number");
  EXPECT_EQ(message("short.csv"), "truncated:2: a row of 1 cells under 2 columns");
  EXPECT_EQ(message("column.csv"), "unknown-column:1: `lenght_m` is not a column of a geometry table");
  EXPECT_EQ(message("empty.csv"),
            fmt::format("empty-file:0: the geometry table `{}` has no angles", (dir / "empty.csv").string()));
  EXPECT_EQ(message("none.csv"),
            fmt::format("missing-file:14: cannot read the geometry table `{}`", (dir / "none.csv").string()));
}

TEST(SceneFile, ShippedScenesAreValidConsistentAndSurviveBeingWrittenAndReadAgain) {
  for (const char* name : {"elbow.toml", "elbow_twin.toml"}) {
    const data::Scene s = io::read_scene(tests::source_dir() / "pipelines" / "scenes" / name);
    EXPECT_TRUE(s.notes.empty());
    ASSERT_EQ(s.muscles.size(), 7u);
    const std::string text = io::write_scene(s);
    const data::Scene again = io::parse_scene(text, "again.toml", ".");
    EXPECT_EQ(io::write_scene(again), text);
    for (std::size_t i = 0; i < 7; ++i) {
      const limb::MusclePath before(s.muscles[i].name, s.muscles[i].path, s.coordinates[0]);
      const limb::MusclePath after(again.muscles[i].name, again.muscles[i].path, again.coordinates[0]);
      EXPECT_LT(before.consistency().worst_disagreement_m, 1e-9);
      EXPECT_EQ(before(1.0).length_m, after(1.0).length_m);
      EXPECT_NEAR(s.muscles[i].parameters.pennation_at_optimal_rad,
                  again.muscles[i].parameters.pennation_at_optimal_rad, 1e-12);
    }
    ASSERT_EQ(again.segments.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_DOUBLE_EQ(s.segments[i].mass_kg, again.segments[i].mass_kg);
      EXPECT_DOUBLE_EQ(s.segments[i].inertia_kg_m2, again.segments[i].inertia_kg_m2);
      EXPECT_DOUBLE_EQ(s.segments[i].centre_of_mass_m, again.segments[i].centre_of_mass_m);
    }
    EXPECT_TRUE(limb::drive_map(s).undriven.empty());
  }
  const std::vector<std::string> recorded{"biceps", "brachioradialis", "triceps_lateral"};
  EXPECT_EQ(
      limb::drive_map(io::read_scene(tests::source_dir() / "pipelines/scenes/elbow.toml", recorded), recorded)
          .channels,
      recorded);
}

}  // namespace
