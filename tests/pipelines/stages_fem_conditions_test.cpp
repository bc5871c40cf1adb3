// Conditions, generators and wanted quantities of fem.solve against closed forms.

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "stages_fem_support.hpp"

namespace brachium::pipelines::tests {
namespace {

constexpr double mu = 2e4, pi = std::numbers::pi;

/// A block of incompressible neo-Hooke in three symmetry planes: uniaxial under a load along x.
std::string loaded_block(const std::string& load) {
  return R"(
element = "q2_q1_taylor_hood"
mesh = { block = { size_m = [0.02, 0.01, 0.01], cells = [2, 1, 1], region = "tissue" } }
material = [{ law = "neo_hooke", shear_modulus_pa = 2e4, incompressible = true }]
boundary = [
  { name = "left", surface = "x0", kind = "symmetry" },
  { name = "front", surface = "y0", kind = "symmetry" },
  { name = "floor", surface = "z0", kind = "symmetry" },
  { name = "load", )" +
         load + R"( },
]
phase = [{ name = "load", amplitude = { load = 1.0 }, steps = 2 }]
output = [
  { name = "corner", kind = "displacement", point_m = [0.02, 0.01, 0.01] },
  { name = "left", kind = "reaction", surface = "x0", point_m = [0, 0, 0.002] },
  { name = "slice", kind = "section", point_m = [0.01, 0.005, 0.005], normal = [1, 0, 0], direction = [0, 1, 0] },
]
)";
}

double stretch(const StageData& data) {
  return 1.0 + last(data, "corner_x_m") / 0.02;
}
double nominal(double l) {
  return mu * (l - 1.0 / (l * l));
}

TEST(FemConditions, ADeadTractionIsTheNominalStress) {
  const StageData data =
      solved(loaded_block("surface = \"x1\", kind = \"traction\", traction_pa = [1e4, 0, 0]"));
  const double l = stretch(data);
  EXPECT_NEAR(nominal(l), 1e4, 1e-3);
  // The left end pulls its surroundings towards the body, at the middle of its deformed section.
  const double middle = 0.005 / std::sqrt(l);
  EXPECT_NEAR(last(data, "left_x_N"), 1.0, 1e-7);
  EXPECT_NEAR(last(data, "left_moment_y_N_m"), middle - 0.002, 1e-9);
  EXPECT_NEAR(last(data, "left_moment_z_N_m"), -middle, 1e-9);
  EXPECT_NEAR(last(data, "energy_J"), 2e-6 * mu / 2.0 * (l * l + 2.0 / l - 3.0), 1e-11);
  EXPECT_NEAR(last(data, "slice_thickness_m"), 0.01 / std::sqrt(l), 1e-8);
}

TEST(FemConditions, AForceIsSpreadOverTheSurface) {
  const StageData data = solved(loaded_block("surface = \"x1\", kind = \"force\", force_n = [-0.5, 0, 0]"));
  EXPECT_NEAR(nominal(stretch(data)), -0.5 / 1e-4, 1e-3);
  EXPECT_NEAR(last(data, "left_x_N"), -0.5, 1e-7);
}

TEST(FemConditions, AFollowerPressureActsOnTheDeformedSurface) {
  const StageData data = solved(loaded_block("surface = \"x1\", kind = \"pressure\", pressure_pa = 8e3"));
  const double l = stretch(data);
  EXPECT_NEAR(l * nominal(l), -8e3, 1e-3) << "Cauchy stress";
  EXPECT_NEAR(last(data, "left_x_N"), -8e3 * 1e-4 / l, 1e-7);
}

TEST(FemConditions, AWeightIsCarriedByWhatHoldsTheBody) {
  const StageData data = solved(loaded_block("kind = \"weight\", force_n_m3 = [1e4, 0, 0]"));
  EXPECT_NEAR(last(data, "left_x_N"), 1e4 * 2e-6, 1e-9);
}

TEST(FemConditions, ARigidMotionOfBothEndsTurnsTheBodyWithoutStress) {
  std::string options = loaded_block(
      "surface = \"x1\", kind = \"rigid_motion\", angle_deg = 90, axis = [0, 0, 1], centre_m = [0.01, 0, 0], "
      "translation_m = [0, 0, 0.003]");
  options = with(
      options, R"({ name = "left", surface = "x0", kind = "symmetry" },
  { name = "front", surface = "y0", kind = "symmetry" },
  { name = "floor", surface = "z0", kind = "symmetry" },)",
      R"({ name = "left", surface = "x0", kind = "rigid_motion", angle_deg = 90, axis = [0, 0, 1], centre_m = [0.01, 0, 0], translation_m = [0, 0, 0.003] },)");
  options = with(options, "{ load = 1.0 }", "{ load = 1.0, left = 1.0 }");
  options = with(options, "steps = 2", "steps = 8");
  const StageData data = solved(options);
  // (0.02, 0.01, 0.01) about (0.01, 0, 0): to (0, 0.01, 0.013).
  EXPECT_NEAR(last(data, "corner_x_m"), -0.02, 1e-9);
  EXPECT_NEAR(last(data, "corner_y_m"), 0.0, 1e-9);
  EXPECT_NEAR(last(data, "corner_z_m"), 0.003, 1e-9);
  EXPECT_NEAR(last(data, "energy_J"), 0.0, 1e-12);
  EXPECT_NEAR(last(data, "left_N"), 0.0, 1e-7);
  EXPECT_NEAR(last(data, "slice_area_m2"), 1e-4, 1e-10);
}

TEST(FemConditions, ATwistedCylinderNeedsRivlinsTorqueAndThrust) {
  // Pure torsion by k per length of an incompressible neo-Hookean cylinder is an equilibrium with a free
  // side: torque pi mu k a^4 / 2, thrust pi mu k^2 a^4 / 4, energy a^4 L pi mu k^2 / 4 (Rivlin 1949,
  // doi:10.1098/rsta.1949.0009).
  const StageData data = solved(R"(
element = "q2_q1_taylor_hood"
mesh = { cylinder = { radius_m = 0.01, length_m = 0.01, cells = 2, core_cells = 2, ring_cells = 1, region = "rod" } }
material = [{ law = "neo_hooke", shear_modulus_pa = 2e4, incompressible = true }]
boundary = [
  { name = "held", surface = "z0", kind = "fixed" },
  { name = "twist", surface = "z1", kind = "rigid_motion", angle_deg = 20, axis = [0, 0, 1], centre_m = [0, 0, 0] },
]
phase = [{ name = "twist", amplitude = { twist = 1.0 }, steps = 1 }]
output = [
  { name = "end", kind = "reaction", surface = "z1" },
  { name = "slice", kind = "section", point_m = [0, 0, 0.004], normal = [0, 0, 1], direction = [1, 0, 0] },
  { name = "rim", kind = "displacement", point_m = [0.009, 0, 0.005] },
]
)");
  const double k = 20.0 * pi / 180.0 / 0.01, a = 0.01, torque = pi * mu * k * std::pow(a, 4) / 2.0,
               thrust = pi * mu * k * k * std::pow(a, 4) / 4.0;
  // Eight quadratic edges around are 3e-4 off the circle, a^4 four times as much.
  EXPECT_NEAR(last(data, "end_moment_z_N_m"), -torque, 3e-3 * torque);
  EXPECT_NEAR(last(data, "end_z_N"), thrust, 2e-2 * thrust);
  EXPECT_NEAR(last(data, "energy_J"), thrust * 0.01, 3e-3 * thrust * 0.01);
  EXPECT_NEAR(last(data, "slice_mean_radius_m"), a, 1e-3 * a);
  EXPECT_NEAR(last(data, "slice_thickness_m"), 2.0 * a, 1e-3 * 2.0 * a);
  EXPECT_NEAR(last(data, "rim_x_m"), 0.009 * (std::cos(10.0 * pi / 180.0) - 1.0), 2e-5);
  EXPECT_NEAR(last(data, "rim_y_m"), 0.009 * std::sin(10.0 * pi / 180.0), 2e-5);
}

TEST(FemConditions, AContractingPennateBellyIsInBalance) {
  const std::string options = R"(
mesh = { pennate = { length_m = 0.03, length_cells = 2, width_m = 0.01, width_cells = 1, thickness_m = 0.01, thickness_cells = 1, pennation_deg = 30, aponeurosis_m = 0.001, tendon_m = 0.005, tendon_cells = 1 } }
material = [
  { regions = ["muscle"], set = "sprenger", bulk_modulus_pa = 1e8 },
  { law = "neo_hooke", shear_modulus_pa = 1e6, bulk_modulus_pa = 1e8 },
]
fibre = [{ regions = ["muscle"], kind = "mesh_field", field = "fibre" }]
boundary = [
  { name = "bone", surface = "origin", kind = "fixed" },
  { name = "end", surface = "insertion", kind = "fixed" },
]
phase = [{ name = "activate", activation = 0.1, steps = 1 }]
output = [
  { name = "origin", kind = "reaction", surface = "origin", point_m = [0.01, 0.02, 0.03] },
  { name = "insertion", kind = "reaction", surface = "insertion", point_m = [0.01, 0.02, 0.03] },
  { name = "fibres", kind = "fibre_stretch", regions = ["muscle"] },
  { name = "active", kind = "active_stress", regions = ["muscle"] },
  { name = "belly", kind = "volume", regions = ["muscle"] },
]
)";
  const StageData data = solved(options);
  const double force = last(data, "origin_N");
  EXPECT_GT(force, 0.0);
  for (const char* axis : {"x", "y", "z"}) {
    const std::string f = std::string("_") + axis + "_N", m = std::string("_moment_") + axis + "_N_m";
    EXPECT_NEAR(last(data, "origin" + f), -last(data, "insertion" + f), 1e-6 * force);
    EXPECT_NEAR(last(data, "origin" + m), -last(data, "insertion" + m), 1e-8 * force);
  }
  EXPECT_GT(last(data, "origin_x_N"), 0.0) << "the origin is pulled along the line to the insertion";
  EXPECT_LT(last(data, "fibres_mean"), 1.0) << "tendons give way, fibres shorten";
  EXPECT_LT(last(data, "fibres_min"), last(data, "fibres_max"));
  EXPECT_GT(last(data, "active_mean_Pa"), 0.0);
  EXPECT_NEAR(last(data, "belly_m3"), 0.03 * 0.01 * 0.01, 1e-3 * 3e-6);
  const std::string lines =
      with(options, "kind = \"mesh_field\", field = \"fibre\"", "kind = \"mesh_lines\", axis = \"second\"");
  EXPECT_NEAR(last(solved(lines), "origin_N"), force, 1e-6 * force)
      << "the cells' second lines are those of the field";
  EXPECT_EQ(data.tables.at("materials").rows(), 5u) << "muscle, two sheets, two tendons";
}

}  // namespace
}  // namespace brachium::pipelines::tests
