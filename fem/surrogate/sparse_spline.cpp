#include "fem/surrogate/sparse_spline.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "data/model/error.hpp"
#include "fem/surrogate/leave_out.hpp"

namespace brachium::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// The distinct functions of one direction and, for each point, which of them is its own.
struct Direction {
  std::vector<HierarchicalIndex> functions;
  std::vector<Index> of_point;
  int finest = 0;
};

Direction direction(const std::vector<SparseIndex>& points, HierarchicalIndex SparseIndex::*member) {
  std::map<HierarchicalIndex, Index> place;
  Direction d;
  for (const SparseIndex& p : points) {
    const auto [at, fresh] = place.try_emplace(p.*member, static_cast<Index>(d.functions.size()));
    if (fresh) d.functions.push_back(p.*member);
    d.of_point.push_back(at->second);
    d.finest = std::max(d.finest, (p.*member).level);
  }
  return d;
}

// Functions (columns) at the positions of all functions (rows).
MatrixXd at_positions(SparseBoundary boundary, const Direction& d) {
  const auto n = static_cast<Index>(d.functions.size());
  MatrixXd values(n, n);
  for (Index r = 0; r < n; ++r) {
    for (Index c = 0; c < n; ++c)
      values(r, c) = hierarchical_basis(boundary, d.functions[static_cast<std::size_t>(c)],
                                        d.functions[static_cast<std::size_t>(r)].position())(0);
  }
  return values;
}

int mesh_level(int finest) {
  return finest < 2 ? 0 : finest;
}

// Taylor coefficients of every function at the start of every cell: (4 cells) x functions.
MatrixXd cell_coefficients(SparseBoundary boundary, const Direction& d) {
  const Index cells = Index{1} << mesh_level(d.finest), n = static_cast<Index>(d.functions.size());
  const double h = 1.0 / static_cast<double>(cells);
  MatrixXd out(4 * cells, n);
  for (Index i = 0; i < cells; ++i) {
    for (Index c = 0; c < n; ++c) {
      const Eigen::Vector4d phi =
          hierarchical_basis(boundary, d.functions[static_cast<std::size_t>(c)], static_cast<double>(i) * h);
      out.block<4, 1>(4 * i, c) << phi(0), h * phi(1), h * h / 2.0 * phi(2), h * h * h / 6.0 * phi(3);
    }
  }
  return out;
}

}  // namespace

SparseSpline interpolate(SparseBoundary boundary, const SparseValues& values) {
  if (values.empty()) throw data::InputError("bad-sample", "a sparse spline needs at least one state");
  SparseSpline spline;
  spline.boundary = boundary;
  const auto n = static_cast<Index>(values.size()), m = values.begin()->second.size();
  MatrixXd F(n, m);
  Index row = 0;
  for (const auto& [point, value] : values) {
    spline.points.push_back(point);
    F.row(row++) = value.transpose();
  }
  const Direction theta = direction(spline.points, &SparseIndex::theta),
                  alpha = direction(spline.points, &SparseIndex::alpha);
  const MatrixXd in_theta = at_positions(boundary, theta), in_alpha = at_positions(boundary, alpha);
  MatrixXd A(n, n);
  for (Index p = 0; p < n; ++p) {
    for (Index q = 0; q < n; ++q) {
      const auto i = static_cast<std::size_t>(p), j = static_cast<std::size_t>(q);
      A(p, q) =
          in_theta(theta.of_point[i], theta.of_point[j]) * in_alpha(alpha.of_point[i], alpha.of_point[j]);
    }
  }
  const Eigen::PartialPivLU<MatrixXd> lu(A);
  if (!(lu.rcond() > 1e-13)) {
    throw data::ConvergenceFailure({"sparse spline",
                                    fmt::format("{} states do not determine as many coefficients", n),
                                    0,
                                    lu.rcond(),
                                    0.0,
                                    {}});
  }
  const MatrixXd inverse = lu.inverse();
  spline.surplus = lu.solve(F);
  spline.left_out = inverse.diagonal().cwiseInverse().asDiagonal() * spline.surplus;
  return spline;
}

Eigen::Matrix<double, Eigen::Dynamic, 3> SparseSpline::evaluate(double x, double y) const {
  Eigen::Matrix<double, Eigen::Dynamic, 3> out =
      Eigen::Matrix<double, Eigen::Dynamic, 3>::Zero(surplus.cols(), 3);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Eigen::Vector4d t = hierarchical_basis(boundary, points[p].theta, x),
                          a = hierarchical_basis(boundary, points[p].alpha, y);
    const Eigen::RowVector3d phi(t(0) * a(0), t(1) * a(0), t(0) * a(1));
    out += surplus.row(static_cast<Index>(p)).transpose() * phi;
  }
  return out;
}

Surrogate make_surrogate(const SparseSpline& spline, const StateBounds& bounds,
                         std::vector<std::string> outputs) {
  bounds.check();
  const Direction theta = direction(spline.points, &SparseIndex::theta),
                  alpha = direction(spline.points, &SparseIndex::alpha);
  if (mesh_level(theta.finest) + mesh_level(alpha.finest) > 17) {
    throw data::InputError(
        "surrogate-too-fine",
        fmt::format("levels {} and {} make more than 2^17 cells", theta.finest, alpha.finest),
        "limit the level of refinement");
  }
  const auto lines = [](double lower, double upper, int finest) {
    return MeshLines(equidistant(lower, upper, (std::size_t{1} << mesh_level(finest)) + 1));
  };
  PatchTable patches(lines(bounds.theta_lower_rad, bounds.theta_upper_rad, theta.finest),
                     lines(bounds.activation_lower, bounds.activation_upper, alpha.finest), 3, 3,
                     outputs.size());
  const MatrixXd in_theta = cell_coefficients(spline.boundary, theta),
                 in_alpha = cell_coefficients(spline.boundary, alpha);
  for (std::size_t o = 0; o < outputs.size(); ++o) {
    MatrixXd c = MatrixXd::Zero(in_theta.cols(), in_alpha.cols());
    for (std::size_t p = 0; p < spline.points.size(); ++p)
      c(theta.of_point[p], alpha.of_point[p]) = spline.surplus(static_cast<Index>(p), static_cast<Index>(o));
    const MatrixXd cells = in_theta * c * in_alpha.transpose();
    for (Index r = 0; r < cells.rows(); ++r) {
      for (Index s = 0; s < cells.cols(); ++s) {
        patches.coefficient(static_cast<std::size_t>(r / 4), static_cast<std::size_t>(s / 4),
                            static_cast<int>(r % 4), static_cast<int>(s % 4), o) = cells(r, s);
      }
    }
  }
  const bool modified = spline.boundary == SparseBoundary::modified;
  Surrogate surrogate(fmt::format("sparse-grid spline, degree 3, {}",
                                  modified ? "boundary by extrapolation" : "with boundary states"),
                      outputs, bounds, spline.points.size(), std::move(patches));
  SparseGrid grid(spline.boundary);
  for (const SparseIndex& p : spline.points) grid.insert(p);
  ErrorTally tally(outputs);
  std::size_t leaves = 0;
  for (std::size_t p = 0; p < spline.points.size(); ++p) {
    if (!grid.is_leaf(spline.points[p])) continue;
    const auto row = static_cast<Index>(p);
    const Eigen::VectorXd known =
        spline.evaluate(spline.points[p].theta.position(), spline.points[p].alpha.position()).col(0);
    tally.add(state_of(spline.points[p], bounds), known, known - spline.left_out.row(row).transpose());
    ++leaves;
  }
  if (leaves > 0 && spline.points.size() > 1) surrogate.set_error(tally.result(modified ? 2 : 4));
  return surrogate;
}

Surrogate sparse_surrogate(const SampleSet& samples, const StateBounds& bounds, SparseBoundary boundary) {
  samples.check();
  bounds.check();
  SparseValues values;
  for (const Sample& s : samples.samples) {
    if (!values.try_emplace(index_of(s.at, bounds, boundary, 12), s.value).second) {
      throw data::InputError("bad-sample",
                             fmt::format("the state at {:.6g} rad with activation {:.6g} is there twice",
                                         s.at.theta_rad, s.at.activation));
    }
  }
  return make_surrogate(interpolate(boundary, values), bounds, samples.outputs);
}

}  // namespace brachium::fem
