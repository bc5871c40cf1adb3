// Contact with rigid bodies through fem.solve: a uniform state against closed form, Hertz' relation, bad
// input.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "stages_fem_support.hpp"
#include "tests/support/paths.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A cube of 10 mm, free sideways, its lid held; a floor that begins 1 mm below comes up by 3 mm.
std::string pressed_cube(const std::string& floor) {
  return R"(
element = "q2_p1_discontinuous"
mesh = { block = { size_m = [0.01, 0.01, 0.01], cells = [2, 2, 2], region = "tissue" } }
material = [{ law = "neo_hooke", shear_modulus_pa = 1e4, incompressible = true }]
boundary = [
  { name = "lid", surface = "z1", kind = "symmetry" },
  { name = "x", surface = "x0", kind = "symmetry" },
  { name = "y", surface = "y0", kind = "symmetry" },
  { name = "lift", kind = "rigid_motion", translation_m = [0, 0, 0.003] },
]
contact = [{ name = "floor", surface = "z0", moves_with = "lift", penalty_pa_per_m = 1e7, )" +
         floor + R"( }]
phase = [{ name = "press", amplitude = { lift = 1.0 }, steps = 2 }]
output = [
  { name = "floor", kind = "contact", contact = "floor" },
  { name = "lid", kind = "reaction", surface = "z1" },
  { name = "foot", kind = "displacement", point_m = [0.01, 0.01, 0] },
]
solver = { volume_tolerance = 1e-10, relative_residual = 1e-10 }
)";
}

const std::string plane = "shape = \"half_space\", point_m = [0, 0, -0.001], normal = [0, 0, 1]";

/// Nominal stress at 0.8 of its height: mu (l - 1/l^2).
const double force = 1e4 * 1e-4 * (1.0 / 0.64 - 0.8);

TEST(FemContact, AFloorThatComesUpPressesTheCubeUniformly) {
  const StageData data = solved(pressed_cube(plane + ", penetration_tolerance_m = 1e-10"));
  EXPECT_NEAR(last(data, "floor_z_N"), force, 1e-6 * force) << "on the muscle's surface";
  EXPECT_NEAR(last(data, "floor_max_Pa"), force / 1e-4, 1e-5 * force / 1e-4)
      << "pressures are per undeformed area";
  EXPECT_NEAR(last(data, "floor_area_m2"), 1e-4, 1e-12);
  EXPECT_LT(last(data, "floor_penetration_m"), 1e-10);
  EXPECT_NEAR(last(data, "lid_z_N"), force, 1e-6 * force) << "passed on to what holds the lid";
  EXPECT_NEAR(last(data, "foot_z_m"), 0.002, 1e-9);
  // The pressure's resultant acts at the middle of the widened face: about the origin, (y F, -x F, 0).
  EXPECT_NEAR(last(data, "floor_moment_x_N_m"), 0.005 / std::sqrt(0.8) * force, 1e-8 * force);
}

TEST(FemContact, ThePenaltyLeavesAPenetrationThatIsReported) {
  const StageData data = solved(pressed_cube(plane));
  const double gap = last(data, "floor_penetration_m");
  EXPECT_NEAR(last(data, "floor_max_Pa"), 1e7 * gap, 1e-6 * 1e7 * gap);
  const double l = 0.8 + gap / 0.01;  // so much less is it pressed
  EXPECT_NEAR(last(data, "floor_max_Pa"), 1e4 * (1.0 / (l * l) - l), 1e-5 * 1e7 * gap);
}

std::string slab_stl(const std::filesystem::path& folder) {
  // [-40, 40]^2 x [-20, 0] mm, outward triangles.
  const double x[8][3] = {{-40, -40, -20}, {40, -40, -20}, {40, 40, -20}, {-40, 40, -20},
                          {-40, -40, 0},   {40, -40, 0},   {40, 40, 0},   {-40, 40, 0}};
  const int f[12][3] = {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                        {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
  std::ofstream out(folder / "slab.stl");
  out << "solid slab\n";
  for (const auto& t : f) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (const int c : t) out << fmt::format("vertex {} {} {}\n", x[c][0], x[c][1], x[c][2]);
    out << "endloop\nendfacet\n";
  }
  out << "endsolid slab\n";
  return (folder / "slab.stl").string();
}

TEST(FemContact, AClosedTriangleMeshIsABody) {
  // Upside down in its file: turned about x, its lower face becomes the floor's upper one and comes to lie at
  // -1 mm.
  const std::string file = slab_stl(brachium::tests::scratch_dir());
  const std::string body = "shape = \"triangles\", file = \"" + file +
                           "\", length_unit = \"mm\", grid_spacing_m = 0.001, grid_margin_m = 0.0, "
                           "turn_deg = 180, turn_axis = [1, 0, 0], place_m = [0, 0, -0.021]";
  const StageData data = solved(pressed_cube(body + ", penetration_tolerance_m = 1e-9"));
  EXPECT_NEAR(last(data, "floor_z_N"), force, 1e-4 * force);
  ASSERT_FALSE(data.diagnostics.empty());
  EXPECT_THAT(data.diagnostics[0].message, HasSubstr("12 triangles stand as a distance field"));
  EXPECT_THAT(mistakes(pressed_cube("shape = \"triangles\", file = \"" + file + "\"")),
              AllOf(HasSubstr("contact `floor` (shape triangles) needs `length_unit`"),
                    HasSubstr("needs `grid_spacing_m`")));
}

TEST(FemContact, ASphereIsPressedInAsHertzDid) {
  // Force, peak pressure and radius of the contact hang together by what lies near it, wherever the far faces
  // are: p0^3 = 6 F E^2 / (pi^3 R^2), E = 4 mu where incompressible (Johnson 1985,
  // doi:10.1017/CBO9781139171731, eq. 4.24).
  const StageData data = solved(R"(
mesh = { block = { size_m = [0.015, 0.015, 0.015], cells = [5, 5, 5], grading = [9, 9, 0.111], corner_m = [0, 0, -0.015] } }
material = [{ law = "neo_hooke", shear_modulus_pa = 1e4, bulk_modulus_pa = 1e7 }]
boundary = [
  { name = "x", surface = "x0", kind = "symmetry" },
  { name = "y", surface = "y0", kind = "symmetry" },
  { name = "bottom", surface = "z0", kind = "fixed" },
  { name = "down", kind = "rigid_motion", translation_m = [0, 0, -1.25e-4] },
]
contact = [{ name = "ball", surface = "z1", shape = "sphere", centre_m = [0, 0, 0.05], radius_m = 0.05, moves_with = "down", penalty_pa_per_m = 8e7, penetration_tolerance_m = 1e-6 }]
phase = [{ name = "press", amplitude = { down = 1.0 }, steps = 1 }]
output = [{ name = "ball", kind = "contact", contact = "ball" }]
)");
  const double whole = -4.0 * last(data, "ball_z_N"), modulus = 4e4, pi = std::numbers::pi;
  const double peak = std::cbrt(6.0 * whole * modulus * modulus / (std::pow(pi, 3) * 0.05 * 0.05));
  EXPECT_NEAR(last(data, "ball_max_Pa"), peak, 0.05 * peak);
  EXPECT_NEAR(4.0 * last(data, "ball_area_m2"), 1.5 * whole / peak, 0.15 * 1.5 * whole / peak)
      << "pi a^2 = 3 F / (2 p0)";
  EXPECT_LE(last(data, "ball_penetration_m"), 1e-6);
}

TEST(FemContact, MistakesAreNamed) {
  EXPECT_THAT(mistakes(pressed_cube("shape = \"sphere\", centre_m = [0, 0, -0.1], normal = [0, 0, 1]")),
              AllOf(HasSubstr("contact `floor` (shape sphere) needs `radius_m`"),
                    HasSubstr("contact `floor` (shape sphere) has no use for `normal`")));
  EXPECT_THAT(
      mistakes(with(pressed_cube(plane), "moves_with = \"lift\"", "moves_with = \"lfit\"")),
      AllOf(HasSubstr("moves with `lfit`, which is no rigid motion"), HasSubstr("did you mean `lift`?")));
  EXPECT_THAT(mistakes(with(pressed_cube(plane), "surface = \"z0\"", "surface = \"z2\"")),
              HasSubstr("no surface `z2`"));
  EXPECT_THAT(mistakes(with(pressed_cube(plane), "normal = [0, 0, 1]", "normal = [0, 0, 0]")),
              HasSubstr("the normal of body `floor` has no direction"));
  EXPECT_THAT(mistakes(with(pressed_cube(plane), "contact = \"floor\"", "contact = \"flor\"")),
              AllOf(HasSubstr("error[unknown-contact]"), HasSubstr("did you mean `floor`?")));
  EXPECT_THAT(mistakes(pressed_cube(plane + ", smoothing_m = 1e-5, penetration_tolerance_m = 1e-6")),
              HasSubstr("error[contact-option]"));
}

}  // namespace
}  // namespace brachium::pipelines::tests
