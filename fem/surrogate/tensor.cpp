#include "fem/surrogate/tensor.hpp"

#include <fmt/format.h>

#include "data/model/error.hpp"
#include "fem/surrogate/leave_out.hpp"
#include "fem/surrogate/piecewise.hpp"

namespace brachium::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Output o at all states: angles in rows, activations in columns.
MatrixXd table(const SampleGrid& grid, Index o, Eigen::VectorXd Sample::*member) {
  const auto n = static_cast<Index>(grid.theta_rad.size()), m = static_cast<Index>(grid.activation.size());
  MatrixXd values(n, m);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j)
      values(i, j) = (grid.samples.samples[static_cast<std::size_t>(i * m + j)].*member)(o);
  }
  return values;
}

// Coefficients (cells_θ (p + 1)) x (cells_α (q + 1)) of one output into the table.
void store(const MatrixXd& c, std::size_t output, PatchTable& patches) {
  const Index p = patches.theta_degree() + 1, q = patches.alpha_degree() + 1;
  for (Index r = 0; r < c.rows(); ++r) {
    for (Index s = 0; s < c.cols(); ++s) {
      patches.coefficient(static_cast<std::size_t>(r / p), static_cast<std::size_t>(s / q),
                          static_cast<int>(r % p), static_cast<int>(s % q), output) = c(r, s);
    }
  }
}

PatchTable empty_patches(const SampleGrid& grid, int theta_degree, int alpha_degree) {
  return PatchTable(MeshLines(grid.theta_rad), MeshLines(grid.activation), theta_degree, alpha_degree,
                    grid.samples.outputs.size());
}

int degree_of(ThetaCurve curve) {
  return curve == ThetaCurve::linear ? 1 : curve == ThetaCurve::quintic ? 5 : 3;
}
int degree_of(AlphaCurve curve) {
  return curve == AlphaCurve::linear ? 1 : curve == AlphaCurve::quintic ? 5 : 3;
}

void check_derivatives(const SampleGrid& grid) {
  for (const Sample& s : grid.samples.samples) {
    if (s.dtheta.size() != s.value.size() || s.dalpha.size() != s.value.size()) {
      throw data::InputError(
          "missing-derivative",
          fmt::format(
              "Hermite interpolation needs both derivatives at every state; ({:.6g} rad, {:.6g}) lacks one",
              s.at.theta_rad, s.at.activation),
          "use a spline through the values instead");
    }
  }
}

}  // namespace

Surrogate tensor_spline(const SampleGrid& grid, const TensorOptions& options) {
  grid.samples.check();
  const PiecewiseMap alpha = spline_map(grid.activation, degree_of(options.alpha));
  const bool monotone = options.theta == ThetaCurve::monotone;
  const PiecewiseMap theta =
      monotone ? hermite_map(grid.theta_rad, 3) : spline_map(grid.theta_rad, degree_of(options.theta));
  PatchTable patches = empty_patches(grid, theta.degree, alpha.degree);
  for (std::size_t o = 0; o < grid.samples.outputs.size(); ++o) {
    const MatrixXd F = table(grid, static_cast<Index>(o), &Sample::value);
    const MatrixXd along_theta =
        monotone ? monotone_coefficients(grid.theta_rad, F) : MatrixXd(theta.from_values * F);
    store(along_theta * alpha.from_values.transpose(), o, patches);
  }
  Surrogate surrogate(fmt::format("tensor spline, degree {} x {}{}", theta.degree, alpha.degree,
                                  monotone ? ", monotone in the angle" : ""),
                      grid.samples.outputs, grid.bounds(), grid.samples.size(), std::move(patches));
  if (options.estimate_error) {
    TensorOptions rest = options;
    rest.estimate_error = false;
    const int order = std::min(theta.degree, alpha.degree) + 1;
    if (auto error = leave_out_lines(
            grid, [&](const SampleGrid& g) { return tensor_spline(g, rest); },
            monotone ? std::min(order, 3) : order))
      surrogate.set_error(*error);
  }
  return surrogate;
}

Surrogate hermite_surrogate(const SampleGrid& grid, const HermiteOptions& options) {
  grid.samples.check();
  check_derivatives(grid);
  const PiecewiseMap theta = hermite_map(grid.theta_rad, static_cast<int>(options.degree)),
                     alpha = hermite_map(grid.activation, static_cast<int>(options.degree));
  const MatrixXd slope_theta = slope_map(grid.theta_rad, 5), slope_alpha = slope_map(grid.activation, 5);
  PatchTable patches = empty_patches(grid, theta.degree, alpha.degree);
  for (std::size_t o = 0; o < grid.samples.outputs.size(); ++o) {
    const auto output = static_cast<Index>(o);
    const MatrixXd F = table(grid, output, &Sample::value), Ft = table(grid, output, &Sample::dtheta),
                   Fa = table(grid, output, &Sample::dalpha);
    const MatrixXd Fta = 0.5 * (Ft * slope_alpha.transpose() + slope_theta * Fa);
    const MatrixXd value = theta.from_values * F + theta.from_slopes * Ft,
                   slope = theta.from_values * Fa + theta.from_slopes * Fta;
    store(value * alpha.from_values.transpose() + slope * alpha.from_slopes.transpose(), o, patches);
  }
  Surrogate surrogate(fmt::format("Hermite, degree {} x {}", theta.degree, alpha.degree),
                      grid.samples.outputs, grid.bounds(), grid.samples.size(), std::move(patches));
  if (options.estimate_error) {
    HermiteOptions rest = options;
    rest.estimate_error = false;
    if (auto error = leave_out_lines(
            grid, [&](const SampleGrid& g) { return hermite_surrogate(g, rest); },
            std::min(theta.degree, alpha.degree) + 1))
      surrogate.set_error(*error);
  }
  return surrogate;
}

SampleSet with_spline_slopes(const SampleSet& values, const SampleSet& known) {
  SampleSet plain = values;
  for (Sample& s : plain.samples) s.dtheta.resize(0), s.dalpha.resize(0);
  const SampleGrid grid = as_grid(plain), exact = as_grid(known);
  check_derivatives(exact);
  TensorOptions options;
  options.estimate_error = false;
  if (grid.theta_rad.size() > 5) options.theta = ThetaCurve::quintic;
  if (grid.activation.size() > 5) options.alpha = AlphaCurve::quintic;
  const Surrogate spline = tensor_spline(grid, options);
  const auto n = static_cast<Index>(values.outputs.size());
  std::vector<std::pair<Index, Index>> same;  // places of outputs whose derivatives are known
  for (std::size_t o = 0; o < known.outputs.size(); ++o)
    same.emplace_back(static_cast<Index>(spline.output(known.outputs[o])), static_cast<Index>(o));
  SampleSet out{values.outputs, {}};
  std::vector<OutputValue> at(values.outputs.size());
  for (std::size_t k = 0; k < grid.samples.samples.size(); ++k) {
    Sample s = grid.samples.samples[k];
    spline.evaluate(s.at.theta_rad, s.at.activation, at);
    s.dtheta.resize(n);
    s.dalpha.resize(n);
    for (Index o = 0; o < n; ++o) {
      s.dtheta(o) = at[static_cast<std::size_t>(o)].dtheta;
      s.dalpha(o) = at[static_cast<std::size_t>(o)].dalpha;
    }
    for (const auto& [to, from] : same) {
      s.dtheta(to) = exact.samples.samples.at(k).dtheta(from);
      s.dalpha(to) = exact.samples.samples.at(k).dalpha(from);
    }
    out.samples.push_back(std::move(s));
  }
  return out;
}

}  // namespace brachium::fem
