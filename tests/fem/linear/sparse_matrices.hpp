#pragma once
// Matrices for the tests and the benchmark of the sparse solvers.

#include <Eigen/Dense>
#include <Eigen/Sparse>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem::test {

struct Matrix {
  SymmetricPattern pattern;
  std::vector<double> values;
  UnknownGroups groups;

  SymmetricMatrixView view() const { return {&pattern, values.data()}; }
  int n() const { return pattern.n; }

  Eigen::SparseMatrix<double> eigen() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (int j = 0; j < pattern.n; ++j) {
      for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) {
        entries.emplace_back(pattern.row[e], j, values[e]);
        if (pattern.row[e] != j) entries.emplace_back(j, pattern.row[e], values[e]);
      }
    }
    Eigen::SparseMatrix<double> a(pattern.n, pattern.n);
    a.setFromTriplets(entries.begin(), entries.end());
    return a;
  }
};

// Lower triangle by (column, row).
using Entries = std::map<std::pair<int, int>, double>;

inline Matrix from_entries(int n, const Entries& entries) {
  Matrix m;
  m.pattern.n = n;
  m.pattern.column_start.assign(n + 1, 0);
  for (const auto& [at, value] : entries) {
    m.pattern.row.push_back(at.second);
    m.values.push_back(value);
    ++m.pattern.column_start[at.first + 1];
  }
  for (int j = 0; j < n; ++j) m.pattern.column_start[j + 1] += m.pattern.column_start[j];
  return m;
}

inline Matrix dense(const Eigen::MatrixXd& a) {
  Entries entries;
  for (int j = 0; j < a.cols(); ++j) {
    for (int i = j; i < a.rows(); ++i) entries[{j, i}] = a(i, j);
  }
  return from_entries(static_cast<int>(a.rows()), entries);
}

inline Eigen::MatrixXd random_matrix(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd g(n, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) g(i, j) = normal(random);
  }
  return g;
}

// Q diag(λ) Q' with a random rotation Q.
inline Eigen::MatrixXd with_eigenvalues(const Eigen::VectorXd& lambda, unsigned seed) {
  const Eigen::MatrixXd q =
      Eigen::HouseholderQR<Eigen::MatrixXd>(random_matrix(int(lambda.size()), seed)).householderQ();
  const Eigen::MatrixXd a = q * lambda.asDiagonal() * q.transpose();
  return 0.5 * (a + a.transpose());
}

// 7-point Laplacian of a grid with zero boundary values; eigenvalues Σ 4 sin^2(π k / (2 (n + 1))), k = 1 ...
// n in each direction.
inline Matrix laplacian(int nx, int ny, int nz, double shift = 0.0) {
  Entries entries;
  const auto at = [&](int x, int y, int z) { return (z * ny + y) * nx + x; };
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        const int i = at(x, y, z);
        entries[{i, i}] = 6.0 - shift;
        if (x + 1 < nx) entries[{i, at(x + 1, y, z)}] = -1.0;
        if (y + 1 < ny) entries[{i, at(x, y + 1, z)}] = -1.0;
        if (z + 1 < nz) entries[{i, at(x, y, z + 1)}] = -1.0;
      }
    }
  }
  return from_entries(nx * ny * nz, entries);
}

inline long laplacian_eigenvalues_below(int nx, int ny, int nz, double shift) {
  const auto part = [](int k, int n) {
    return 4.0 * std::pow(std::sin(std::numbers::pi * k / (2.0 * (n + 1))), 2);
  };
  long count = 0;
  for (int x = 1; x <= nx; ++x) {
    for (int y = 1; y <= ny; ++y) {
      for (int z = 1; z <= nz; ++z) count += part(x, nx) + part(y, ny) + part(z, nz) < shift ? 1 : 0;
    }
  }
  return count;
}

// A grid of 27-node hexahedra, three unknowns a node, all nodes of an element coupled. The element matrix has
// eigenvalues between 0.01 and 1, `negative` of them replaced by -0.5, and random eigenvectors, the same for
// all elements.
inline Matrix hex27_grid(int ex, int ey, int ez, unsigned seed = 1, int negative = 0) {
  const int nx = 2 * ex + 1, ny = 2 * ey + 1, nz = 2 * ez + 1, nodes = nx * ny * nz;
  const auto node = [&](int x, int y, int z) { return (z * ny + y) * nx + x; };
  // Along one direction, the nodes that share an element with node i.
  const auto range = [](int i, int n) {
    return i % 2 == 1 ? std::pair(i - 1, i + 1) : std::pair(std::max(0, i - 2), std::min(n - 1, i + 2));
  };
  Matrix m;
  m.pattern.n = 3 * nodes;
  m.pattern.column_start.push_back(0);
  for (int v = 0; v < nodes; ++v) {
    const auto [x0, x1] = range(v % nx, nx);
    const auto [y0, y1] = range(v / nx % ny, ny);
    const auto [z0, z1] = range(v / (nx * ny), nz);
    for (int k = 3 * v; k < 3 * v + 3; ++k) {
      for (int z = z0; z <= z1; ++z) {
        for (int y = y0; y <= y1; ++y) {
          for (int x = x0; x <= x1; ++x) {
            for (int l = 3 * node(x, y, z); l < 3 * node(x, y, z) + 3; ++l) {
              if (l >= k) m.pattern.row.push_back(l);
            }
          }
        }
      }
      m.pattern.column_start.push_back(static_cast<int>(m.pattern.row.size()));
      m.groups.block_of_unknown.push_back(v);
    }
  }
  Eigen::VectorXd lambda(81);
  for (int i = 0; i < 81; ++i) lambda(i) = i < negative ? -0.5 : std::pow(10.0, -2.0 * i / 80.0);
  const Eigen::MatrixXd k = with_eigenvalues(lambda, seed);
  m.values.assign(m.pattern.row.size(), 0.0);
  std::vector<int> unknown(81);
  for (int element = 0; element < ex * ey * ez; ++element) {
    const int x = element % ex, y = element / ex % ey, z = element / (ex * ey);
    for (int a = 0; a < 27; ++a) {
      for (int l = 0; l < 3; ++l)
        unknown[3 * a + l] = 3 * node(2 * x + a % 3, 2 * y + a / 3 % 3, 2 * z + a / 9) + l;
    }
    for (int j = 0; j < 81; ++j) {
      int e = m.pattern.column_start[unknown[j]];
      for (int i = j; i < 81; ++i) {  // the unknowns of an element ascend
        while (m.pattern.row[e] != unknown[i]) ++e;
        m.values[e] += k(i, j);
      }
    }
  }
  return m;
}

inline std::vector<double> random_vector(int n, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> x(n);
  for (double& v : x) v = normal(random);
  return x;
}

}  // namespace brachium::fem::test
