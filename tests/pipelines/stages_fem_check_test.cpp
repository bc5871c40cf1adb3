// What `brachium check` says of a definition of fem.solve: every mistake at once, each with its place.

#include <gmock/gmock.h>

#include <fstream>

#include "pipelines/definition.hpp"
#include "stages_fem_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class FemCheck : public ::testing::Test {
 protected:
  FemCheck() : folder_(brachium::tests::scratch_dir()) {}

  /// Mistakes of a definition whose stage begins in line 3; file names without the folder.
  std::string check(const std::string& options) {
    std::ofstream(folder_ / "study.toml")
        << "[pipeline]\ntitle = \"t\"\n[[stage]]\nname = \"block\"\nrun = \"fem.solve\"\n"
        << options;
    std::string out;
    try {
      read_definition(folder_ / "study.toml", {}, catalogue_, StageChecks::run);
    } catch (const data::InputError& e) {
      out = data::render(e.diagnostics());
    }
    const std::string prefix = (folder_ / "").string();
    for (std::size_t at; (at = out.find(prefix)) != std::string::npos;) out.erase(at, prefix.size());
    return out;
  }

  const fs::path folder_;
  const Catalogue catalogue_ = built_in_catalogue();
};

/// From line 6 of the definition.
const std::string block =
    R"(mesh = { block = { size_m = [0.02, 0.01, 0.01], cells = [2, 1, 1], region = "muscle" } }
material = [{ set = "sprenger", incompressible = true }]
fibre = [{ kind = "constant", direction = [1, 0, 0] }]
boundary = [
  { name = "left", surface = "x0", kind = "fixed" },
  { name = "pull", surface = "x1", kind = "displacement", x_m = 0.002 },
]
phase = [
  { name = "stretch", amplitude = { pull = 1.0 } },
  { name = "activate", activation = { muscle = 0.5 } },
]
output = [
  { name = "end", kind = "reaction", surface = "x1" },
  { name = "middle", kind = "section", point_m = [0.01, 0.005, 0.005], normal = [1, 0, 0] },
]
)";

std::string changed(std::initializer_list<std::pair<const char*, const char*>> changes) {
  std::string text = block;
  for (const auto& [what, instead] : changes) text = with(text, what, instead);
  return text;
}

TEST_F(FemCheck, AGoodDefinitionHasNoMistakes) {
  EXPECT_EQ(check(block), "");
}

TEST_F(FemCheck, NamesThatAreNotThereAreToldAtOnceWithTheirPlaces) {
  const std::string text =
      check(changed({{"surface = \"x0\"", "surface = \"x00\""},
                     {"{ pull = 1.0 }", "{ pul = 1.0 }"},
                     {"{ muscle = 0.5 }", "{ mucle = 0.5 }"},
                     {"\"reaction\", surface = \"x1\"", "\"reaction\", surface = \"x2\""},
                     {"[0.01, 0.005, 0.005]", "[0.03, 0.005, 0.005]"}}));
  EXPECT_THAT(text,
              HasSubstr("error[missing-surface]: `left`: the mesh has no surface or node set named `x00`\n"
                        "  --> study.toml:10:30\n"
                        "   |\n"
                        "10 |   { name = \"left\", surface = \"x00\", kind = \"fixed\" },\n"
                        "   |                              ^^^^^"));
  EXPECT_THAT(
      text,
      HasSubstr("error[unknown-condition]: phase `stretch` moves `pul`, which is no boundary condition\n"
                "  --> study.toml:14:37\n"));
  EXPECT_THAT(text, HasSubstr("did you mean `pull`?"));
  EXPECT_THAT(
      text,
      HasSubstr(
          "phase `activate` activates `mucle`, which is no region of the mesh\n  --> study.toml:15:39\n"));
  EXPECT_THAT(text, HasSubstr("output `end` (kind reaction): the mesh has no surface or node set named `x2`\n"
                              "  --> study.toml:18:48\n"));
  EXPECT_THAT(text, HasSubstr("error[plane-misses-body]: output `middle`: "));
  EXPECT_THAT(text, Not(HasSubstr("empty-phase"))) << "what they are meant to change is known";
  EXPECT_THAT(text, HasSubstr("  --> study.toml:19:12\n"));
}

TEST_F(FemCheck, ATypingMistakeDoesNotHideTheOthers) {
  const std::string text = check(changed(
      {{"kind = \"fixed\"", "kind = \"fixed\", colour = 3"}, {"surface = \"x0\"", "surface = \"x00\""}}));
  EXPECT_THAT(text, AllOf(HasSubstr("error[unknown-key]: `colour`"),
                          HasSubstr("named `x00`\n  --> study.toml:10:30")));
}

TEST_F(FemCheck, RegionsAreNamesOfTheMesh) {
  EXPECT_THAT(
      check(changed({{"{ set =", "{ regions = [\"muscel\"], set ="}})),
      AllOf(HasSubstr("error[missing-region]: entry 1 of `material`: no region of the mesh matches `muscel`\n"
                      "  --> study.toml:7:26\n"),
            HasSubstr("did you mean `muscle`?"),
            HasSubstr(
                "error[missing-material]: region `muscle` has no material: no entry of `material` names it\n"
                "  --> study.toml:7:12\n")));
  EXPECT_THAT(check(changed({{"[{ set",
                              "[{ regions = [\"muscle\"], law = \"neo_hooke\", shear_modulus_pa = 1.0, "
                              "incompressible = true }, { regions = [\"mus*\"], set"}})),
              HasSubstr("region `muscle` has two materials: entries 1 and 2 of `material`"));
}

TEST_F(FemCheck, FibresThatAreMissingZeroOrNotThere) {
  EXPECT_THAT(check(changed({{"direction = [1, 0, 0]", "direction = [0, 0, 0]"}})),
              AllOf(HasSubstr("error[bad-fibre]: entry 1 of `fibre` (kind constant): a constant fibre "
                              "direction has length 0"),
                    HasSubstr("  --> study.toml:8:")));
  EXPECT_THAT(check(changed({{"fibre = [{ kind = \"constant\", direction = [1, 0, 0] }]", ""}})),
              AllOf(HasSubstr("error[missing-fibres]: the law of region `muscle` has fibres"),
                    HasSubstr("  --> study.toml:")));
  EXPECT_THAT(check(changed({{"kind = \"constant\", direction = [1, 0, 0]",
                              "kind = \"mesh_field\", field = \"fibers\""}})),
              AllOf(HasSubstr("`fibers`"), HasSubstr("  --> study.toml:8:41\n")));
  EXPECT_THAT(check(changed({{"kind = \"constant\", direction = [1, 0, 0]",
                              "kind = \"harmonic\", origin = \"x0\", insertion = \"x9\""}})),
              AllOf(HasSubstr("`x9`"), HasSubstr("  --> study.toml:8:")));
}

TEST_F(FemCheck, ABodyThatNothingHoldsIsToldTheMotionsItHas) {
  EXPECT_THAT(check(changed({{"kind = \"fixed\"", "kind = \"symmetry\""}})),
              AllOf(HasSubstr("error[unsupported-motion]: nothing holds the body against"),
                    HasSubstr("translation along y"), HasSubstr("  --> study.toml:9:12\n")));
}

TEST_F(FemCheck, ContradictionsAndPhasesThatDoNothing) {
  EXPECT_THAT(
      check(changed({{"{ name = \"pull\"",
                      "{ name = \"push\", surface = \"x1\", kind = \"displacement\", x_m = -0.001 },\n{ name "
                      "= \"pull\""},
                     {"{ pull = 1.0 }", "{ pull = 1.0, push = 1.0 }"}})),
      AllOf(
          HasSubstr("error[contradictory-conditions]: `push` and `pull` hold 9 nodes in the same direction"),
          HasSubstr("  --> study.toml:11:12\n")));
  EXPECT_THAT(
      check(changed({{"{ name = \"activate\", activation = { muscle = 0.5 } }", "{ name = \"activate\" }"}})),
      AllOf(HasSubstr("error[empty-phase]: phase `activate` changes nothing"),
            HasSubstr("  --> study.toml:15:12\n")));
  EXPECT_THAT(check(changed({{"muscle = 0.5", "muscle = 1.5"}})),
              AllOf(HasSubstr("error[out-of-range]"), HasSubstr("allowed: 0 to 1"),
                    HasSubstr("  --> study.toml:15:48\n")));
}

TEST_F(FemCheck, NamesAreUnique) {
  EXPECT_THAT(check(changed({{"name = \"pull\"", "name = \"left\""}})),
              AllOf(HasSubstr("error[duplicate-condition]: two boundary conditions are named `left`\n  --> "
                              "study.toml:11:12\n"),
                    HasSubstr("error[unknown-condition]")));
  EXPECT_THAT(check(changed({{"name = \"middle\"", "name = \"end\""}})),
              HasSubstr("error[twice-given]: two outputs are called `end`\n  --> study.toml:19:12\n"));
}

TEST_F(FemCheck, AMeshFileIsReadWhenItIsThere) {
  const std::string file = "mesh = { file = \"mesh.msh\", length_unit = \"mm\" }";
  const std::string generated = block.substr(0, block.find('\n'));
  EXPECT_THAT(check(with(block, generated, file)),
              AllOf(HasSubstr("error[missing-file]"), HasSubstr("  --> study.toml:6:17\n")));
  fs::copy(brachium::tests::source_dir() / "tests/data/io/meshes/hex8_41.msh", folder_ / "mesh.msh");
  EXPECT_THAT(check(with(block, generated, with(file, ", length_unit = \"mm\"", ""))),
              AllOf(HasSubstr("error[mesh-unit-missing]"), HasSubstr("  --> study.toml:6:8\n")));
  const std::string text = check(with(block, generated, file));
  EXPECT_THAT(text,
              AllOf(HasSubstr("error[cell-type-mismatch]"), HasSubstr("`x0`\n  --> study.toml:10:30\n")));
  std::ofstream(folder_ / "mesh.msh", std::ios::app) << "$Periodic\n";
  fs::resize_file(folder_ / "mesh.msh", 600);
  EXPECT_THAT(check(with(block, generated, file)), HasSubstr("  --> mesh.msh:"));
}

TEST_F(FemCheck, DisconnectedAndInvertedMeshesAreRefused) {
  const std::string generated = block.substr(0, block.find('\n'));
  const auto msh = [&](const std::string& second, const std::string& shift) {
    std::ofstream out(folder_ / "mesh.msh");
    out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 "
           "\"muscle\"\n$EndPhysicalNames\n$Nodes\n8\n"
           "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 "
        << shift << " 0 0\n6 " << shift << " 1 0\n7 " << shift << " 0 1\n8 " << shift
        << " 1 1\n$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n2 4 2 1 1 " << second << "\n$EndElements\n";
  };
  const std::string options = with(block, generated,
                                   "element = \"p2_p1_taylor_hood\"\nmesh = { file = \"mesh.msh\", "
                                   "length_unit = \"mm\", elevate = true }");
  msh("5 6 7 8", "3");
  EXPECT_THAT(check(options), AllOf(HasSubstr("error[degenerate-cells]"), HasSubstr("cell 1 of `muscle`"),
                                    HasSubstr("  --> study.toml:7:8\n")));
  msh("6 5 7 8", "3");
  EXPECT_THAT(check(options), AllOf(HasSubstr("error[disconnected-mesh]: the mesh falls into 2 parts"),
                                    HasSubstr("  --> study.toml:7:8\n"), HasSubstr("named `x0`")));
}

}  // namespace
}  // namespace brachium::pipelines::tests
