#include "fem/quantities/wrench.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "tests/fem/quantities/affine.hpp"

namespace brachium::fem {
namespace {

using Eigen::Vector3d;
using verification::box_mesh;

TEST(Wrench, SumsForcesAndMomentsOfTheDeformedNodes) {
  auto mesh = box_mesh({.type = data::CellType::hex8});
  mesh->node_sets["two"] = {mesh->cells(1, 0), mesh->cells(6, 0)};  // (1,0,0) and (1,1,1)
  const Discretisation d(mesh, Formulation::q1_p0);
  Configuration c = affine::configuration(d, Eigen::Matrix3d::Identity(), Vector3d(0.0, 0.0, 1.0));
  Eigen::VectorXd internal = Eigen::VectorXd::Zero(d.dof_count()), external = internal;
  internal.segment<3>(3 * mesh->cells(1, 0)) = Vector3d(1.0, 0.0, 0.0);
  internal.segment<3>(3 * mesh->cells(6, 0)) = Vector3d(0.0, 2.0, 0.0);
  external.segment<3>(3 * mesh->cells(6, 0)) = Vector3d(0.0, 0.5, 0.0);
  const Wrench w = wrench(d, c, internal, external, "two", Vector3d(1.0, 0.0, 0.0));
  EXPECT_LT((w.force_n - Vector3d(-1.0, -1.5, 0.0)).norm(), 1e-14);
  // (0,0,1) x (-1,0,0) + (0,1,2) x (0,-1.5,0) = (0,-1,0) + (3,0,0)
  EXPECT_LT((w.moment_n_m - Vector3d(3.0, -1.0, 0.0)).norm(), 1e-14);
  EXPECT_LT((wrench(d, c, internal, {}, "x1", Vector3d::Zero()).force_n - Vector3d(-1.0, -2.0, 0.0)).norm(),
            1e-14);
  EXPECT_THROW(wrench(d, c, internal, external, "x9", Vector3d::Zero()), data::InputError);
}

TEST(Wrench, LineOfActionLeavesAParallelMomentOnly) {
  const Wrench w{Vector3d(1.0, -2.0, 0.5), Vector3d(0.3, 0.7, -0.2)};
  const Vector3d point(0.1, 0.2, 0.3);
  const LineOfAction line = line_of_action(w, point);
  const Wrench there = moved(w, point, line.point_m);
  EXPECT_LT(there.moment_n_m.cross(w.force_n).norm(), 1e-14);
  EXPECT_LT((there.moment_n_m - line.parallel_moment_n_m).norm(), 1e-14);
  EXPECT_THROW(line_of_action({Vector3d::Zero(), Vector3d::UnitX()}, point), data::InputError);
}

TEST(Barycentre, OfASideIsItsMiddleWhateverTheMesh) {
  for (const Formulation formulation : affine::formulations()) {
    const Discretisation d(box_mesh({.type = cell_type(formulation),
                                     .cells = {2, 3, 2},
                                     .size_m = Vector3d(1.0, 2.0, 3.0),
                                     .distortion = 0.2}),
                           formulation);
    const Eigen::Matrix3d F = affine::gradient();
    EXPECT_LT((barycentre(d, affine::configuration(d, F), "x1") - F * Vector3d(1.0, 1.0, 1.5)).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace brachium::fem
