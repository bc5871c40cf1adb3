#include "fem/quantities/displacement_at.hpp"

#include <gtest/gtest.h>

#include "tests/fem/quantities/affine.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;
using verification::box_mesh;

TEST(DisplacementAt, IsExactForAffineFieldsInDistortedCells) {
  for (const Formulation formulation : affine::formulations()) {
    const Discretisation d(box_mesh({.type = cell_type(formulation),
                                     .cells = {3, 2, 2},
                                     .size_m = Vector3d(3.0, 2.0, 1.0),
                                     .distortion = 0.2}),
                           formulation);
    const Configuration c = affine::configuration(d, affine::gradient(), Vector3d(0.1, -0.2, 0.3));
    for (const Vector3d& X : {Vector3d(0.1, 0.2, 0.3), Vector3d(2.9, 1.7, 0.9), Vector3d(1.5, 1.0, 0.5),
                              Vector3d(0.0, 0.0, 0.0), Vector3d(3.0, 2.0, 1.0)}) {
      const Vector3d expected =
          (affine::gradient() - Eigen::Matrix3d::Identity()) * X + Vector3d(0.1, -0.2, 0.3);
      EXPECT_LT((displacement_at(d, c, X) - expected).norm(), 1e-12)
          << to_string(formulation) << " " << X.transpose();
    }
  }
}

TEST(Locate, FindsTheCellAndCoordinatesOfAPointInACurvedCell) {
  const auto bend = [](const Vector3d& x) {
    return Vector3d(x[0], x[1] + 0.3 * x[0] * x[0], x[2] + 0.1 * x[0] * x[1]);
  };
  const Discretisation d(box_mesh({.cells = {2, 2, 1}, .map = bend, .curved = true}),
                         Formulation::q2_p1_discontinuous);
  for (int cell = 0; cell < d.cell_count(); ++cell) {
    const Vector3d xi(0.3, -0.6, 0.95);
    const Located found = locate(d, cell_point(d, {}, cell, xi).position);
    EXPECT_EQ(found.cell, cell);
    EXPECT_LT((found.xi - xi).norm(), 1e-10);
  }
}

TEST(Locate, NamesTheNearestCellOfAPointOutside) {
  const Discretisation d(box_mesh({.type = data::CellType::hex8, .cells = {2, 1, 1}}), Formulation::q1_p0);
  try {
    locate(d, Vector3d(1.25, 0.5, 0.5));
    FAIL();
  } catch (const data::InputError& e) {
    EXPECT_EQ(e.diagnostics()[0].code, "point-outside");
    EXPECT_EQ(e.diagnostics()[0].message, "the point (1.25, 0.5, 0.5) m lies in no cell of the mesh");
    EXPECT_EQ(e.diagnostics()[0].help, "the nearest is cell 1, whose centre is 0.5 m away");
  }
}

}  // namespace
}  // namespace brachium::fem
