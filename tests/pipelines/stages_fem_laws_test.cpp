// Every law by its name in a definition, and what is read of it at a point, against closed forms of a body in
// uniaxial stretch; elements, blends, rates and pennation that a definition asks for.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "stages_fem_support.hpp"

namespace brachium::pipelines::tests {
namespace {

using ::testing::HasSubstr;

constexpr double area_m2 = 1e-4;

/// 20 x 10 x 10 mm, free to thin across, stretched along x by 1.2 and then, where `activation` is above 0, active.
std::string block(const std::string& material, double activation, const std::string& more = "",
                  const std::string& element = "q2_q1_taylor_hood") {
  const std::string fibre =
      material.find("neo_hooke") == std::string::npos && material.find("mooney") == std::string::npos
          ? "fibre = [{ kind = \"constant\", direction = [1, 0, 0] }]\n"
          : "";
  const std::string active =
      activation > 0.0
          ? fmt::format(", {{ name = \"activate\", activation = {{ block = {} }}, steps = 2 }}", activation)
          : "";
  return fmt::format(R"(element = "{}"
mesh = {{ block = {{ size_m = [0.02, 0.01, 0.01], cells = [2, 1, 1] }} }}
material = [{{ {}, incompressible = true }}]
boundary = [
  {{ name = "left", surface = "x0", kind = "symmetry" }},
  {{ name = "front", surface = "y0", kind = "symmetry" }},
  {{ name = "floor", surface = "z0", kind = "symmetry" }},
  {{ name = "pull", surface = "x1", kind = "displacement", x_m = 0.004 }},
]
phase = [{{ name = "stretch", amplitude = {{ pull = 1.0 }}, steps = 2, duration_s = 0.5 }}{}]
output = [
  {{ name = "pull", kind = "reaction", surface = "x1" }},
  {{ name = "here", kind = "point", point_m = [0.013, 0.004, 0.007] }},
]
)",
                     element, material, active) +
         fibre + more;
}

/// Nominal stress that pulls at x1 [Pa]: minus the force on the surroundings over the undeformed area.
double nominal_pa(const StageData& data) {
  return -last(data, "pull_x_N") / area_m2;
}

/// Reaction and stresses at a point, of a stretch l in uniaxial tension.
void expect_uniaxial(const StageData& data, double l, double nominal) {
  const double cauchy = l * nominal;
  EXPECT_NEAR(nominal_pa(data), nominal, 1e-6 * std::abs(nominal));
  EXPECT_NEAR(last(data, "here_stress_xx_Pa"), cauchy, 1e-6 * cauchy);
  EXPECT_NEAR(last(data, "here_stress_yy_Pa"), 0.0, 1e-6 * cauchy);
  EXPECT_NEAR(last(data, "here_stress_xz_Pa"), 0.0, 1e-6 * cauchy);
  EXPECT_NEAR(last(data, "here_von_mises_Pa"), cauchy, 1e-6 * cauchy);
  EXPECT_NEAR(last(data, "here_pressure_Pa"), -cauchy / 3.0, 1e-6 * cauchy);
  EXPECT_NEAR(last(data, "here_jacobian"), 1.0, 1e-7);
}

TEST(FemLaws, MooneyRivlin) {
  const double l = 1.2, c10 = 3e4, c01 = 5e3;
  expect_uniaxial(solved(block("law = \"mooney_rivlin\", c10_pa = 3e4, c01_pa = 5e3", 0.0)), l,
                  2.0 * (l - 1.0 / (l * l)) * (c10 + c01 / l));
}

TEST(FemLaws, FungGuccione) {
  const double l = 1.2, C = 2e3, bf = 8.0, bt = 2.0;
  const double along = 0.5 * (l * l - 1.0), across = 0.5 * (1.0 / l - 1.0);
  const double Q = bf * along * along + 2.0 * bt * across * across;
  const double slope = 2.0 * bf * along * l - 2.0 * bt * across / (l * l);  // dQ/dl at constant volume
  const StageData data =
      solved(block("law = \"fung_guccione\", stiffness_pa = 2e3, bf = 8, bt = 2, bfs = 4", 0.0));
  expect_uniaxial(data, l, 0.5 * C * std::exp(Q) * slope);
  EXPECT_NEAR(last(data, "here_fibre_stretch"), l, 1e-8);
}

TEST(FemLaws, BlemkerMuscleActive) {
  // Along the fibre at constant volume the shear invariants vanish: P = sigma_max (f_p + a f_a)/l_ofl.
  const double l = 1.2, passive = 0.05 * (std::exp(6.6 * (l - 1.0)) - 1.0),
               active = 1.0 - 4.0 * (1.0 - l) * (1.0 - l);
  const StageData data = solved(
      block("law = \"blemker_muscle\", along_fibre_shear_pa = 500, cross_fibre_shear_pa = 500, "
            "passive_coefficient = 0.05, passive_exponent = 6.6, optimal_stretch = 1.0, max_stress_pa = 3e5, "
            "straightening_stretch = 1.4",
            0.5));
  expect_uniaxial(data, l, 3e5 * (passive + 0.5 * active));
  // The law is written in the deviator: along the fibre two thirds of it, the rest is in the pressure.
  EXPECT_NEAR(last(data, "here_active_stress_Pa"), 2.0 / 3.0 * l * 3e5 * 0.5 * active, 1.0);
}

/// The thesis' muscle at l, without fibres and with.
double ground_pa(double l) {
  return 2.0 * (l - 1.0 / (l * l)) * (3.56463903963e4 + 3.859558659683e3 / l);
}
double fibres_pa(double l, double activation) {
  const double passive = 3.05907e-4 / l * (std::pow(l, 47.270456264135881) - 1.0);
  return passive + activation * 3e5 * std::exp(-std::pow(std::abs(l / 1.4 - 1.0) / 0.57, 4.0));
}

TEST(FemLaws, MuscleTendonWithShareOfSoftTissue) {
  const double l = 1.2;
  expect_uniaxial(solved(block("set = \"sprenger\"", 0.5)), l, ground_pa(l) + fibres_pa(l, 0.5));
  const StageData half =
      solved(block("set = \"sprenger\"", 0.5, "blend = [{ of = \"soft_tissue\", value = 0.25 }]\n"));
  expect_uniaxial(half, l, ground_pa(l) + 0.75 * fibres_pa(l, 0.5));
}

TEST(FemLaws, TendonIsMuscleTendonTissueWithoutMuscle) {
  const double l = 1.2, c1 = 2.31e6, c2 = 1.15;
  const double nominal = 2.0 * (l - 1.0 / (l * l)) * (c1 + c2 / l) + 7.99e6 / l * (std::pow(l, 16.6) - 1.0);
  expect_uniaxial(solved(block("set = \"sprenger\"", 0.0, "blend = [{ of = \"muscle\", value = 0 }]\n")), l,
                  nominal);
}

TEST(FemLaws, BubbleTetrahedraGiveTheSame) {
  const double l = 1.2;
  const StageData data = solved(
      block("set = \"sprenger\"", 0.5, "solver = { volume_tolerance = 1e-10 }\n", "p2b_p1_discontinuous"));
  EXPECT_NEAR(nominal_pa(data), ground_pa(l) + fibres_pa(l, 0.5), 1e-6 * nominal_pa(data));
}

/// At a steady rate the active stress is Hill's hyperbola times the isometric one; held, it is isometric.
TEST(FemLaws, ARateChangesTheActiveStressWhileItLasts) {
  const std::string rate =
      "set = \"sprenger\", max_rate_per_s = 5, force_velocity_curvature = 0.25, eccentric_force = 1.4";
  std::string text = block(rate, 0.0);
  text = with(text, "phase = [",
              "phase = [{ name = \"activate\", activation = { block = 0.5 }, steps = 2, "
              "duration_s = 1e6 }, ");
  const double l = 1.2;
  const double isometric = ground_pa(l) + fibres_pa(l, 0.5);
  const double lengthening = nominal_pa(solved(text));
  EXPECT_GT(lengthening, isometric + 0.02 * fibres_pa(l, 0.5)) << "it was being lengthened";
  EXPECT_LT(lengthening, ground_pa(l) + 1.4 * fibres_pa(l, 0.5)) << "and no more than Hill's limit";
  text = with(text, "duration_s = 0.5 }",
              "duration_s = 0.5 }, { name = \"hold\", activation = { block = 0.5 }, "
              "amplitude = { pull = 1.0 }, steps = 1, duration_s = 1e3 }");
  EXPECT_NEAR(nominal_pa(solved(text)), isometric, 1e-6 * isometric);
}

TEST(FemLaws, PennationTurnsHarmonicFibres) {
  const auto stretch = [](double angle_deg) {
    const std::string fibre = fmt::format(
        "fibre = [{{ kind = \"harmonic\", origin = \"x0\", insertion = \"x1\", pennation_deg = {}, "
        "pennation_axis = [0, 0, 1] }}]\n",
        angle_deg);
    return last(solved(with(block("set = \"sprenger\"", 0.0),
                            "fibre = [{ kind = \"constant\", direction = [1, 0, 0] }]\n", fibre)),
                "here_fibre_stretch");
  };
  EXPECT_NEAR(stretch(0.0), 1.2, 1e-8);
  EXPECT_LT(stretch(30.0), 1.2 - 0.02);
  EXPECT_LT(stretch(60.0), 1.0) << "closer to the direction that thins";
}

/// A straight rod between clamps, shortened by 5 %: Euler's load is passed at 4 pi^2 I / (A L^2) = 3.3 %.
const std::string rod = R"(element = "q2_p1_discontinuous"
mesh = { block = { size_m = [0.1, 0.01, 0.015], cells = [10, 1, 1] } }
material = [{ law = "neo_hooke", shear_modulus_pa = 2e4, incompressible = true }]
boundary = [{ name = "left", surface = "x0", kind = "fixed" },
            { name = "right", surface = "x1", kind = "displacement", x_m = -0.005, y_m = 0, z_m = 0 }]
phase = [{ name = "press", amplitude = { right = 1 }, steps = 4 }]
output = [{ name = "middle", kind = "displacement", point_m = [0.05, 0.005, 0.0075] }]
solver = { on_instability = "report" }
)";

TEST(FemLaws, AnUnstableEquilibriumIsSaidInTheVerdictOrLeft) {
  const StageData straight = solved(rod);
  EXPECT_THAT(straight.attributes.at("verdict"), HasSubstr("UNSTABLE"));
  EXPECT_NEAR(std::hypot(last(straight, "middle_y_m"), last(straight, "middle_z_m")), 0.0, 1e-6);
  const StageData bent = solved(with(rod, "\"report\"", "\"relax\""));
  EXPECT_THAT(bent.attributes.at("verdict"), testing::Not(HasSubstr("UNSTABLE")));
  EXPECT_GT(std::hypot(last(bent, "middle_y_m"), last(bent, "middle_z_m")), 2e-3) << "it has buckled";
}

/// 60 % in one step, with fibres whose stiffness grows as the 46th power of their stretch.
TEST(FemLaws, ACorrectionThatGoesTooFarIsDampedAndTheStepConverges) {
  const StageData data = solved(R"(mesh = { block = { size_m = [0.04, 0.01, 0.01], cells = [4, 2, 2] } }
material = [{ set = "sprenger", incompressible = true }]
fibre = [{ kind = "constant", direction = [1, 0, 0] }]
boundary = [{ name = "left", surface = "x0", kind = "fixed" },
            { name = "right", surface = "x1", kind = "displacement", x_m = 0.024, y_m = 0, z_m = 0 }]
phase = [{ name = "stretch", amplitude = { right = 1 }, steps = 1 }]
solver = { predictor = false, chord = false }
)");
  const data::Table& iterations = data.tables.at("iterations");
  const std::vector<double>&part = iterations.numbers("line_search"),
        &left = iterations.numbers("relative_residual");
  const auto& kind = iterations.texts("kind");
  const auto end = static_cast<std::size_t>(std::find(kind.begin() + 1, kind.end(), "cut") - kind.begin());
  EXPECT_LT(*std::min_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(end)), 0.5);
  EXPECT_LT(left[end - 1], 1e-8)
      << "the same step, before it was cut to see whether its end is a branch of its own";
}

TEST(FemLaws, APointOutsideTheBodyIsTold) {
  EXPECT_THAT(mistakes(with(block("law = \"mooney_rivlin\", c10_pa = 3e4, c01_pa = 5e3", 0.0),
                            "point_m = [0.013", "point_m = [0.13")),
              HasSubstr("error[point-outside]: output `here`: "));
}

}  // namespace
}  // namespace brachium::pipelines::tests
