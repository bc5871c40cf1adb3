#include "fem/assembly/surface_load.hpp"

#include <Eigen/Geometry>

#include "bodies.hpp"

namespace brachium::fem {
namespace {

using tests::body;
using tests::soft;

Eigen::VectorXd some_state(const Discretisation& d) {
  Eigen::VectorXd u = Eigen::VectorXd::Zero(d.dof_count());
  for (Eigen::Index k = 0; k < u.size(); ++k) u[k] = 1e-4 * std::sin(1.0 + 1.9 * static_cast<double>(k));
  return u;
}

class SurfaceLoad : public ::testing::TestWithParam<Formulation> {};

TEST_P(SurfaceLoad, PressureTangentIsTheDifferenceOfForcesAndAWrongTwinIsNot) {
  const Problem p = body(GetParam(), {0.02, 0.01, 0.01}, 2, 1, 1, soft(), 0.05);
  const Discretisation d(p.mesh, p.formulation);
  const LoadedSurface surface(d, "x1");
  const Eigen::VectorXd u = some_state(d);
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(d.dof_count(), d.dof_count()), wrong = K;
  for (const FaceTangent& face : surface.pressure_tangent(2e3, u)) {
    for (std::size_t a = 0; a < face.nodes.size(); ++a) {
      for (std::size_t b = 0; b < face.nodes.size(); ++b) {
        const Eigen::Matrix3d block =
            face.values.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b));
        K.block<3, 3>(3 * face.nodes[a], 3 * face.nodes[b]) += block;
        wrong.block<3, 3>(3 * face.nodes[a], 3 * face.nodes[b]) += block.transpose();
      }
    }
  }
  Eigen::MatrixXd difference(d.dof_count(), d.dof_count());
  const double h = 1e-7;
  for (Eigen::Index j = 0; j < d.dof_count(); ++j) {
    Eigen::VectorXd plus = Eigen::VectorXd::Zero(d.dof_count()), minus = plus, up = u, um = u;
    up[j] += h;
    um[j] -= h;
    surface.add_pressure(2e3, up, plus);
    surface.add_pressure(2e3, um, minus);
    difference.col(j) = (plus - minus) / (2.0 * h);
  }
  EXPECT_LT((K - difference).norm(), 1e-8 * K.norm());
  EXPECT_GT((wrong - difference).norm(), 1e-2 * K.norm())
      << "a tangent with the sign of its skew part turned must be told apart";
}

TEST_P(SurfaceLoad, TractionsAddUpToAreaTimesTractionAndMoment) {
  const Problem p = body(GetParam(), {0.02, 0.01, 0.03}, 2, 2, 1, soft());
  const Discretisation d(p.mesh, p.formulation);
  const LoadedSurface surface(d, "x1");
  EXPECT_NEAR(surface.reference_area(), 3e-4, 1e-15);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(d.dof_count());
  const Eigen::Vector3d t(100.0, -20.0, 5.0);
  surface.add_traction(t, f);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = sum;
  for (int n = 0; n < p.mesh->point_count(); ++n) {
    sum += f.segment<3>(3 * n);
    moment += Eigen::Vector3d(p.mesh->points.col(n)).cross(f.segment<3>(3 * n));
  }
  EXPECT_LT((sum - 3e-4 * t).norm(), 1e-14);
  EXPECT_LT((moment - Eigen::Vector3d(0.02, 0.005, 0.015).cross(3e-4 * t)).norm(), 1e-15);
}

TEST_P(SurfaceLoad, PressureOnTheWholeBoundaryHasNoResultantInAnyState) {
  Problem p = body(GetParam(), {0.02, 0.01, 0.01}, 2, 1, 2, soft());
  auto mesh = std::make_shared<data::Mesh>(*p.mesh);
  mesh->surfaces.push_back({"skin", data::boundary_faces(*mesh)});
  const Discretisation d(mesh, p.formulation);
  const LoadedSurface skin(d, "skin");
  const Eigen::VectorXd u = some_state(d);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(d.dof_count());
  skin.add_pressure(1e4, u, f);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero(), moment = sum;
  for (int n = 0; n < mesh->point_count(); ++n) {
    sum += f.segment<3>(3 * n);
    moment += Eigen::Vector3d(mesh->points.col(n) + u.segment<3>(3 * n)).cross(f.segment<3>(3 * n));
  }
  EXPECT_LT(sum.norm(), 1e-13 * f.norm());
  EXPECT_LT(moment.norm(), 1e-13 * f.norm());
}

TEST_P(SurfaceLoad, BodyForceAddsUpToTheWeight) {
  const Problem p = body(GetParam(), {0.02, 0.01, 0.01}, 2, 1, 1, soft(), 0.05);
  const Discretisation d(p.mesh, p.formulation);
  Eigen::VectorXd f = Eigen::VectorXd::Zero(d.dof_count());
  add_body_force(d, Eigen::Vector3d(0.0, 0.0, -9810.0), 2.0, f);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int n = 0; n < p.mesh->point_count(); ++n) sum += f.segment<3>(3 * n);
  EXPECT_NEAR(sum[2], -2.0 * 9810.0 * 2e-6, 1e-12);
  EXPECT_NEAR(sum[0], 0.0, 1e-15);
}

INSTANTIATE_TEST_SUITE_P(Cells, SurfaceLoad,
                         ::testing::Values(Formulation::q1_p0, Formulation::q2_p1_discontinuous,
                                           Formulation::p2_p1_taylor_hood),
                         [](const auto& which) { return to_string(which.param); });

TEST(LoadedSurface, NamesTheNearestSurface) {
  const Problem p = body(Formulation::q1_p0, {1, 1, 1}, 1, 1, 1, soft());
  const Discretisation d(p.mesh, p.formulation);
  EXPECT_THROW(LoadedSurface(d, "x2"), data::InputError);
}

}  // namespace
}  // namespace brachium::fem
