// The reactions are the derivative of the energy with respect to what is prescribed, at fixed activation: of
// the force with respect to a displacement, of the moment about the axis with respect to an angle. Central
// differences of fourth order over neighbouring equilibria.

#include <Eigen/Geometry>

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

using Eigen::Vector3d;

class EnergyConsistency : public testing::TestWithParam<Formulation> {};

TEST_P(EnergyConsistency, DerivativeOfTheEnergyIsTheReaction) {
  const Vector3d centre(0.03, 0.005, 0.005), axis = Vector3d(0.5, 0.1, 0.8).normalized(),
                                             shift(0.003, 0.0015, -0.001);
  const double angle = 0.3;
  Problem problem;
  problem.mesh = box_mesh({.type = cell_type(GetParam()),
                           .cells = {3, 1, 1},
                           .size_m = Vector3d(0.03, 0.01, 0.01),
                           .distortion = 0.15});
  problem.formulation = GetParam();
  problem.materials = {{thesis_muscle_tendon(), {VolumetricLaw::quadratic, incompressible}}};
  problem.tissue = uniform_fibres(*problem.mesh, GetParam(), Vector3d(1.0, 0.2, -0.1));
  problem.conditions = {
      condition("origin", "x0", Fixed{}),
      condition("insertion", "x1",
                RigidMotion{.translation_m = shift, .centre_m = centre, .axis = axis, .angle_rad = angle})};
  problem.programme = {phase("move", {{"insertion", 1.0}}, {{"body", 0.4}}, 2)};
  const double h = 2e-3;
  for (const double amplitude : {1.0 - 2 * h, 1.0 - h, 1.0, 1.0 + h, 1.0 + 2 * h})
    problem.programme.push_back(phase("near", {{"insertion", amplitude}}));

  const Discretisation discretisation(problem.mesh, problem.formulation);
  std::vector<double> energy(problem.programme.size(), 0.0);
  double power =
      0.0;  // work of the support per amplitude: -(R · shift + M · axis angle), about the moving centre
  const Summary summary = solve(problem, tight(problem), [&](const AcceptedState& accepted) {
    if (accepted.state.phase_time < 1.0) return;
    energy[static_cast<std::size_t>(accepted.state.phase)] = accepted.record.energy;
    if (accepted.state.phase != 3) return;
    const Wrench w = wrench(discretisation, accepted.state.configuration, accepted.internal_force,
                            accepted.external_force, "x1", centre + shift);
    power = -(w.force_n.dot(shift) + w.moment_n_m.dot(axis) * angle);
  });
  ASSERT_TRUE(summary.completed) << summary.reason;
  const double derivative = (energy[1] - 8.0 * energy[2] + 8.0 * energy[4] - energy[5]) / (12.0 * h);
  EXPECT_NEAR(derivative, power, 1e-7 * std::abs(power));
}

INSTANTIATE_TEST_SUITE_P(Formulations, EnergyConsistency, testing::ValuesIn(mixed_formulations()),
                         named_by_formulation);

}  // namespace
}  // namespace brachium::fem::verification
