#include "fem/solve/tangent_factor.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "fem/linear/stopwatch.hpp"

namespace brachium::fem {
namespace {

// Work per second of one core, for the ratio of costs only: element loops, factorisation, back-substitution
// (bound by memory). Constants, so that no choice depends on a clock.
constexpr double assembly_rate = 8e9, factor_rate = 30e9, solve_rate = 2e9;

/// Entry (i, j) of the face's load tangent, in the frames of its nodes.
Eigen::MatrixXd in_frames(const FaceTangent& face, const Unknowns& unknowns) {
  if (!unknowns.has_frames()) return face.values;
  Eigen::MatrixXd turned = face.values;
  for (std::size_t a = 0; a < face.nodes.size(); ++a) {
    const Eigen::Matrix3d Q = unknowns.frames.middleCols<3>(3 * face.nodes[a]);
    const auto at = static_cast<Eigen::Index>(3 * a);
    turned.middleRows<3>(at) = (Q.transpose() * turned.middleRows<3>(at)).eval();
    turned.middleCols<3>(at) = (turned.middleCols<3>(at) * Q).eval();
  }
  return turned;
}

/// Calls f(row unknown, column unknown, value) for the free entries of ∂f_ext/∂u.
template <class F>
void for_entries(const std::vector<FaceTangent>& loads, const Unknowns& unknowns, F&& f) {
  for (const FaceTangent& face : loads) {
    const Eigen::MatrixXd K = in_frames(face, unknowns);
    for (Eigen::Index j = 0; j < K.cols(); ++j) {
      const int column = unknowns.unknown_of_dof[static_cast<std::size_t>(
          3 * face.nodes[static_cast<std::size_t>(j / 3)] + j % 3)];
      if (column < 0) continue;
      for (Eigen::Index i = 0; i < K.rows(); ++i) {
        const int row = unknowns.unknown_of_dof[static_cast<std::size_t>(
            3 * face.nodes[static_cast<std::size_t>(i / 3)] + i % 3)];
        if (row >= 0) f(row, column, K(i, j));
      }
    }
  }
}

std::size_t entry_of(const std::vector<int>& start, const std::vector<int>& rows, int row, int column) {
  const auto first = rows.begin() + start[static_cast<std::size_t>(column)];
  const auto last = rows.begin() + start[static_cast<std::size_t>(column) + 1];
  return static_cast<std::size_t>(std::lower_bound(first, last, row) - rows.begin());
}

Ordering ordering_named(const std::string& name) {
  if (name == "metis") return Ordering::metis;
  if (name == "amd") return Ordering::amd;
  if (name == "automatic") return Ordering::automatic;
  const std::vector<std::string> known{"amd", "automatic", "metis"};
  throw data::InputError("bad-option", fmt::format("there is no ordering named `{}`", name),
                         data::suggest(name, known));
}

}  // namespace

std::vector<double> symmetric_part(const Equations& equations, const TangentValues& tangent) {
  const SymmetricPattern& pattern = equations.unknowns().pattern;
  std::vector<double> values = tangent.lower;
  for_entries(tangent.loads, equations.unknowns(), [&](int row, int column, double value) {
    // Both entries (i, j) and (j, i) come by: half of each.
    const std::size_t at =
        entry_of(pattern.column_start, pattern.row, std::max(row, column), std::min(row, column));
    values[at] -= row == column ? value : 0.5 * value;
  });
  return values;
}

TangentFactor::TangentFactor(const SolveOptions& options) : name_(options.linear_solver) {
  options_.threads = static_cast<int>(options.threads);
  options_.deterministic = options.deterministic;
  options_.ordering = ordering_named(options.ordering);
}

void TangentFactor::analyse(const Equations& equations) {
  const Unknowns& unknowns = equations.unknowns();
  const Discretisation& d = equations.discretisation();
  ready_ = false;
  const Stopwatch watch;
  ++analyses;
  constraint_unknowns_ =
      std::count(unknowns.groups.constraint.begin(), unknowns.groups.constraint.end(), char{1});
  symmetric_.reset();
  unsymmetric_.reset();
  if (equations.unsymmetric()) {
    unsymmetric_ = std::make_unique<UnsymmetricSolver>(options_);
    unsymmetric_->analyse(unknowns.pattern);
  } else {
    symmetric_ = make_symmetric_solver(name_, options_);
    symmetric_->analyse(unknowns.pattern, unknowns.groups);
  }
  const double nodes = 3.0 * d.nodes_per_cell(),
               points = static_cast<double>(d.quadrature().size()) * d.cell_count();
  tangent_flops_ = 8.0 * nodes * nodes * points;
  residual_flops_ = 60.0 * nodes * points;
  analyse_seconds += watch.seconds();
}

std::string TangentFactor::make(Equations& equations, const Configuration& at, const LoadPoint& load) {
  ready_ = false;
  at_ = at;
  amplitude_ = load.amplitude;
  Evaluation e = equations.linearise(at_, load, tangent_);
  if (!e.valid()) return "the tangent is not finite";
  if (std::string trouble = factorise(equations); !trouble.empty()) return trouble;
  if (equations.condensed()) {
    internal_ = std::move(e.internal);
    volumetric_ = equations.volumetric_pressure(at_);
    if (at_.multiplier.size() == 0) at_.multiplier.setZero(volumetric_.rows(), volumetric_.cols());
  }
  return {};
}

std::string TangentFactor::factorise(const Equations& equations) {
  const Stopwatch watch;
  const Unknowns& unknowns = equations.unknowns();
  ++factorisations;
  FactorStatus status;
  SolverStatistics statistics;
  if (unsymmetric_) {
    const FullPattern& full = unsymmetric_->pattern();
    std::vector<double> values(full.row.size());
    for (std::size_t p = 0; p < values.size(); ++p)
      values[p] = tangent_.lower[static_cast<std::size_t>(full.source[p])];
    for_entries(tangent_.loads, unknowns, [&](int row, int column, double value) {
      values[entry_of(full.column_start, full.row, row, column)] -= value;
    });
    status = unsymmetric_->factorise(values);
    statistics = unsymmetric_->statistics();
  } else {
    status = symmetric_->factorise(symmetric_part(equations, tangent_));
    statistics = symmetric_->statistics();
  }
  ready_ = status.solvable();
  nonzeros = static_cast<double>(statistics.factor_entries);
  flops = statistics.flops;
  method = statistics.method;
  ordering = statistics.ordering;
  cost_ratio_ =
      (tangent_flops_ / assembly_rate + flops / factor_rate) /
      ((equations.condensed() ? 2.5 : 1.0) * residual_flops_ / assembly_rate + 4.0 * nonzeros / solve_rate);
  factor_seconds += watch.seconds();
  return judge(equations, status);
}

std::string TangentFactor::judge(const Equations& equations, const FactorStatus& status) {
  if (status.solvable()) return {};
  const int n = equations.discretisation().node_count();
  if (status.first_zero_unknown < 0) return "the tangent could not be factorised";
  const int dof = equations.unknowns().dof_of_unknown[static_cast<std::size_t>(status.first_zero_unknown)];
  if (dof >= 3 * n) {
    return fmt::format("the tangent is singular: {} pivots vanish, first the pressure of vertex {}",
                       status.zero_unknowns.size(),
                       equations.discretisation().pressure_vertices()[static_cast<std::size_t>(dof - 3 * n)]);
  }
  return fmt::format("the tangent is singular: {} pivots vanish, first at node {} component {}",
                     status.zero_unknowns.size(), dof / 3, "xyz"[dof % 3]);
}

Eigen::VectorXd TangentFactor::coupling(Equations& equations, const Eigen::MatrixXd& pressure) const {
  Configuration with = at_;
  with.multiplier += pressure;
  return equations.unknowns().restrict(equations.internal_force(with) - internal_);
}

Eigen::MatrixXd TangentFactor::pressure_change(Equations& equations, const Eigen::VectorXd& step) const {
  const Eigen::VectorXd direction = equations.unknowns().extend(step);
  const double size = equations.displacements(direction).cwiseAbs().maxCoeff() / equations.cell_size_m();
  if (size == 0.0) return Eigen::MatrixXd::Zero(volumetric_.rows(), volumetric_.cols());
  // A difference along a step of 1e-8 of a cell: rounding 1e-16 over it against the curvature it leaves out.
  const double part = 1e-8 / size;
  Configuration on = at_;
  on.dofs += part * direction;
  return (equations.volumetric_pressure(on) - volumetric_) / part;
}

void TangentFactor::solve(Eigen::VectorXd& x) const {
  const Stopwatch watch;
  const std::span<double> entries(x.data(), static_cast<std::size_t>(x.size()));
  if (unsymmetric_) {
    unsymmetric_->solve(entries);
  } else {
    symmetric_->solve(entries);
  }
  ++back_substitutions;
  solve_seconds += watch.seconds();
}

std::optional<TangentFactor::NegativeModes> TangentFactor::negative_modes() const {
  if (!ready_) return std::nullopt;
  if (unsymmetric_) return std::nullopt;
  const std::optional<Inertia> inertia = symmetric_->inertia();
  if (!inertia) return std::nullopt;
  std::string how = inertia->method;
  if (std::isfinite(inertia->growth)) how += fmt::format(", growth {:.3g}", inertia->growth);
  return NegativeModes{inertia->negative - constraint_unknowns_, how};
}

}  // namespace brachium::fem
