/// Shape functions: interpolation, partition of unity, derivatives by differences, polynomials they must
/// reproduce.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fem/element/shape.hpp"

namespace brachium::fem {
namespace {

using data::CellType;

constexpr CellType all_types[] = {CellType::tet4, CellType::tet10, CellType::hex8, CellType::hex20,
                                  CellType::hex27};

class EveryCell : public testing::TestWithParam<CellType> {};
INSTANTIATE_TEST_SUITE_P(ShapeFunctions, EveryCell, testing::ValuesIn(all_types),
                         [](const auto& instance) { return data::to_string(instance.param); });

const Eigen::Vector3d inside(0.21, 0.13, 0.34);

TEST_P(EveryCell, IsOneAtItsOwnNodeAndZeroAtTheOthers) {
  const Eigen::Matrix3Xd& nodes = node_coordinates(GetParam());
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) {
    const Shape shape = cell_shape(GetParam(), nodes.col(a));
    EXPECT_NEAR((shape.value - Eigen::VectorXd::Unit(nodes.cols(), a)).norm(), 0.0, 1e-14) << "node " << a;
  }
}

TEST_P(EveryCell, SumsToOne) {
  const Shape shape = cell_shape(GetParam(), inside);
  EXPECT_NEAR(shape.value.sum(), 1.0, 1e-14);
  EXPECT_NEAR(shape.derivative.colwise().sum().norm(), 0.0, 1e-14);
}

TEST_P(EveryCell, DerivativesAgreeWithDifferences) {
  const double h = 1e-6;
  const Shape shape = cell_shape(GetParam(), inside);
  for (int d = 0; d < 3; ++d) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(d);
    const Eigen::VectorXd difference =
        (cell_shape(GetParam(), inside + step).value - cell_shape(GetParam(), inside - step).value) /
        (2.0 * h);
    EXPECT_LT((difference - shape.derivative.col(d)).norm(), 1e-9);
    Eigen::VectorXd wrong = shape.derivative.col(d);
    wrong[0] += 1e-3;  // a deliberately wrong twin must fail
    EXPECT_GT((difference - wrong).norm(), 1e-9);
  }
}

TEST_P(EveryCell, ReproducesThePolynomialsOfItsOrder) {
  const bool quadratic = GetParam() != CellType::tet4 && GetParam() != CellType::hex8;
  const auto f = [quadratic](const Eigen::Vector3d& x) {
    const double linear = 1.0 + 2.0 * x[0] - 3.0 * x[1] + 0.5 * x[2];
    return quadratic ? linear + x[0] * x[1] - 2.0 * x[1] * x[2] + 0.7 * x[0] * x[0] + x[2] * x[2] : linear;
  };
  const Eigen::Matrix3Xd& nodes = node_coordinates(GetParam());
  const Shape shape = cell_shape(GetParam(), inside);
  double value = 0.0;
  for (Eigen::Index a = 0; a < nodes.cols(); ++a) value += shape.value[a] * f(nodes.col(a));
  EXPECT_NEAR(value, f(inside), 1e-13);
}

TEST_P(EveryCell, FacesInterpolateTheCellsNodes) {
  // A face's shape functions give the same point as the cell's at every node of the face, and point outward.
  const Eigen::Matrix3Xd& nodes = node_coordinates(GetParam());
  const Eigen::Vector3d centre = nodes.leftCols(data::corners_per_cell(GetParam())).rowwise().mean();
  const Eigen::Vector2d rs(0.2, 0.3);
  for (int face = 0; face < data::faces_per_cell(GetParam()); ++face) {
    const std::span<const int> local = data::face_nodes(GetParam(), face);
    const Shape shape = face_shape(GetParam(), rs);
    ASSERT_EQ(static_cast<std::size_t>(shape.value.size()), local.size());
    Eigen::Vector3d x = Eigen::Vector3d::Zero(), r = x, s = x;
    for (std::size_t a = 0; a < local.size(); ++a) {
      const auto row = static_cast<Eigen::Index>(a);
      x += shape.value[row] * nodes.col(local[a]);
      r += shape.derivative(row, 0) * nodes.col(local[a]);
      s += shape.derivative(row, 1) * nodes.col(local[a]);
    }
    EXPECT_GT(r.cross(s).dot(x - centre), 0.0) << "face " << face;
    const Shape cell = cell_shape(GetParam(), x);
    for (Eigen::Index a = 0; a < cell.value.size(); ++a) {
      const auto at = std::find(local.begin(), local.end(), static_cast<int>(a));
      const double expected = at == local.end() ? 0.0 : shape.value[at - local.begin()];
      EXPECT_NEAR(cell.value[a], expected, 1e-13) << "face " << face << " node " << a;
    }
  }
}

TEST(Bubble, VanishesOnEveryFaceAndIsOneAtTheCentre) {
  EXPECT_NEAR(bubble_shape(Eigen::Vector3d::Constant(0.25)).value[0], 1.0, 1e-15);
  for (const Eigen::Vector3d& x : {Eigen::Vector3d(0.0, 0.2, 0.3), Eigen::Vector3d(0.2, 0.0, 0.3),
                                   Eigen::Vector3d(0.2, 0.3, 0.0), Eigen::Vector3d(0.2, 0.3, 0.5)}) {
    EXPECT_NEAR(bubble_shape(x).value[0], 0.0, 1e-15);
  }
  const double h = 1e-6;
  for (int d = 0; d < 3; ++d) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(d);
    EXPECT_NEAR((bubble_shape(inside + step).value[0] - bubble_shape(inside - step).value[0]) / (2.0 * h),
                bubble_shape(inside).derivative(0, d), 1e-8);
  }
}

}  // namespace
}  // namespace brachium::fem
