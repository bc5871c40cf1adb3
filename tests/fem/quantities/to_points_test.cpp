#include "fem/quantities/to_points.hpp"

#include <gtest/gtest.h>

#include "tests/fem/quantities/affine.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;
using verification::box_mesh;

Eigen::MatrixXd sampled(const Discretisation& d, const std::function<double(const Vector3d&)>& f) {
  const int n_q = d.quadrature().size();
  Eigen::MatrixXd values(1, static_cast<Eigen::Index>(n_q) * d.cell_count());
  for (int c = 0; c < d.cell_count(); ++c) {
    for (int q = 0; q < n_q; ++q) values(0, q + static_cast<Eigen::Index>(n_q) * c) = f(d.position(c, q));
  }
  return values;
}

TEST(ToPoints, ReproducesLinearFieldsOnDistortedMeshes) {
  const auto field = [](const Vector3d& x) { return 2.0 - x[0] + 3.0 * x[1] + 0.5 * x[2]; };
  for (const Formulation formulation : affine::formulations()) {
    // Within a hexahedron a linear field is tri-linear in local coordinates: exact for hex8; the complete
    // quadratic of hex27 holds it in bricks.
    const double distortion = cell_type(formulation) == data::CellType::hex27 ? 0.0 : 0.2;
    const Discretisation d(
        box_mesh({.type = cell_type(formulation), .cells = {2, 2, 2}, .distortion = distortion}),
        formulation);
    const Eigen::MatrixXd nodal = to_points(d, sampled(d, field));
    for (int i = 0; i < d.mesh().point_count(); ++i)
      EXPECT_NEAR(nodal(0, i), field(d.mesh().points.col(i)), 1e-11) << to_string(formulation);
  }
}

TEST(ToPoints, ReproducesQuadraticFieldsInQuadraticCells) {
  const auto field = [](const Vector3d& x) {
    return x[0] * x[0] - 2.0 * x[0] * x[1] + 0.3 * x[2] * x[2] + x[1];
  };
  for (const Formulation formulation : {Formulation::q2_p1_discontinuous, Formulation::p2_p1_taylor_hood}) {
    const Discretisation d(box_mesh({.type = cell_type(formulation), .cells = {2, 2, 2}}), formulation);
    const Eigen::MatrixXd nodal = to_points(d, sampled(d, field));
    for (int i = 0; i < d.mesh().point_count(); ++i)
      EXPECT_NEAR(nodal(0, i), field(d.mesh().points.col(i)), 1e-11) << to_string(formulation);
  }
}

TEST(ToPoints, DoesNotMixRegions) {
  auto mesh = box_mesh({.cells = {2, 1, 1}});
  verification::split_region(*mesh, "second", [](const Vector3d& x) { return x[0] > 0.5; });
  const Discretisation d(mesh, Formulation::q2_p1_discontinuous);
  const Eigen::MatrixXd nodal =
      to_points(d, sampled(d, [](const Vector3d& x) { return x[0] < 0.5 ? 1.0 : 5.0; }));
  for (int i = 0; i < mesh->point_count(); ++i)
    EXPECT_NEAR(nodal(0, i), mesh->points(0, i) < 0.5 + 1e-9 ? 1.0 : 5.0, 1e-12);
}

TEST(ToPoints, RefusesAFieldOfAnotherMesh) {
  const Discretisation d(box_mesh({.type = data::CellType::hex8}), Formulation::q1_p0);
  try {
    to_points(d, Eigen::MatrixXd::Zero(1, 7));
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].message,
              "a field of 7 columns was given for 8 quadrature points of 1 cells");
  }
}

}  // namespace
}  // namespace brachium::fem
