#include "fem/quantities/volumes.hpp"

#include <gtest/gtest.h>

#include "tests/fem/quantities/affine.hpp"

namespace brachium::fem {
namespace {

TEST(RegionVolumes, AreTheReferenceVolumesTimesTheDeterminant) {
  for (const Formulation formulation : affine::formulations()) {
    auto mesh = verification::box_mesh(
        {.type = cell_type(formulation), .cells = {4, 2, 2}, .size_m = Eigen::Vector3d(4.0, 1.0, 1.0)});
    verification::split_region(*mesh, "far", [](const Eigen::Vector3d& x) { return x[0] > 3.0; });
    const Discretisation d(mesh, formulation);
    const Eigen::VectorXd volumes = region_volumes(d, affine::configuration(d, affine::gradient()));
    ASSERT_EQ(volumes.size(), 2);
    EXPECT_NEAR(volumes[0], 3.0 * affine::gradient().determinant(), 1e-12);
    EXPECT_NEAR(volumes[1], 1.0 * affine::gradient().determinant(), 1e-12);
  }
}

}  // namespace
}  // namespace brachium::fem
