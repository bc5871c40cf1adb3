// The limb file: what it says becomes bodies, and every mistake is told with its place.

#include "pipelines/stages/limb_scene.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <numbers>

#include "fem/contact/triangle_tree.hpp"
#include "fem/limb/body_parameters.hpp"
#include "pipelines/stages/common.hpp"
#include "pipelines/stages/limb_fitted.hpp"
#include "stages_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

const std::filesystem::path& shipped() {
  static const std::filesystem::path file =
      brachium::tests::source_dir() / "pipelines/scenes/upper_limb.toml";
  return file;
}

std::string shipped_text() {
  std::ifstream in(shipped());
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

std::string mistakes(const std::string& text, LimbVariant variant = LimbVariant::rigid_tendon) {
  return error_of([&] { parse_limb(text, "limb.toml", brachium::tests::source_dir(), variant); });
}

TEST(LimbScene, OfTheShippedFileHasItsBonesMusclesAndLoadInSI) {
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  EXPECT_NEAR(limb.range.upper_rad, 150.0 * degree, 1e-15);
  EXPECT_NEAR(limb.load_arm_m, 0.2825, 1e-15);
  ASSERT_EQ(limb.humerus.size(), 2u);
  EXPECT_EQ(limb.forearm, (std::vector<std::string>{"ulna", "radius"}));
  const auto& shaft = std::get<fem::Capsule>(limb.humerus[0].shape);
  EXPECT_NEAR((shaft.to_m - Eigen::Vector3d(0.0, 0.32, 0.0)).norm(), 0.0, 1e-15);
  const fem::MuscleBody& biceps = limb.muscle("biceps").body;
  EXPECT_TRUE(limb.muscle("biceps").flexor);
  EXPECT_FALSE(limb.muscle("triceps").flexor);
  EXPECT_EQ(biceps.belly_cells, 4);
  EXPECT_NEAR(biceps.cable.offset_rad, -11.0 * degree, 1e-15);
  EXPECT_EQ(biceps.reference_rad, limb.range.upper_rad) << "a flexor is shortest in full flexion";
  EXPECT_EQ(limb.muscle("triceps").body.reference_rad, limb.range.lower_rad);
  EXPECT_FALSE(limb.muscle("triceps").body.cable.anterior);
}

TEST(LimbScene, SurfacesOfRoundBonesAreClosedAndLieOnThem) {
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon);
  ASSERT_EQ(limb.surfaces.size(), 4u);
  for (const BoneSurface& s : limb.surfaces)
    EXPECT_NO_THROW(fem::check(fem::TriangleMesh{s.points, s.triangles})) << s.bone;
  for (std::size_t b = 0; b < limb.humerus.size(); ++b) {
    for (Eigen::Index p = 0; p < limb.surfaces[b].points.cols(); ++p)
      ASSERT_NEAR(fem::distance(limb.humerus[b].shape, limb.surfaces[b].points.col(p)).value, 0.0, 1e-15);
  }
}

TEST(LimbScene, BonesInAFrameOfTheirOwnComeToTheArms) {
  // y of the device runs along the hinge, z proximally: anterior, proximal x axis, is -x.
  const std::string text = replaced(shipped_text(), "forearm_length_mm = 250.0",
                                    "hinge_centre_mm = [100, 0, 50]\nhinge_axis = [0, 1, 0]\n"
                                    "proximal_direction = [0, 0, 1]\nforearm_length_mm = 250.0");
  const std::string moved = replaced(text, "from_mm = [0.0, 30.0, 0.0], to_mm = [0.0, 320.0, 0.0]",
                                     "from_mm = [100, 0, 80], to_mm = [95, 2, 370]");
  const LimbScene limb = parse_limb(moved, "limb.toml", {}, LimbVariant::rigid_tendon);
  const auto& shaft = std::get<fem::Capsule>(limb.humerus[0].shape);
  EXPECT_NEAR((shaft.from_m - Eigen::Vector3d(0.0, 0.03, 0.0)).norm(), 0.0, 1e-15);
  EXPECT_NEAR((shaft.to_m - Eigen::Vector3d(0.005, 0.32, 0.002)).norm(), 0.0, 1e-15);
}

TEST(LimbScene, ABoneMayBeAClosedTriangleMesh) {
  const std::filesystem::path folder = brachium::tests::scratch_dir();
  const LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon);
  const BoneSurface& round = limb.surfaces[1];
  std::ofstream out(folder / "bone.stl");
  out.precision(17);
  out << "solid bone\n";
  for (Eigen::Index t = 0; t < round.triangles.cols(); ++t) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (int i = 0; i < 3; ++i)
      out << "vertex " << (1e3 * round.points.col(round.triangles(i, t))).transpose() << "\n";
    out << "endloop\nendfacet\n";
  }
  out << "endsolid bone\n";
  out.close();
  const std::string of_triangles = replaced(
      shipped_text(), "capsule = { from_mm = [0.0, 0.0, -20.0], to_mm = [0.0, 0.0, 20.0], radius_mm = 12.0 }",
      "triangles = { file = \"bone.stl\", length_unit = \"mm\", spacing_mm = 1.0 }");
  const LimbScene meshed = parse_limb(of_triangles, "limb.toml", folder, LimbVariant::rigid_tendon);
  // 24 facets around: their sagitta, and the grid's spacing times the angle between two of them.
  const double allowed =
      0.012 * (1.0 - std::cos(std::numbers::pi / 24.0)) + 0.001 * 2.0 * std::numbers::pi / 24.0;
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.02, 0.003, 0.0), Eigen::Vector3d(-0.005, 0.02, 0.015)})
    EXPECT_NEAR(fem::distance(meshed.humerus[1].shape, x).value,
                fem::distance(limb.humerus[1].shape, x).value, allowed);
  const std::string open = replaced(of_triangles, "bone.stl", "open.stl");
  std::ofstream(folder / "open.stl")
      << "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
         "endloop\nendfacet\nendsolid x\n";
  EXPECT_THAT(error_of([&] { parse_limb(open, "limb.toml", folder, LimbVariant::rigid_tendon); }),
              HasSubstr("error[triangle-mesh-open]: bone `distal humerus`: "));
}

TEST(LimbScene, MeshesTendonsInTheMuscleTendonComplexOnly) {
  const std::string text =
      replaced(shipped_text(), "insertion_mm = 15.0", "insertion_mm = 14.0, transition_mm = 5.0");
  const LimbScene rigid = parse_limb(text, "limb.toml", {}, LimbVariant::rigid_tendon);
  EXPECT_EQ(rigid.muscle("biceps").body.tendon_insertion_m, 0.0);
  EXPECT_EQ(rigid.muscle("biceps").body.pre_stretch, 1.08);
  const LimbScene mtc = parse_limb(text, "limb.toml", {}, LimbVariant::mtc);
  EXPECT_NEAR(mtc.muscle("biceps").body.tendon_insertion_m, 0.014, 1e-15);
  EXPECT_NEAR(mtc.muscle("biceps").body.transition_m, 0.005, 1e-15);
  EXPECT_GT(mtc.muscle("triceps").body.tendon_origin_m, 0.0);
  EXPECT_LT(mtc.muscle("biceps").body.pre_stretch, 1.08) << "of belly and tendons together";
  EXPECT_THAT(
      mistakes(replaced(shipped_text(), "tendons = { origin_mm = 12.0", "# { origin_mm = 12.0"),
               LimbVariant::mtc),
      HasSubstr("error[missing-key]: muscle `biceps` has no `tendons`, which the variant mtc meshes\n"));
}

TEST(LimbScene, TellsEveryMistakeAtOnceWithItsPlace) {
  std::string text = replaced(shipped_text(), "radius_mm = 35.7", "radius_mm = -35.7");
  text = replaced(text, "action = \"extensor\"", "action = \"extender\"");
  text = replaced(text, "standoff_mm = 6.0", "stand_off_mm = 6.0");
  text = replaced(text, "segment = \"forearm\"", "segment = \"forarm\"");
  text = replaced(text, "set = \"sprenger\"", "set = \"sprengre\"");
  const std::string said = mistakes(text);
  EXPECT_THAT(
      said,
      HasSubstr("error[out-of-range]: `radius_mm` must be greater than 0, not -35.7\n  --> limb.toml:"));
  EXPECT_THAT(said, HasSubstr("error[unknown-value]: muscle `triceps` cannot be a `extender`\n"));
  EXPECT_THAT(said, HasSubstr("did you mean `extensor`?"));
  EXPECT_THAT(said, HasSubstr("`stand_off_mm`"));
  EXPECT_THAT(said, HasSubstr("error[unknown-value]: bone `ulna` cannot belong to `forarm`\n"));
  EXPECT_THAT(said, HasSubstr("error[unknown-parameter-set]: "));
  EXPECT_THAT(said, HasSubstr("set = \"sprengre\"")) << "the line is shown";
}

TEST(LimbScene, RefusesGeometryThatCannotBeBuilt) {
  EXPECT_THAT(mistakes(replaced(shipped_text(), "belly = { length_mm = 200.0, radii_mm = [13.5",
                                "belly = { length_mm = 400.0, radii_mm = [13.5")),
              HasSubstr("error[limb-geometry]: biceps: length of the rigid tendon that is left [m] = "));
  EXPECT_THAT(
      mistakes("[limb]\ntitle = \"x\"\nsource = \"y\"\nrange_deg = [150, 10]\n"),
      ::testing::AllOf(
          HasSubstr("error[missing-key]: the limb has no [[muscle]]"),
          HasSubstr(
              "error[out-of-range]: `range_deg` must be two increasing angles\n  --> limb.toml:4:13\n")));
}

TEST(LimbFitted, ParametersAreAllWhatTheTableSaysWhateverItsOrder) {
  LimbScene limb = read_limb(shipped(), LimbVariant::rigid_tendon, {.belly_cells = 4});
  const std::vector<std::pair<std::string, double>> wanted{
      {"volume_m3", 2e-4}, {"end_radius_norm", 0.5}, {"belly_length_m", 0.18}};
  TableBuilder table("fitted");
  table.text("muscle").text("parameter").text("unit").number("value", "SI");
  for (const auto& [name, value] : wanted) table.row({std::string("biceps"), name, std::string(), value});
  StageData fitted;
  fitted.tables["fitted"] = table.take();
  apply_fitted(fitted, limb);
  for (const auto& [name, value] : wanted)
    EXPECT_NEAR(fem::body_value(limb.muscle("biceps").body, name), value, 1e-12 * value) << name;
}

}  // namespace
}  // namespace brachium::pipelines::tests
