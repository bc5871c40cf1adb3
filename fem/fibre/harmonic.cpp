#include "fem/fibre/harmonic.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {
namespace {

constexpr double vanished = 1e-6;  // of 1/size

// Which points carry what: -2 no cell has it, -1 free, 0 origin, 1 insertion.
std::vector<int> held_points(const data::Mesh& mesh, const HarmonicFibres& rule,
                             const std::vector<int>& cells) {
  std::vector<int> held(static_cast<std::size_t>(mesh.point_count()), -2);
  for (int c : cells) {
    for (int n = 0; n < mesh.cells.rows(); ++n) held[static_cast<std::size_t>(mesh.cells(n, c))] = -1;
  }
  const std::string* names[2] = {&rule.origin, &rule.insertion};
  for (int end = 0; end < 2; ++end) {
    for (int p : mesh.surface_points(*names[end])) {
      int& h = held[static_cast<std::size_t>(p)];
      if (h == -2) continue;
      if (h == 1 - end) {
        throw data::InputError(
            "bad-harmonic-fibres",
            fmt::format("surfaces `{}` and `{}` share point {}", rule.origin, rule.insertion, p),
            "harmonic fibres need an origin and an insertion that do not touch");
      }
      h = end;
    }
  }
  return held;
}

// Every connected part of the body must touch both ends, else phi is constant there, or anything.
void check_parts(const data::Mesh& mesh, const HarmonicFibres& rule, const std::vector<int>& cells,
                 const std::vector<int>& held) {
  std::vector<int> parent(held.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int p) {
    while (parent[static_cast<std::size_t>(p)] != p) {
      int& up = parent[static_cast<std::size_t>(p)];
      up = parent[static_cast<std::size_t>(up)];
      p = up;
    }
    return p;
  };
  for (int c : cells) {
    for (int n = 1; n < mesh.cells.rows(); ++n) {
      parent[static_cast<std::size_t>(root(mesh.cells(n, c)))] = root(mesh.cells(0, c));
    }
  }
  std::vector<char> touches[2] = {std::vector<char>(held.size(), 0), std::vector<char>(held.size(), 0)};
  for (std::size_t p = 0; p < held.size(); ++p) {
    if (held[p] >= 0) touches[held[p]][static_cast<std::size_t>(root(static_cast<int>(p)))] = 1;
  }
  for (int c : cells) {
    const std::size_t part = static_cast<std::size_t>(root(mesh.cells(0, c)));
    for (int end = 0; end < 2; ++end) {
      if (touches[end][part]) continue;
      throw data::InputError(
          "bad-harmonic-fibres",
          fmt::format("the part of the body with cell {} does not touch `{}`", c,
                      end == 0 ? rule.origin : rule.insertion),
          "each connected part of the regions needs faces of both surfaces; or name fewer regions");
    }
  }
}

// dN/dX at a quadrature point, nodes x 3.
Eigen::MatrixXd gradients(const CellPoints& points, int cell, const Eigen::Matrix3d& jacobian, int q) {
  if (!(jacobian.determinant() > 0.0)) {
    throw data::InputError("inverted-cell", fmt::format("cell {} is inverted or degenerate", cell),
                           "mend the mesh before fibres are computed on it");
  }
  return points.shape(q).derivative * jacobian.inverse();
}

// Pattern and values of the stiffness over free points.
struct System {
  SymmetricPattern pattern;
  std::vector<double> values;
  Eigen::VectorXd right;
};

System assemble(const CellPoints& points, const std::vector<int>& cells, const std::vector<int>& held,
                const std::vector<int>& unknown, int count) {
  const data::Mesh& mesh = points.mesh();
  const int n = static_cast<int>(mesh.cells.rows());
  System s;
  s.pattern.n = count;
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(count));
  const auto unknown_of = [&](int a, int c) { return unknown[static_cast<std::size_t>(mesh.cells(a, c))]; };
  for (int c : cells) {
    for (int b = 0; b < n; ++b) {
      const int j = unknown_of(b, c);
      if (j < 0) continue;
      for (int a = 0; a < n; ++a) {
        if (const int i = unknown_of(a, c); i >= j) rows[static_cast<std::size_t>(j)].push_back(i);
      }
    }
  }
  s.pattern.column_start.push_back(0);
  for (std::vector<int>& r : rows) {
    std::sort(r.begin(), r.end());
    r.erase(std::unique(r.begin(), r.end()), r.end());
    s.pattern.row.insert(s.pattern.row.end(), r.begin(), r.end());
    s.pattern.column_start.push_back(static_cast<int>(s.pattern.row.size()));
    r = {};
  }
  s.values.assign(s.pattern.row.size(), 0.0);
  s.right = Eigen::VectorXd::Zero(count);

  for (int c : cells) {
    const Eigen::Matrix3Xd X = points.nodes(c);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n, n);
    for (int q = 0; q < points.per_cell(); ++q) {
      const Eigen::Matrix3d J = points.jacobian(X, q);
      const Eigen::MatrixXd g = gradients(points, c, J, q);
      K.noalias() += points.volume(J, q) * g * g.transpose();
    }
    for (int b = 0; b < n; ++b) {
      const int j = unknown_of(b, c);
      if (j < 0) continue;
      for (int a = 0; a < n; ++a) {
        const int i = unknown_of(a, c);
        if (i < 0 && held[static_cast<std::size_t>(mesh.cells(a, c))] == 1) s.right[j] -= K(a, b);
        if (i < j) continue;
        const auto first = s.pattern.row.begin() + s.pattern.column_start[static_cast<std::size_t>(j)];
        const auto last = s.pattern.row.begin() + s.pattern.column_start[static_cast<std::size_t>(j) + 1];
        s.values[static_cast<std::size_t>(std::lower_bound(first, last, i) - s.pattern.row.begin())] +=
            K(a, b);
      }
    }
  }
  return s;
}

Eigen::VectorXd solve(const CellPoints& points, const HarmonicFibres& rule, const std::vector<int>& cells,
                      int& unknowns) {
  const data::Mesh& mesh = points.mesh();
  const std::vector<int> held = held_points(mesh, rule, cells);
  check_parts(mesh, rule, cells, held);
  std::vector<int> unknown(held.size(), -1);
  unknowns = 0;
  for (std::size_t p = 0; p < held.size(); ++p) {
    if (held[p] == -1) unknown[p] = unknowns++;
  }
  std::vector<double> x;
  if (unknowns > 0) {
    const System s = assemble(points, cells, held, unknown, unknowns);
    const std::unique_ptr<SymmetricSolver> solver = make_symmetric_solver("ldl");
    solver->analyse(s.pattern);
    if (const FactorStatus status = solver->factorise(s.values); !status.solvable()) {
      throw data::ConvergenceFailure(
          {"harmonic fibres from `" + rule.origin + "` to `" + rule.insertion + "`",
           "the Laplace matrix is singular", 0, 0.0, 0.0,
           fmt::format("unknown {}", status.first_zero_unknown)});
    }
    x.assign(s.right.data(), s.right.data() + s.right.size());
    solver->solve(x);
  }
  Eigen::VectorXd phi =
      Eigen::VectorXd::Constant(mesh.point_count(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t p = 0; p < held.size(); ++p) {
    if (held[p] >= 0) phi[static_cast<Eigen::Index>(p)] = held[p];
    if (unknown[p] >= 0) phi[static_cast<Eigen::Index>(p)] = x[static_cast<std::size_t>(unknown[p])];
  }
  return phi;
}

}  // namespace

Eigen::VectorXd harmonic_function(const CellPoints& points, const HarmonicFibres& rule,
                                  const std::vector<int>& cells) {
  int unknowns = 0;
  return solve(points, rule, cells, unknowns);
}

HarmonicSummary harmonic_fibres(const CellPoints& points, const HarmonicFibres& rule,
                                const std::vector<int>& cells, Eigen::Matrix3Xd& fibre) {
  const data::Mesh& mesh = points.mesh();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (rule.pennation) {
    const double norm = rule.pennation->axis.norm();
    if (!(norm > 0.0 && std::isfinite(norm)) || !std::isfinite(rule.pennation->angle_rad)) {
      throw data::InputError("bad-fibre",
                             "the axis of pennation has no direction, or its angle is not a number",
                             "give an axis of any length but zero and a finite angle");
    }
    turn = Eigen::AngleAxisd(rule.pennation->angle_rad, rule.pennation->axis / norm).toRotationMatrix();
  }
  HarmonicSummary summary;
  const Eigen::VectorXd phi = solve(points, rule, cells, summary.unknowns);

  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (int c : cells) {
    const Eigen::Matrix3Xd X = points.nodes(c);
    low = low.cwiseMin(X.rowwise().minCoeff());
    high = high.cwiseMax(X.rowwise().maxCoeff());
  }
  const double smallest_allowed = vanished / (high - low).norm();

  summary.smallest_gradient_per_m = std::numeric_limits<double>::infinity();
  Eigen::VectorXd value(mesh.cells.rows());
  for (int c : cells) {
    const Eigen::Matrix3Xd X = points.nodes(c);
    for (int a = 0; a < value.size(); ++a) value[a] = phi[mesh.cells(a, c)];
    for (int q = 0; q < points.per_cell(); ++q) {
      const Eigen::Vector3d g = gradients(points, c, points.jacobian(X, q), q).transpose() * value;
      const double norm = g.norm();
      if (!(norm > smallest_allowed)) {
        const Eigen::Vector3d x = X * points.shape(q).value;
        throw data::InputError(
            "bad-fibre",
            fmt::format(
                "the harmonic function from `{}` to `{}` is flat in cell {}, near ({:.4g}, {:.4g}, {:.4g}) m",
                rule.origin, rule.insertion, c, x[0], x[1], x[2]),
            "give fibres there by another rule, or widen origin and insertion");
      }
      if (norm < summary.smallest_gradient_per_m) {
        summary.smallest_gradient_per_m = norm;
        summary.smallest_gradient_cell = c;
      }
      summary.largest_gradient_per_m = std::max(summary.largest_gradient_per_m, norm);
      fibre.col(q + points.per_cell() * c) = (turn * g / norm).normalized();
    }
  }
  return summary;
}

}  // namespace brachium::fem
