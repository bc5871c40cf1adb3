/// Quadrature rules integrate monomials exactly up to their degree, and not beyond it.

#include <cmath>

#include "fem/element/quadrature.hpp"

namespace brachium::fem {
namespace {

double factorial(int n) {
  return std::tgamma(n + 1.0);
}

/// Integral of x^i y^j z^k over the unit simplex of that dimension.
double simplex_integral(const std::vector<int>& powers) {
  double numerator = 1.0;
  int sum = static_cast<int>(powers.size());
  for (const int p : powers) {
    numerator *= factorial(p);
    sum += p;
  }
  return numerator / factorial(sum);
}

/// Integral of a monomial over [-1, 1]^d.
double cube_integral(const std::vector<int>& powers) {
  double value = 1.0;
  for (const int p : powers) value *= p % 2 ? 0.0 : 2.0 / (p + 1);
  return value;
}

/// Largest error over all monomials of total degree `degree`.
double error(const Quadrature& rule, int degree, bool simplex) {
  const auto dimension = static_cast<std::size_t>(rule.points.rows());
  double worst = 0.0;
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; j <= degree - i; ++j) {
      std::vector<int> powers{i, j};
      if (dimension == 3) powers.push_back(degree - i - j);
      if (dimension == 2 && i + j != degree) continue;
      double sum = 0.0;
      for (int q = 0; q < rule.size(); ++q) {
        double value = rule.weights[q];
        for (std::size_t d = 0; d < dimension; ++d)
          value *= std::pow(rule.points(static_cast<Eigen::Index>(d), q), powers[d]);
        sum += value;
      }
      worst = std::max(worst, std::abs(sum - (simplex ? simplex_integral(powers) : cube_integral(powers))));
    }
  }
  return worst;
}

void expect_degree(const Quadrature& rule, int degree, bool simplex) {
  for (int d = 0; d <= degree; ++d) EXPECT_LT(error(rule, d, simplex), 1e-14) << "degree " << d;
  EXPECT_GT(error(rule, degree + 1, simplex), 1e-8);
}

TEST(Quadrature, IntegratesTetrahedraToTheirDegree) {
  expect_degree(cell_quadrature(Formulation::p2_p1_taylor_hood), 5, true);
  expect_degree(cell_quadrature(Formulation::p2b_p1_discontinuous), 6, true);
}

TEST(Quadrature, IntegratesTrianglesToTheirDegree) {
  expect_degree(face_quadrature(data::CellType::tet4), 2, true);
  expect_degree(face_quadrature(data::CellType::tet10), 4, true);
}

TEST(Quadrature, IntegratesHexahedraAndQuadrilateralsToTheirDegree) {
  expect_degree(cell_quadrature(Formulation::q1_p0), 3, false);
  expect_degree(cell_quadrature(Formulation::q2_p1_discontinuous), 5, false);
  expect_degree(face_quadrature(data::CellType::hex8), 3, false);
  expect_degree(face_quadrature(data::CellType::hex27), 5, false);
  for (int n = 1; n <= 5; ++n) expect_degree(gauss_hexahedron(n), 2 * n - 1, false);
}

}  // namespace
}  // namespace brachium::fem
