// An unloaded, inactive muscle-tendon complex stays where it is: its residual vanishes although muscle and
// tendon meet in a sharp interface through the middle of the body (the ground matrices of the two differ by a
// factor of 65).

#include "tests/fem/verification/study.hpp"

namespace brachium::fem::verification {
namespace {

class RestState : public testing::TestWithParam<Formulation> {
 protected:
  /// Largest nodal force over c1 of the tendon times the area of a cell.
  double residual(double activation) const {
    const double size_m = 0.01;
    auto mesh = box_mesh({.type = cell_type(GetParam()),
                          .cells = {4, 2, 2},
                          .size_m = Eigen::Vector3d(2.0, 1.0, 1.0) * size_m,
                          .distortion = 0.15});
    split_region(*mesh, "tendon", [&](const Eigen::Vector3d& x) { return x[0] > size_m; });
    TissueField tissue = uniform_fibres(*mesh, GetParam(), Eigen::Vector3d(1.0, 0.2, 0.1));
    set_muscle_by_region(tissue, *mesh, GetParam(), "body");
    const MuscleTendon law = thesis_muscle_tendon();
    const RegionMaterial material{law, {VolumetricLaw::quadratic, 1e8}};
    auto discretisation = std::make_shared<Discretisation>(mesh, GetParam());
    const Assembly assembly(discretisation, {material, material}, tissue, 1e8, 1);
    Configuration configuration;
    configuration.dofs = Eigen::VectorXd::Zero(discretisation->dof_count());
    configuration.activation = Eigen::Vector2d(activation, 0.0);
    Eigen::VectorXd force;
    EXPECT_FALSE(assembly.residual(configuration, force).failure);
    return force.cwiseAbs().maxCoeff() / (law.tendon.c1_pa * size_m * size_m / 4.0);
  }
};

TEST_P(RestState, SharpInterfaceHasNoResidual) {
  EXPECT_LT(residual(0.0), 1e-13);
}

TEST_P(RestState, ActivationIsSeen) {
  EXPECT_GT(residual(0.01), 1e-5);
}

INSTANTIATE_TEST_SUITE_P(Formulations, RestState, testing::ValuesIn(all_formulations()),
                         named_by_formulation);

}  // namespace
}  // namespace brachium::fem::verification
