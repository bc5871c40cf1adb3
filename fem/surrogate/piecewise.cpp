#include "fem/surrogate/piecewise.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>

#include "data/model/curve.hpp"
#include "data/model/error.hpp"

namespace brachium::fem {
namespace {

void check_nodes(const std::vector<double>& nodes, int degree) {
  if (nodes.size() < 2 || (degree != 1 && degree != 3 && degree != 5)) {
    throw data::InputError(
        "bad-option",
        fmt::format(
            "interpolation of degree {} through {} nodes: degrees are 1, 3 and 5, and two nodes the least",
            degree, nodes.size()));
  }
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    if (!(nodes[i] > nodes[i - 1]))
      throw data::InputError(
          "bad-option", fmt::format("nodes must increase: {:.6g} follows {:.6g}", nodes[i], nodes[i - 1]));
  }
}

// Knots of the spline that interpolates at the nodes: the ends (p + 1) times, the inner nodes but the first
// and last (p - 1)/2.
std::vector<double> not_a_knot(const std::vector<double>& nodes, int degree) {
  const auto p = static_cast<std::size_t>(degree), n = nodes.size();
  std::vector<double> knots(p + 1, nodes.front());
  for (std::size_t i = (p + 1) / 2; i + (p + 1) / 2 < n; ++i) knots.push_back(nodes[i]);
  knots.insert(knots.end(), p + 1, nodes.back());
  return knots;
}

double binomial(int n, int k) {
  double b = 1.0;
  for (int i = 1; i <= k; ++i) b = b * (n - k + i) / i;
  return b;
}

// The polynomial of degree n - 1 through n nodes, re-expanded in every cell; in the variable u = (x - x_0) /
// (x_n - x_0).
PiecewiseMap polynomial_map(const std::vector<double>& nodes) {
  const auto n = static_cast<Eigen::Index>(nodes.size());
  const int p = static_cast<int>(n) - 1;
  const double span = nodes.back() - nodes.front();
  Eigen::MatrixXd vandermonde(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = (nodes[static_cast<std::size_t>(i)] - nodes.front()) / span;
    for (Eigen::Index k = 0; k < n; ++k) vandermonde(i, k) = k == 0 ? 1.0 : vandermonde(i, k - 1) * u;
  }
  const Eigen::MatrixXd power = vandermonde.partialPivLu().inverse();
  PiecewiseMap map{p, Eigen::MatrixXd::Zero((n - 1) * n, n), {}};
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double u0 = (nodes[static_cast<std::size_t>(i)] - nodes.front()) / span;
    const double h = (nodes[static_cast<std::size_t>(i) + 1] - nodes[static_cast<std::size_t>(i)]) / span;
    for (int k = 0; k <= p; ++k) {
      double hk = 1.0;
      for (int e = 0; e < k; ++e) hk *= h;
      double u_power = 1.0;
      for (int j = k; j <= p; ++j, u_power *= u0)
        map.from_values.row(i * n + k) += binomial(j, k) * u_power * hk * power.row(j);
    }
  }
  return map;
}

}  // namespace

SplineValues bsplines(const std::vector<double>& knots, int degree, double x, int derivatives) {
  const auto p = static_cast<std::size_t>(degree);
  // The span with x in [t_j, t_(j+1)), closed at the right end.
  std::size_t j = static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), x) - knots.begin());
  j = std::clamp(j, p + 1, knots.size() - p - 1) - 1;
  SplineValues out;
  out.first = j - p;
  out.derivative = Eigen::MatrixXd::Zero(derivatives + 1, degree + 1);
  // All degrees up to p: N[q][r] is the function j - q + r of degree q.
  std::vector<std::vector<double>> N(p + 1);
  N[0] = {1.0};
  for (std::size_t q = 1; q <= p; ++q) {
    N[q].assign(q + 1, 0.0);
    for (std::size_t r = 0; r < q; ++r) {  // function j - q + 1 + r of degree q - 1
      const std::size_t i = j - q + 1 + r;
      const double w = knots[i + q] - knots[i], left = (x - knots[i]) / w;
      N[q][r + 1] += left * N[q - 1][r];
      N[q][r] += (1.0 - left) * N[q - 1][r];
    }
  }
  for (int d = 0; d <= std::min(derivatives, degree); ++d) {
    // d-th derivative of degree p from functions of degree p - d:  N_i' = q (N_(i,q-1) / w_i - N_(i+1,q-1) /
    // w_(i+1))
    std::vector<double> v = N[p - static_cast<std::size_t>(d)];
    for (std::size_t q = p - static_cast<std::size_t>(d) + 1; q <= p; ++q) {
      std::vector<double> next(q + 1, 0.0);
      for (std::size_t r = 0; r < q; ++r) {
        const std::size_t i = j - q + 1 + r;
        const double slope = static_cast<double>(q) * v[r] / (knots[i + q] - knots[i]);
        next[r + 1] += slope;
        next[r] -= slope;
      }
      v = std::move(next);
    }
    for (std::size_t r = 0; r <= p; ++r) out.derivative(d, static_cast<Eigen::Index>(r)) = v[r];
  }
  return out;
}

PiecewiseMap spline_map(const std::vector<double>& nodes, int degree) {
  check_nodes(nodes, degree);
  if (nodes.size() <= static_cast<std::size_t>(degree)) return polynomial_map(nodes);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  const std::vector<double> knots = not_a_knot(nodes, degree);
  Eigen::MatrixXd at_nodes = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const SplineValues b = bsplines(knots, degree, nodes[static_cast<std::size_t>(i)], 0);
    at_nodes.row(i).segment(static_cast<Eigen::Index>(b.first), degree + 1) = b.derivative.row(0);
  }
  const Eigen::MatrixXd control = at_nodes.partialPivLu().inverse();
  PiecewiseMap map{degree, Eigen::MatrixXd::Zero((n - 1) * (degree + 1), n), {}};
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double h = nodes[static_cast<std::size_t>(i) + 1] - nodes[static_cast<std::size_t>(i)];
    const SplineValues b = bsplines(knots, degree, nodes[static_cast<std::size_t>(i)], degree);
    double factor = 1.0;  // h^k / k!
    for (int k = 0; k <= degree; ++k) {
      if (k > 0) factor *= h / k;
      map.from_values.row(i * (degree + 1) + k) =
          factor * b.derivative.row(k) * control.middleRows(static_cast<Eigen::Index>(b.first), degree + 1);
    }
  }
  return map;
}

Eigen::MatrixXd slope_map(const std::vector<double>& nodes, int degree) {
  const PiecewiseMap map = spline_map(nodes, degree);
  const auto n = static_cast<Eigen::Index>(nodes.size());
  const Eigen::Index stride = map.degree + 1;
  Eigen::MatrixXd slope(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i)
    slope.row(i) = map.from_values.row(i * stride + 1) /
                   (nodes[static_cast<std::size_t>(i) + 1] - nodes[static_cast<std::size_t>(i)]);
  const double h = nodes.back() - nodes[nodes.size() - 2];
  slope.row(n - 1).setZero();
  for (int k = 1; k <= map.degree; ++k) slope.row(n - 1) += k / h * map.from_values.row((n - 2) * stride + k);
  return slope;
}

PiecewiseMap hermite_map(const std::vector<double>& nodes, int degree) {
  check_nodes(nodes, degree);
  if (degree == 1) throw data::InputError("bad-option", "Hermite interpolation has degree 3 or 5");
  const auto n = static_cast<Eigen::Index>(nodes.size());
  if (n == 2) degree = 3;
  const auto h = [&](Eigen::Index i) {
    return nodes[static_cast<std::size_t>(i) + 1] - nodes[static_cast<std::size_t>(i)];
  };
  PiecewiseMap map{degree, Eigen::MatrixXd::Zero((n - 1) * (degree + 1), n),
                   Eigen::MatrixXd::Zero((n - 1) * (degree + 1), n)};
  if (degree == 3) {
    for (Eigen::Index i = 0; i + 1 < n; ++i) {
      auto value = map.from_values.middleRows(4 * i, 4);
      auto slope = map.from_slopes.middleRows(4 * i, 4);
      value(0, i) = 1.0;
      slope(1, i) = h(i);
      value(2, i) = -3.0, value(2, i + 1) = 3.0, slope(2, i) = -2.0 * h(i), slope(2, i + 1) = -h(i);
      value(3, i) = 2.0, value(3, i + 1) = -2.0, slope(3, i) = h(i), slope(3, i + 1) = h(i);
    }
    return map;
  }
  // Derivatives of order 3, 4, 5 in t at the ends of a cell, from values f0 f1, slopes h d0 h d1, seconds h²
  // m0 h² m1:
  //   p'''(0) = 60 Δ - 36 d0 - 24 d1 - 9 m0 + 3 m1        p''''(0) = -360 Δ + 192 d0 + 168 d1 + 36 m0 - 24 m1
  //   p'''(1) = 60 Δ - 24 d0 - 36 d1 - 3 m0 + 9 m1        p''''(1) =  360 Δ - 168 d0 - 192 d1 - 24 m0 + 36 m1
  //   p''''' = 720 Δ - 360 (d0 + d1) - 60 m0 + 60 m1
  struct Row {
    double delta, d0, d1, m0, m1;
  };
  static constexpr Row start[3] = {
      {60, -36, -24, -9, 3}, {-360, 192, 168, 36, -24}, {720, -360, -360, -60, 60}};
  static constexpr Row end[3] = {
      {60, -24, -36, -3, 9}, {360, -168, -192, -24, 36}, {720, -360, -360, -60, 60}};
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n), B = Eigen::MatrixXd::Zero(n, n),
                  C = Eigen::MatrixXd::Zero(n, n);
  const auto scale = [&](Eigen::Index row, Eigen::Index cell, int order, const Row& r, double sign) {
    double f = sign;
    const double mean = nodes.back() - nodes.front();
    for (int k = 0; k < order; ++k) f *= mean / h(cell);
    B(row, cell) -= f * r.delta, B(row, cell + 1) += f * r.delta;
    C(row, cell) += f * r.d0 * h(cell), C(row, cell + 1) += f * r.d1 * h(cell);
    A(row, cell) += f * r.m0 * h(cell) * h(cell), A(row, cell + 1) += f * r.m1 * h(cell) * h(cell);
  };
  const auto continuous = [&](Eigen::Index row, Eigen::Index node, int order) {
    scale(row, node - 1, order, end[order - 3], 1.0);
    scale(row, node, order, start[order - 3], -1.0);
  };
  for (Eigen::Index i = 1; i + 1 < n; ++i) continuous(i, i, 3);
  continuous(0, 1, 4);
  continuous(n - 1, n - 2, n == 3 ? 5 : 4);
  const auto lu = A.partialPivLu();
  const Eigen::MatrixXd second_of_value = -lu.solve(B), second_of_slope = -lu.solve(C);
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const double h1 = h(i), h2 = h1 * h1;
    const auto row = [&](int k, double f0, double delta, double d0, double d1, double m0, double m1) {
      auto v = map.from_values.row(6 * i + k);
      auto s = map.from_slopes.row(6 * i + k);
      v(i) += f0 - delta, v(i + 1) += delta;
      s(i) += d0 * h1, s(i + 1) += d1 * h1;
      v += h2 * (m0 * second_of_value.row(i) + m1 * second_of_value.row(i + 1));
      s += h2 * (m0 * second_of_slope.row(i) + m1 * second_of_slope.row(i + 1));
    };
    row(0, 1, 0, 0, 0, 0, 0);
    row(1, 0, 0, 1, 0, 0, 0);
    row(2, 0, 0, 0, 0, 0.5, 0);
    row(3, 0, 10, -6, -4, -1.5, 0.5);
    row(4, 0, -15, 8, 7, 1.5, -1);
    row(5, 0, 6, -3, -3, -0.5, 0.5);
  }
  return map;
}

Eigen::MatrixXd monotone_coefficients(const std::vector<double>& nodes, const Eigen::MatrixXd& values) {
  const auto n = static_cast<Eigen::Index>(nodes.size());
  Eigen::MatrixXd slopes(n, values.cols());
  for (Eigen::Index c = 0; c < values.cols(); ++c) {
    const Eigen::VectorXd column = values.col(c);
    const auto curve = data::PiecewiseCubic::monotone(nodes, {column.data(), static_cast<std::size_t>(n)});
    for (Eigen::Index i = 0; i < n; ++i) slopes(i, c) = curve.knot_slopes()[static_cast<std::size_t>(i)];
  }
  const PiecewiseMap map = hermite_map(nodes, 3);
  return map.from_values * values + map.from_slopes * slopes;
}

}  // namespace brachium::fem
