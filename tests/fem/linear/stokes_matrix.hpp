#pragma once
// The saddle point of incompressible flow or small strain on Taylor-Hood elements: ∇u : ∇v on 27-node
// hexahedra of unit size, pressure on their corners, [K B'; B 0]. Tensor products of integrals over a unit
// interval. The face x = 0 is held.

#include <array>

#include "tests/fem/linear/sparse_matrices.hpp"

namespace brachium::fem::test {

struct Interval {
  // Quadratic shape functions at 0, 1/2, 1 and linear ones at 0, 1, integrated with Gauss' three points.
  double mass[3][3] = {}, stiffness[3][3] = {}, mixed[2][3] = {}, gradient[2][3] = {};

  Interval() {
    const double h = std::sqrt(0.6) / 2.0;
    const std::array<double, 3> point{0.5 - h, 0.5, 0.5 + h}, weight{5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};
    for (int q = 0; q < 3; ++q) {
      const double x = point[q];
      const std::array<double, 3> phi{(1 - x) * (1 - 2 * x), 4 * x * (1 - x), x * (2 * x - 1)};
      const std::array<double, 3> slope{4 * x - 3, 4 - 8 * x, 4 * x - 1};
      const std::array<double, 2> psi{1 - x, x};
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) {
          mass[a][b] += weight[q] * phi[a] * phi[b];
          stiffness[a][b] += weight[q] * slope[a] * slope[b];
        }
        for (int v = 0; v < 2; ++v) {
          mixed[v][a] += weight[q] * psi[v] * phi[a];
          gradient[v][a] += weight[q] * psi[v] * slope[a];
        }
      }
    }
  }
};

struct Stokes {
  Matrix matrix;
  int pressures = 0;
};

// `held` false leaves the rigid translations free.
inline Stokes stokes(int ex, int ey, int ez, bool held = true) {
  const int nx = 2 * ex + 1, ny = 2 * ey + 1, nz = 2 * ez + 1;
  const auto node = [&](int x, int y, int z) { return (z * ny + y) * nx + x; };
  const auto corner = [&](int x, int y, int z) { return (z * (ey + 1) + y) * (ex + 1) + x; };
  // Unknowns: displacements of the free nodes by nodes, then pressures.
  std::vector<int> first(nx * ny * nz, -1);
  Stokes result;
  UnknownGroups groups;
  int n = 0;
  for (int v = 0; v < nx * ny * nz; ++v) {
    if (held && v % nx == 0) continue;
    first[v] = n;
    n += 3;
    groups.block_of_unknown.insert(groups.block_of_unknown.end(), 3, v);
    groups.constraint.insert(groups.constraint.end(), 3, 0);
  }
  const int first_pressure = n;
  result.pressures = (ex + 1) * (ey + 1) * (ez + 1);
  for (int p = 0; p < result.pressures; ++p, ++n) {
    groups.block_of_unknown.push_back(nx * ny * nz + p);
    groups.constraint.push_back(1);
  }
  const Interval one;
  std::vector<Eigen::Triplet<double>> lower;
  for (int p = first_pressure; p < n; ++p) lower.emplace_back(p, p, 0.0);
  for (int element = 0; element < ex * ey * ez; ++element) {
    const int x = element % ex, y = element / ex % ey, z = element / (ex * ey);
    for (int a = 0; a < 27; ++a) {
      const int a0 = a % 3, a1 = a / 3 % 3, a2 = a / 9, va = first[node(2 * x + a0, 2 * y + a1, 2 * z + a2)];
      if (va < 0) continue;
      for (int b = 0; b < 27; ++b) {
        const int b0 = b % 3, b1 = b / 3 % 3, b2 = b / 9,
                  vb = first[node(2 * x + b0, 2 * y + b1, 2 * z + b2)];
        if (vb < 0 || vb > va) continue;
        const double k = one.stiffness[a0][b0] * one.mass[a1][b1] * one.mass[a2][b2] +
                         one.mass[a0][b0] * one.stiffness[a1][b1] * one.mass[a2][b2] +
                         one.mass[a0][b0] * one.mass[a1][b1] * one.stiffness[a2][b2];
        // The three displacements of a node couple in the pattern, as they do at finite strain.
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) {
            if (va + i >= vb + j) lower.emplace_back(va + i, vb + j, i == j ? k : 0.0);
          }
        }
      }
      for (int c = 0; c < 8; ++c) {
        const int c0 = c % 2, c1 = c / 2 % 2, c2 = c / 4, p = first_pressure + corner(x + c0, y + c1, z + c2);
        lower.emplace_back(p, va, -one.gradient[c0][a0] * one.mixed[c1][a1] * one.mixed[c2][a2]);
        lower.emplace_back(p, va + 1, -one.mixed[c0][a0] * one.gradient[c1][a1] * one.mixed[c2][a2]);
        lower.emplace_back(p, va + 2, -one.mixed[c0][a0] * one.mixed[c1][a1] * one.gradient[c2][a2]);
      }
    }
  }
  Eigen::SparseMatrix<double> sum(n, n);
  sum.setFromTriplets(lower.begin(), lower.end());
  Matrix& m = result.matrix;
  m.pattern.n = n;
  m.pattern.column_start.assign(sum.outerIndexPtr(), sum.outerIndexPtr() + n + 1);
  m.pattern.row.assign(sum.innerIndexPtr(), sum.innerIndexPtr() + sum.nonZeros());
  m.values.assign(sum.valuePtr(), sum.valuePtr() + sum.nonZeros());
  m.groups = std::move(groups);
  return result;
}

}  // namespace brachium::fem::test
