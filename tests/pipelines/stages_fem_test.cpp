// fem.solve through the run of a pipeline: closed forms, what is said of bad input, going on after a stop.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <atomic>
#include <cmath>
#include <fstream>
#include <sstream>

#include "pipelines/run_folder.hpp"
#include "pipelines/run_stage.hpp"
#include "pipelines/runner.hpp"
#include "pipelines/stages/fem_quantities.hpp"
#include "pipelines/stages/fem_surface.hpp"
#include "stages_fem_support.hpp"
#include "tests/support/paths.hpp"
#include "tests/support/python.hpp"

namespace brachium::pipelines::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A block of incompressible neo-Hooke, held so that it can be stretched freely across.
const std::string stretched_block = R"(
element = "q2_q1_taylor_hood"
mesh = { block = { size_m = [0.02, 0.01, 0.01], cells = [2, 1, 1], region = "tissue" } }
material = [{ law = "neo_hooke", shear_modulus_pa = 2e4, incompressible = true }]
boundary = [
  { name = "left", surface = "x0", kind = "symmetry" },
  { name = "front", surface = "y0", kind = "symmetry" },
  { name = "floor", surface = "z0", kind = "symmetry" },
  { name = "pull", surface = "x1", kind = "displacement", x_m = 0.01 },
]
phase = [{ name = "stretch", amplitude = { pull = 1.0 }, steps = 2 }, { name = "back", amplitude = { pull = 0.5 }, steps = 2 }]
output = [
  { name = "pull", kind = "reaction", surface = "x1" },
  { name = "middle", kind = "section", point_m = [0.01, 0.005, 0.005], normal = [1, 0, 0] },
  { name = "corner", kind = "displacement", point_m = [0.02, 0.01, 0.01] },
  { name = "body", kind = "volume" },
  { name = "stresses", kind = "stress_resultant", surface = "x1", point_m = [0, 0, 0] },
  { name = "shear", kind = "von_mises" },
]
)";

/// Uniaxial stretch l of an incompressible neo-Hookean block: F = A mu (l - 1/l^2).
TEST(FemSolve, AStretchedBlockGivesTheClosedForm) {
  const StageData data = solved(stretched_block);
  const data::Table& q = data.tables.at("quantities");
  ASSERT_GT(q.rows(), 0u);
  for (std::size_t k = 0; k < q.rows(); ++k) {
    const double l = 1.0 + 0.5 * q.numbers("amplitude_pull")[k];
    const double force = 1e-4 * 2e4 * (l - 1.0 / (l * l));
    EXPECT_NEAR(q.numbers("pull_N")[k], force, 1e-7 * force) << k;
    EXPECT_NEAR(q.numbers("pull_x_N")[k], -force, 1e-7 * force)
        << "the body pulls its surroundings towards itself";
    EXPECT_NEAR(q.numbers("middle_area_m2")[k], 1e-4 / l, 1e-9);
    EXPECT_NEAR(q.numbers("corner_y_m")[k], 0.01 * (1.0 / std::sqrt(l) - 1.0), 1e-8);
    EXPECT_NEAR(q.numbers("body_change")[k], 0.0, 1e-9);
    EXPECT_NEAR(q.numbers("stresses_x_N")[k], -force, 1e-7 * force)
        << "integrated stresses and nodal reactions agree";
    // df = -P N dA at y = 5 mm of the undeformed block: the moment about the origin is that of the force at
    // its middle.
    EXPECT_NEAR(q.numbers("stresses_moment_z_N_m")[k], force * 0.005 / std::sqrt(l), 1e-7 * force);
    EXPECT_NEAR(q.numbers("shear_mean_Pa")[k], 2e4 * (l * l - 1.0 / l), 1e-2);
    EXPECT_NEAR(q.numbers("shear_max_Pa")[k], q.numbers("shear_min_Pa")[k], 1e-2) << "homogeneous";
  }
  EXPECT_DOUBLE_EQ(q.numbers("amplitude_pull").back(), 0.5);
  EXPECT_THAT(data.attributes.at("verdict"), HasSubstr("2 phases solved"));
  // The same stresses, brought to the points of the surface.
  const data::Table& surface = data.tables.at("surface_states");
  const double l = 1.0 + 0.5 * q.numbers("amplitude_pull").back();
  for (std::size_t p = 0; p < surface.rows(); ++p) {
    if (surface.numbers("state")[p] < q.numbers("state").back()) continue;
    EXPECT_NEAR(surface.numbers("von_mises_pa")[p], 2e4 * (l * l - 1.0 / l), 1e-2);
  }
}

TEST(FemSolve, EveryMistakeOfTheDefinitionIsReportedAtOnceBeforeAnythingIsSolved) {
  const std::string text = mistakes(R"(
mesh = { block = { size_m = [0.02, 0.01, 0.01], cells = [2, 1, 1], region = "tissue" } }
material = [{ regions = ["tisue"], law = "neo_hooke", incompressible = true, c10_pa = 3.0 }]
boundary = [
  { name = "left", surface = "x00", kind = "fixed", x_m = 0.1 },
  { name = "pull", surface = "x1", kind = "rigid_motion" },
]
phase = [{ name = "stretch", amplitude = 1.0 }]
output = [{ name = "pull", kind = "reaction", surface = "x2" }, { name = "pull", kind = "section" }]
)");
  EXPECT_THAT(text, HasSubstr("entry 1 of `material`"));
  EXPECT_THAT(text, HasSubstr("region `tissue` has no material"));
  EXPECT_THAT(text, HasSubstr("the law neo_hooke needs `shear_modulus_pa`"));
  EXPECT_THAT(text, HasSubstr("entry 1 of `material` (law neo_hooke) has no use for `c10_pa`"));
  EXPECT_THAT(text, HasSubstr("boundary `left` (kind fixed) has no use for `x_m`"));
  EXPECT_THAT(text, HasSubstr("boundary `pull` (kind rigid_motion) needs `translation_m`"));
  EXPECT_THAT(text, HasSubstr("phase `stretch`: `amplitude` needs the names"));
  EXPECT_THAT(text, HasSubstr("two outputs are called `pull`"));
  EXPECT_THAT(text, HasSubstr("output `pull` (kind section) needs `normal`"));
  EXPECT_THAT(text, HasSubstr("x2"));
}

TEST(FemSolve, WhatTheSolverFindsIsReportedToo) {
  EXPECT_THAT(
      mistakes(with(stretched_block, "{ name = \"floor\", surface = \"z0\", kind = \"symmetry\" },", "")),
      HasSubstr("unsupported-motion"));
  EXPECT_THAT(
      mistakes(with(stretched_block, "\"x1\", kind = \"displacement\"", "\"x9\", kind = \"displacement\"")),
      HasSubstr("missing-surface"));
}

TEST(FemSolve, AMeshIsOneOfFileAndGenerators) {
  EXPECT_THAT(mistakes("mesh = {}"), HasSubstr("`mesh` names no body"));
  EXPECT_THAT(mistakes("mesh = { file = \"a.msh\", cylinder = { radius_m = 1, length_m = 1 } }"),
              HasSubstr("`mesh` names 2 bodies: file, cylinder"));
  EXPECT_THAT(mistakes("mesh = { file = \"a.msh\" }"), HasSubstr("mesh-unit-missing"));
}

TEST(FemSolve, AMaterialSaysHowItResistsChangeOfVolume) {
  EXPECT_THAT(mistakes(with(stretched_block, ", incompressible = true", "")),
              HasSubstr("needs either `incompressible = true` or `bulk_modulus_pa`"));
  EXPECT_THAT(mistakes(with(stretched_block, ", incompressible = true",
                            ", incompressible = true, bulk_modulus_pa = 1e6")),
              HasSubstr("needs one of `incompressible = true` and `bulk_modulus_pa`"));
}

TEST(FemSolve, AnActivationNeedsAnActiveLaw) {
  EXPECT_THAT(mistakes(with(stretched_block, "steps = 2 }]", "steps = 2, activation = 0.5 }]")),
              HasSubstr("no region has an active law"));
}

TEST(FemSolve, AParameterOfANamedSetCanBeReplacedAndTheReportShowsIt) {
  const std::string options =
      with(with(stretched_block, "law = \"neo_hooke\", shear_modulus_pa = 2e4",
                "set = \"sprenger\", muscle_c1_pa = 1e4"),
           "boundary = [", "fibre = [{ kind = \"constant\", direction = [1, 0, 0] }]\nboundary = [");
  const StageData data = solved(options);
  const data::Table& materials = data.tables.at("materials");
  EXPECT_THAT(materials.texts("parameters")[0], HasSubstr("muscle_c1_pa 10000, "));
  EXPECT_THAT(materials.texts("source")[0], HasSubstr("`sprenger`: "));
  EXPECT_THAT(mistakes(with(options, "sprenger", "springer")), HasSubstr("did you mean `sprenger`?"));
}

// ---------------------------------------------------------------- runs

class FemRun : public ::testing::Test {
 protected:
  FemRun() : folder_(brachium::tests::scratch_dir()) {}

  /// Stops the run once `stop_after` states are kept; 0: lets it run.
  RunResult run(const std::string& options, std::size_t stop_after = 0) {
    std::ofstream(folder_ / "study.toml")
        << "[pipeline]\ntitle = \"t\"\nthreads = 1\n[[stage]]\nname = \"block\"\nrun = \"fem.solve\"\n"
        << options;
    RunRequest request;
    request.definition = folder_ / "study.toml";
    request.out = folder_ / "run";
    std::atomic<bool> stop{false};
    request.stop = &stop;
    Stopper stopper(folder_ / "run/01-block.restart", stop_after, stop);
    const RunResult result = run_pipeline(catalogue_, request, stopper);
    said_ = stopper.said;
    return result;
  }

  StageData output() const { return load_stage(folder_ / "run/01-block.h5", "block"); }

  struct Stopper final : RunObserver {
    Stopper(fs::path where, std::size_t after, std::atomic<bool>& flag)
        : restart(std::move(where)), wanted(after), stop(flag) {}
    void stage_begins(const StageRecord&, std::size_t, std::size_t) override {}
    void stage_progress(const StageRecord&, double, const std::string&) override {
      std::error_code none;
      if (wanted > 0 && fs::exists(restart / fmt::format("{:04}.h5", wanted), none)) stop = true;
    }
    void stage_ends(const StageRecord&, const std::vector<data::Diagnostic>&) override {}
    void message(const std::string& text) override { said.push_back(text); }
    fs::path restart;
    std::size_t wanted;
    std::atomic<bool>& stop;
    std::vector<std::string> said;
  };

  const fs::path folder_;
  const Catalogue catalogue_ = built_in_catalogue();
  std::vector<std::string> said_;
};

TEST_F(FemRun, AStoppedSolveGoesOnFromItsLastStateToTheSameNumbers) {
  const RunResult stopped = run(stretched_block, 2);
  ASSERT_EQ(stopped.outcome, Outcome::interrupted);
  const RunResult done = run(stretched_block);
  ASSERT_EQ(done.outcome, Outcome::done);
  EXPECT_THAT(said_, ::testing::Contains(HasSubstr("goes on from state")));
  EXPECT_FALSE(fs::exists(folder_ / "run/01-block.restart"));
  const StageData whole = solved(stretched_block);
  const data::Table after = output().tables.at("quantities");
  ASSERT_EQ(after.rows(), whole.tables.at("quantities").rows());
  for (std::size_t k = 0; k < after.rows(); ++k) {
    EXPECT_EQ(after.numbers("state")[k], static_cast<double>(k + 1));
    EXPECT_NEAR(after.numbers("pull_N")[k], whole.tables.at("quantities").numbers("pull_N")[k], 1e-9);
  }
}

TEST_F(FemRun, AStoppedSolveOfAnotherProblemIsNotGoneOnFrom) {
  ASSERT_EQ(run(stretched_block, 2).outcome, Outcome::interrupted);
  ASSERT_EQ(run(with(stretched_block, "2e4", "3e4")).outcome, Outcome::done);
  EXPECT_THAT(said_, Not(::testing::Contains(HasSubstr("goes on"))));
}

TEST_F(FemRun, AFailedSolveKeepsItsLastStateAndSaysWhereAndWhy) {
  // Pushed through itself in the second phase: it becomes unstable, and no step is small enough.
  const std::string crushed = with(with(stretched_block, "pull = 0.5", "pull = -6.0"), "element",
                                   "solver = { smallest_step = 0.05, on_instability = \"fail\" }\nelement");
  const RunResult result = run(crushed);
  EXPECT_EQ(result.outcome, Outcome::numerical_failure);
  EXPECT_EQ(exit_code(result.outcome), 1);
  EXPECT_THAT(result.errors.at(0).message,
              AllOf(HasSubstr("phase `back`"), HasSubstr("converged states is kept")));
  EXPECT_GT(output().tables.at("quantities").rows(), 0u);
  EXPECT_TRUE(fs::exists(folder_ / "run/01-block.restart/0001.h5"));
}

TEST_F(FemRun, FieldFilesAndAReportWithAViewAreLeft) {
  ASSERT_EQ(run(stretched_block).outcome, Outcome::done);
  EXPECT_TRUE(fs::exists(folder_ / "run/01-block.vtkhdf"));
  EXPECT_TRUE(fs::exists(folder_ / "run/01-block.xdmf"));
  std::stringstream text;
  text << std::ifstream(folder_ / "run/report.html").rdbuf();
  EXPECT_THAT(text.str(), AllOf(HasSubstr("class=\"view3d\""), HasSubstr("webgl2"),
                                Not(HasSubstr("could not be drawn"))));
  EXPECT_LT(text.str().size(), 5'000'000u);
}

TEST_F(FemRun, FieldFilesHoldTheStateThatAnotherReaderFindsInThem) {
  if (!brachium::tests::python_has("h5py, numpy"))
    GTEST_SKIP() << "needs /usr/bin/python3 with h5py and numpy";
  ASSERT_EQ(run(stretched_block).outcome, Outcome::done);
  const fs::path script = brachium::tests::source_dir() / "tests/pipelines/field_files.py";
  EXPECT_EQ(std::system(fmt::format("/usr/bin/python3 '{}' '{}'", script.string(),
                                    (folder_ / "run/01-block.x").string())
                            .c_str()),
            0);
}

TEST_F(FemRun, StatisticsOfTheFibresAreInTheLog) {
  ASSERT_EQ(
      run(with(with(stretched_block, "law = \"neo_hooke\", shear_modulus_pa = 2e4", "set = \"sprenger\""),
               "phase = [", "fibre = [{ kind = \"constant\", direction = [0, 2, 0] }]\nphase = ["))
          .outcome,
      Outcome::done);
  EXPECT_THAT(said_,
              ::testing::Contains(HasSubstr("fibres of `tissue`: mean direction (0, 1, 0), angles to it "
                                            "0 to 0 deg, rms 0")));
  std::stringstream log;
  log << std::ifstream(folder_ / "run/log.txt").rdbuf();
  EXPECT_THAT(log.str(), HasSubstr("fibres of `tissue`: mean direction (0, 1, 0)"));
}

TEST(FemSolve, EverySolverByNameGivesTheSameForce) {
  const auto forces = [](const std::string& solver, std::size_t threads,
                         const std::string& element = "q2_q1_taylor_hood") {
    StageRequest request;
    request.options = with(stretched_block, "q2_q1_taylor_hood", element) + "solver = { " + solver + " }\n";
    request.threads = threads;
    return run_stage(fem_stage(), request).tables.at("quantities").numbers("pull_N");
  };
  const std::vector<double> ldl = forces("linear_solver = \"ldl\"", 1);
  for (const std::string name : {"cholmod", "umfpack"}) {
    const std::vector<double> other = forces("linear_solver = \"" + name + "\"", 1);
    ASSERT_EQ(other.size(), ldl.size()) << name;
    for (std::size_t k = 0; k < ldl.size(); ++k) EXPECT_NEAR(other[k], ldl[k], 1e-8 * ldl[k]) << name;
  }
  for (const std::string name : {"ldl", "cholmod"}) {
    const std::string options = fmt::format("linear_solver = \"{}\", deterministic = true", name);
    EXPECT_EQ(forces(options, 1), forces(options, 2)) << name << ": to the last bit";
    EXPECT_EQ(forces(options, 1, "q2_p1_discontinuous"), forces(options, 2, "q2_p1_discontinuous")) << name;
  }
  EXPECT_THAT(mistakes(stretched_block + "solver = { linear_solver = \"cholmot\" }\n"),
              AllOf(HasSubstr("cholmot"), HasSubstr("cholmod")));
}

// ---------------------------------------------------------------- parts

TEST(FemSurface, TrianglesOfEveryCellTypeEncloseTheBodyRegionByRegion) {
  for (const std::string element : {"q1_p0", "q2_p1_discontinuous", "p2_p1_taylor_hood"}) {
    const std::string options = with(stretched_block, "q2_q1_taylor_hood", element);
    const StageData data = solved(options);
    const data::Table &p = data.tables.at("surface_points"), &t = data.tables.at("surface_triangles");
    const auto at = [&](const char* column, std::size_t row) {
      const auto k = static_cast<std::size_t>(t.numbers(column)[row]);
      return Eigen::Vector3d(p.numbers("x_m")[k], p.numbers("y_m")[k], p.numbers("z_m")[k]);
    };
    double volume = 0.0;
    for (std::size_t k = 0; k < t.rows(); ++k) volume += at("a", k).dot(at("b", k).cross(at("c", k))) / 6.0;
    EXPECT_NEAR(volume, 2e-6, 1e-12) << element;
  }
}

TEST(FemQuantities, RowsOfOtherColumnsAreNotJoined) {
  data::Table a{"", {{"x", "1", std::vector<double>{1.0}}}}, b{"", {{"y", "1", std::vector<double>{1.0}}}};
  append_rows(a, a);
  EXPECT_EQ(a.rows(), 2u);
  EXPECT_THROW(append_rows(a, b), std::logic_error);
}

}  // namespace
}  // namespace brachium::pipelines::tests
