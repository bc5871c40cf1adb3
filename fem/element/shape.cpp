#include "fem/element/shape.hpp"

#include <array>
#include <stdexcept>

namespace brachium::fem {
namespace {

using data::CellType;

/// Local coordinates of the nodes of a hexahedron in [-1, 1]^3, in the order of data/model/mesh.hpp.
constexpr std::array<std::array<int, 3>, 27> hexahedron{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1},
     {1, 1, 1},    {-1, 1, 1},                                                    // corners
     {0, -1, -1},  {1, 0, -1},  {0, 1, -1}, {-1, 0, -1},                          // bottom edges
     {0, -1, 1},   {1, 0, 1},   {0, 1, 1},  {-1, 0, 1},                           // top edges
     {-1, -1, 0},  {1, -1, 0},  {1, 1, 0},  {-1, 1, 0},                           // upright edges
     {-1, 0, 0},   {1, 0, 0},   {0, -1, 0}, {0, 1, 0},   {0, 0, -1},  {0, 0, 1},  // face centres
     {0, 0, 0}}};

constexpr std::array<std::array<int, 2>, 6> tetrahedron_edges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
constexpr std::array<std::array<int, 2>, 3> triangle_edges{{{0, 1}, {1, 2}, {2, 0}}};

/// Local coordinates of the nodes of a quadrilateral.
constexpr std::array<std::array<int, 2>, 9> quadrilateral{
    {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {0, -1}, {1, 0}, {0, 1}, {-1, 0}, {0, 0}}};

struct Line {
  double value, slope;
};

/// Linear Lagrange polynomial that is 1 at `node` in {-1, 1}.
Line linear(int node, double x) {
  return {0.5 * (1.0 + node * x), 0.5 * node};
}

/// Quadratic Lagrange polynomial that is 1 at `node` in {-1, 0, 1}.
Line quadratic(int node, double x) {
  if (node == 0) return {1.0 - x * x, -2.0 * x};
  return {0.5 * x * (x + node), x + 0.5 * node};
}

template <std::size_t N, std::size_t Total>
Shape tensor(const std::array<std::array<int, N>, Total>& nodes, int count, bool second_order,
             const double* xi) {
  Shape shape{Eigen::VectorXd(count), Eigen::MatrixXd(count, static_cast<Eigen::Index>(N))};
  for (int a = 0; a < count; ++a) {
    std::array<Line, N> line;
    for (std::size_t d = 0; d < N; ++d) {
      const int node = nodes[static_cast<std::size_t>(a)][d];
      line[d] = second_order ? quadratic(node, xi[d]) : linear(node, xi[d]);
    }
    double value = 1.0;
    for (std::size_t d = 0; d < N; ++d) value *= line[d].value;
    shape.value[a] = value;
    for (std::size_t d = 0; d < N; ++d) {
      double slope = line[d].slope;
      for (std::size_t e = 0; e < N; ++e) {
        if (e != d) slope *= line[e].value;
      }
      shape.derivative(a, static_cast<Eigen::Index>(d)) = slope;
    }
  }
  return shape;
}

/// Serendipity functions of corners 1/2^d prod(1 + n_i x_i) (sum n_i x_i - (d - 1)) and of mid-edge nodes
/// 1/2^(d-1) (1 - x_k^2) prod_{i != k}(1 + n_i x_i).
template <std::size_t N, std::size_t Total>
Shape serendipity(const std::array<std::array<int, N>, Total>& nodes, int count, const double* xi) {
  Shape shape{Eigen::VectorXd(count), Eigen::MatrixXd(count, static_cast<Eigen::Index>(N))};
  for (int a = 0; a < count; ++a) {
    const auto& n = nodes[static_cast<std::size_t>(a)];
    std::array<double, N> factor, slope;
    bool corner = true;
    for (std::size_t d = 0; d < N; ++d) {
      if (n[d] == 0) {
        corner = false;
        factor[d] = 1.0 - xi[d] * xi[d];
        slope[d] = -2.0 * xi[d];
      } else {
        factor[d] = 0.5 * (1.0 + n[d] * xi[d]);
        slope[d] = 0.5 * n[d];
      }
    }
    double product = 1.0, sum = -(static_cast<double>(N) - 1.0);
    for (std::size_t d = 0; d < N; ++d) {
      product *= factor[d];
      sum += n[d] * xi[d];
    }
    shape.value[a] = corner ? product * sum : product;
    for (std::size_t d = 0; d < N; ++d) {
      double p = slope[d];
      for (std::size_t e = 0; e < N; ++e) {
        if (e != d) p *= factor[e];
      }
      shape.derivative(a, static_cast<Eigen::Index>(d)) = corner ? p * sum + product * n[d] : p;
    }
  }
  return shape;
}

/// Linear or quadratic functions of a simplex from its barycentric coordinates.
template <std::size_t Corners, std::size_t Edges>
Shape simplex(const std::array<std::array<int, 2>, Edges>& edges, bool second_order, const double* xi) {
  constexpr int dimension = static_cast<int>(Corners) - 1;
  std::array<double, Corners> l;
  Eigen::MatrixXd dl = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(Corners), dimension);
  l[0] = 1.0;
  for (int d = 0; d < dimension; ++d) {
    l[0] -= xi[d];
    l[static_cast<std::size_t>(d) + 1] = xi[d];
    dl(0, d) = -1.0;
    dl(d + 1, d) = 1.0;
  }
  const int count = static_cast<int>(Corners + (second_order ? Edges : 0));
  Shape shape{Eigen::VectorXd(count), Eigen::MatrixXd(count, dimension)};
  for (int a = 0; a < static_cast<int>(Corners); ++a) {
    const double la = l[static_cast<std::size_t>(a)];
    shape.value[a] = second_order ? la * (2.0 * la - 1.0) : la;
    shape.derivative.row(a) = second_order ? ((4.0 * la - 1.0) * dl.row(a)).eval() : dl.row(a).eval();
  }
  if (second_order) {
    for (std::size_t e = 0; e < Edges; ++e) {
      const int a = edges[e][0], b = edges[e][1];
      const double la = l[static_cast<std::size_t>(a)], lb = l[static_cast<std::size_t>(b)];
      const auto row = static_cast<Eigen::Index>(Corners + e);
      shape.value[row] = 4.0 * la * lb;
      shape.derivative.row(row) = 4.0 * (la * dl.row(b) + lb * dl.row(a));
    }
  }
  return shape;
}

Eigen::Matrix3Xd coordinates(CellType type) {
  const int count = data::nodes_per_cell(type);
  Eigen::Matrix3Xd x = Eigen::Matrix3Xd::Zero(3, count);
  if (type == CellType::tet4 || type == CellType::tet10) {
    for (int a = 1; a < 4; ++a) x(a - 1, a) = 1.0;
    for (int a = 4; a < count; ++a) {
      const auto& edge = tetrahedron_edges[static_cast<std::size_t>(a - 4)];
      x.col(a) = 0.5 * (x.col(edge[0]) + x.col(edge[1]));
    }
    return x;
  }
  for (int a = 0; a < count; ++a) {
    for (int d = 0; d < 3; ++d)
      x(d, a) = hexahedron[static_cast<std::size_t>(a)][static_cast<std::size_t>(d)];
  }
  return x;
}

}  // namespace

Shape cell_shape(CellType type, const Eigen::Vector3d& xi) {
  switch (type) {
    case CellType::tet4:
      return simplex<4>(tetrahedron_edges, false, xi.data());
    case CellType::tet10:
      return simplex<4>(tetrahedron_edges, true, xi.data());
    case CellType::hex8:
      return tensor(hexahedron, 8, false, xi.data());
    case CellType::hex20:
      return serendipity(hexahedron, 20, xi.data());
    case CellType::hex27:
      return tensor(hexahedron, 27, true, xi.data());
  }
  throw std::logic_error("cell type without shape functions");
}

Shape bubble_shape(const Eigen::Vector3d& xi) {
  const double l0 = 1.0 - xi[0] - xi[1] - xi[2], l1 = xi[0], l2 = xi[1], l3 = xi[2];
  Shape shape{Eigen::VectorXd::Constant(1, 256.0 * l0 * l1 * l2 * l3), Eigen::MatrixXd(1, 3)};
  shape.derivative << 256.0 * l2 * l3 * (l0 - l1), 256.0 * l1 * l3 * (l0 - l2), 256.0 * l1 * l2 * (l0 - l3);
  return shape;
}

Shape face_shape(CellType type, const Eigen::Vector2d& rs) {
  switch (type) {
    case CellType::tet4:
      return simplex<3>(triangle_edges, false, rs.data());
    case CellType::tet10:
      return simplex<3>(triangle_edges, true, rs.data());
    case CellType::hex8:
      return tensor(quadrilateral, 4, false, rs.data());
    case CellType::hex20:
      return serendipity(quadrilateral, 8, rs.data());
    case CellType::hex27:
      return tensor(quadrilateral, 9, true, rs.data());
  }
  throw std::logic_error("cell type without shape functions");
}

const Eigen::Matrix3Xd& node_coordinates(CellType type) {
  static const std::array<Eigen::Matrix3Xd, 5> tables{
      coordinates(CellType::tet4), coordinates(CellType::tet10), coordinates(CellType::hex8),
      coordinates(CellType::hex20), coordinates(CellType::hex27)};
  return tables.at(static_cast<std::size_t>(type));
}

}  // namespace brachium::fem
