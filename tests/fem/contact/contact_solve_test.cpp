/// Contact inside the solver: a uniform state across a contact surface, and Hertz' sphere on an elastic half
/// space.

#include <cmath>
#include <limits>
#include <numbers>

#include "fem/contact/contact.hpp"
#include "fem/mesh/block.hpp"
#include "fem/solve/solve.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;

constexpr double infinite = std::numeric_limits<double>::infinity();

struct Pressed {
  Summary summary;
  std::vector<ContactSums> sums;
  ContactPoints points;
};

Pressed press(const Problem& problem, const SolveOptions& options) {
  Pressed result;
  Configuration last;
  Eigen::VectorXd amplitude(static_cast<Eigen::Index>(problem.conditions.size()));
  result.summary = solve(problem, options, [&](const AcceptedState& s) {
    last = s.state.configuration;
    for (std::size_t i = 0; i < problem.conditions.size(); ++i)
      amplitude[static_cast<Eigen::Index>(i)] = s.state.amplitude.at(problem.conditions[i].name);
  });
  if (!result.summary.completed) return result;
  const Discretisation d(problem.mesh, problem.formulation);
  const Contacts contacts(problem, d, 1.0, 1.0);
  result.sums = contacts.sums(amplitude, last.dofs, last.contact_multiplier);
  result.points = contacts.points(0, amplitude, last.dofs, last.contact_multiplier);
  return result;
}

TEST(ContactSolve, CarriesAUniformStateAcrossTheSurface) {
  // An incompressible block between a moving lid and a rigid floor, free sideways: sigma = mu (l^2 - 1/l)
  // exactly, the same at every contact point whatever the mesh.
  data::Mesh mesh = block(Vector3d(1.0, 1.0, 1.0), 2, 2, 2);
  for (Eigen::Index p = 0; p < mesh.points.cols();
       ++p) {  // inner points moved: an irregular mesh with plane sides
    Vector3d x = mesh.points.col(p);
    const Vector3d inside = x.cwiseProduct(Vector3d::Ones() - x) * 4.0;
    mesh.points.col(p) +=
        0.06 * Vector3d(inside[0] * std::sin(3.0 * x[1] + x[2]), inside[1] * std::cos(2.0 * x[0]),
                        inside[2] * std::sin(2.0 * x[0] + 2.0 * x[1]));
  }
  Problem problem;
  problem.mesh = std::make_shared<const data::Mesh>(std::move(mesh));
  problem.materials = {{NeoHooke{1e4, false}, {VolumetricLaw::quadratic, infinite}}};
  PrescribedDisplacement lid;
  lid.displacement_m[2] = -0.2;
  problem.conditions = {
      {"lid", "z1", lid}, {"x", "x0", Fixed{{true, false, false}}}, {"y", "y0", Fixed{{false, true, false}}}};
  // Something must hold the block before it is pressed: the floor does nothing against lifting off.
  Contact floor;
  floor.name = "floor";
  floor.surface = "z0";
  floor.body = HalfSpace{Vector3d::Zero(), Vector3d::UnitZ()};
  floor.penalty_pa_per_m = 1e7;
  floor.penetration_tolerance_m = 1e-10;
  problem.contacts = {floor};
  problem.programme = {{"press", {{"lid", 1.0}}, {}, {}, 2, 1.0}};
  SolveOptions options;
  options.threads = 1;
  options.volume_tolerance = 1e-10;
  options.relative_residual = 1e-10;
  const Pressed result = press(problem, options);
  ASSERT_TRUE(result.summary.completed) << result.summary.reason;
  const double l = 0.8, nominal = 1e4 * (l - 1.0 / (l * l));
  EXPECT_NEAR(result.sums[0].force_n[2], -nominal, 1e-6 * std::abs(nominal));
  EXPECT_LT(result.points.gap_m.cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_LT((result.points.pressure_pa.array() + nominal).abs().maxCoeff(), 1e-5 * std::abs(nominal));
}

TEST(ContactSolve, PressesASphereIntoAHalfSpaceAsHertzDid) {
  // Rigid sphere of radius R, depth d: F = 16/3 mu sqrt(R) d^(3/2) on an incompressible half space (E* = 4
  // mu); Johnson 1985, doi:10.1017/CBO9781139171731, section 4.2. The block is cut out of the half space: its
  // far faces move as under the point force F (Boussinesq, ibid. section 3.2).
  const double R = 1.0, depth = 1e-4, mu = 1e4, a = std::sqrt(R * depth);
  const double F = 16.0 / 3.0 * mu * std::sqrt(R) * std::pow(depth, 1.5);
  BlockOptions options;
  options.x = {6.0 * a, 6, 9.0, false};
  options.y = options.x;
  options.z = {6.0 * a, 6, 1.0 / 9.0, false};
  options.corner_m = Vector3d(0.0, 0.0, -6.0 * a);
  Problem problem;
  problem.mesh = std::make_shared<const data::Mesh>(block(options));
  problem.materials = {{NeoHooke{mu, false}, {VolumetricLaw::quadratic, 1e3 * mu}}};
  const auto far = [&](const std::string& surface) {
    PrescribedField field;
    const std::vector<int> points = problem.mesh->surface_points(surface);
    field.displacement_m.resize(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d x = problem.mesh->points.col(points[i]);
      const double z = -x[2], rho = x.norm(), scale = F / (4.0 * std::numbers::pi * mu);
      field.displacement_m.col(static_cast<Eigen::Index>(i)) =
          scale * Vector3d(x[0] * z / std::pow(rho, 3), x[1] * z / std::pow(rho, 3),
                           -(z * z / std::pow(rho, 3) + 1.0 / rho));
    }
    return field;
  };
  problem.conditions = {{"x", "x0", Fixed{{true, false, false}}},
                        {"y", "y0", Fixed{{false, true, false}}},
                        {"bottom", "z0", far("z0")},
                        {"side x", "x1", far("x1")},
                        {"side y", "y1", far("y1")}};
  Contact ball;
  ball.name = "ball";
  ball.surface = "z1";
  ball.body = Sphere{Vector3d(0.0, 0.0, R - depth), R};
  ball.penalty_pa_per_m = 20.0 * mu / a;
  ball.penetration_tolerance_m = 5e-3 * depth;  // a quadratic face follows the sphere to about that
  problem.contacts = {ball};
  problem.programme = {{"press", {{"bottom", 1.0}, {"side x", 1.0}, {"side y", 1.0}}, {}, {}, 1, 1.0}};
  SolveOptions solving;
  solving.threads = 1;
  const Pressed result = press(problem, solving);
  ASSERT_TRUE(result.summary.completed) << result.summary.reason;
  EXPECT_NEAR(-4.0 * result.sums[0].force_n[2], F, 0.02 * F);
  EXPECT_NEAR(4.0 * result.sums[0].area_m2, std::numbers::pi * a * a, 0.15 * std::numbers::pi * a * a);
  EXPECT_LE(result.sums[0].greatest_penetration_m, 5e-3 * depth);
  EXPECT_NEAR(result.sums[0].greatest_pressure_pa, 1.5 * F / (std::numbers::pi * a * a),
              0.05 * 1.5 * F / (std::numbers::pi * a * a));
}

TEST(ContactSolve, NamesAMotionThatABodyCannotShare) {
  Problem problem;
  problem.mesh = std::make_shared<const data::Mesh>(block(Vector3d(1.0, 1.0, 1.0), 1, 1, 1));
  problem.conditions = {{"turn", "z1", RigidMotion{}}, {"hold", "z0", Fixed{}}};
  Contact contact;
  contact.name = "ulna";
  contact.surface = "x1";
  contact.body = Sphere{Vector3d(3.0, 0.0, 0.0), 1.0};
  contact.moves_with = "tern";
  problem.contacts = {contact};
  const Discretisation d(problem.mesh, problem.formulation);
  try {
    const Contacts contacts(problem, d, 1.0, 1.0);
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].message,
              "contact `ulna` moves with `tern`, which is no rigid motion of the problem");
    EXPECT_EQ(e.diagnostics()[0].help, "did you mean `turn`?");
  }
}

}  // namespace
}  // namespace brachium::fem
