// The house's own solver: L D L' of symmetric matrices, definite or not, over fronts, with the inertia of the
// matrix and a measured bound on the growth of rounding errors. A matrix with too much growth goes to
// UMFPACK.

#include <algorithm>
#include <cmath>
#include <optional>

#include "data/model/parallel.hpp"
#include "fem/linear/block_graph.hpp"
#include "fem/linear/linear_checks.hpp"
#include "fem/linear/multifrontal.hpp"
#include "fem/linear/solver_parts.hpp"
#include "fem/linear/stopwatch.hpp"

namespace brachium::fem {

namespace {

class LdlSolver final : public SymmetricSolver {
 public:
  explicit LdlSolver(const SolverOptions& options)
      : options_(options),
        pool_(static_cast<int>(data::thread_count(static_cast<std::size_t>(std::max(0, options.threads))))) {}

  void analyse(const SymmetricPattern& pattern, const UnknownGroups& groups) override {
    const Stopwatch watch;
    factored_ = false;
    fallback_.reset();
    use_fallback_ = false;
    inertia_.reset();
    multifrontal_.reset();
    const BlockGraph graph = make_block_graph(pattern, groups);
    BlockOrder order = fem::order(graph, options_.ordering);
    AssemblyTree tree = make_assembly_tree(graph, std::move(order.position_to_vertex));
    EntryMap map = make_entry_map(pattern, graph, tree);
    multifrontal_.emplace(std::move(tree), std::move(map));
    pattern_ = pattern;
    diagonal_.resize(static_cast<std::size_t>(pattern.n));
    statistics_ = {};
    statistics_.ordering = order.name;
    statistics_.method = kMethod;
    statistics_.factor_entries = multifrontal_->tree().factor_entries;
    statistics_.flops = multifrontal_->tree().flops;
    statistics_.analyse_s = watch.seconds();
  }

  FactorStatus factorise(std::span<const double> values) override {
    check_order(multifrontal_.has_value(), "analyse");
    check_values(values, pattern_.entries());
    const Stopwatch watch;
    factored_ = use_fallback_ = false;
    inertia_.reset();
    const AssemblyTree& tree = multifrontal_->tree();
    for (int k = 0; k < pattern_.n; ++k)
      diagonal_[k] = std::abs(values[pattern_.column_start[tree.unknown_at[k]]]);
    multifrontal_->factorise(values, diagonal_, options_.zero_pivot, pool_, dense_kernels());
    FactorStatus status = judge();
    statistics_.method = kMethod;
    statistics_.memory_bytes = multifrontal_->memory_bytes();
    factored_ = status.solvable();
    if (status.kind == FactorKind::unstable && options_.fall_back) status = fall_back(values);
    statistics_.factorise_s = watch.seconds();
    return status;
  }

  void solve(std::span<double> x, int columns) const override {
    check_order(factored_, "a factorisation that is solvable");
    check_columns(x.size(), pattern_.n, columns);
    if (use_fallback_) {
      fallback_->solve(x, columns);
      return;
    }
    const std::vector<int>& unknown = multifrontal_->tree().unknown_at;
    std::vector<double> y(unknown.size());
    for (int c = 0; c < columns; ++c) {
      double* column = x.data() + static_cast<std::size_t>(c) * y.size();
      for (std::size_t k = 0; k < y.size(); ++k) y[k] = column[unknown[k]];
      multifrontal_->solve(y.data(), pool_);
      for (std::size_t k = 0; k < y.size(); ++k) column[unknown[k]] = y[k];
    }
  }

  std::optional<Inertia> inertia() const override { return inertia_; }
  SolverStatistics statistics() const override { return statistics_; }

 private:
  static constexpr const char* kMethod = "ldl, multifrontal L D L'";

  // Signs and growth from D; which pivots vanished.
  FactorStatus judge() {
    const LdlFactor& factor = multifrontal_->factor();
    const AssemblyTree& tree = multifrontal_->tree();
    FactorStatus status;
    Inertia inertia;
    inertia.method = kMethod;
    const auto see_growth = [&](int position, double pivot) {
      const double scale = std::max(diagonal_[position], pivot);
      if (scale > 0.0) inertia.growth = std::max(inertia.growth, factor.growth[position] / scale);
    };
    for (const Front& front : tree.fronts) {
      for (int k = 0; k < front.pivots; ++k) {
        const int place = front.first + k, block = front.first + k / kBlock * kBlock;
        const int position = block + factor.interchange[place];
        const double d = factor.d[place], e = factor.e[place];
        if (e != 0.0) {
          // The determinant of a 2 x 2 pivot is negative: one eigenvalue of each sign.
          const double size = std::max({std::abs(d), std::abs(e), std::abs(factor.d[place + 1])});
          ++inertia.negative;
          ++inertia.positive;
          see_growth(position, size);
          see_growth(block + factor.interchange[place + 1], size);
          ++k;
          continue;
        }
        d<0.0 ? ++inertia.negative : d> 0.0 ? ++inertia.positive : ++inertia.zero;
        see_growth(position, std::abs(d));
        if (d == 0.0) status.zero_unknowns.push_back(tree.unknown_at[position]);
      }
    }
    statistics_.largest_multiplier = factor.largest_multiplier;
    statistics_.pivoted_blocks = std::count(factor.block_pivoted.begin(), factor.block_pivoted.end(), 1);
    if (factor.lost_column || !(inertia.growth <= options_.growth_limit)) {
      status.kind = FactorKind::unstable;
    } else if (inertia.zero > 0) {
      status.kind = FactorKind::singular;
    } else {
      status.kind = inertia.negative > 0 ? FactorKind::indefinite : FactorKind::positive_definite;
    }
    if (!status.zero_unknowns.empty()) status.first_zero_unknown = status.zero_unknowns.front();
    std::sort(status.zero_unknowns.begin(), status.zero_unknowns.end());
    if (status.kind != FactorKind::unstable) inertia_ = inertia;
    return status;
  }

  FactorStatus fall_back(std::span<const double> values) {
    if (!fallback_) {
      fallback_ = make_umfpack_solver(options_);
      fallback_->analyse(pattern_);
    }
    FactorStatus status = fallback_->factorise(values);
    use_fallback_ = true;
    factored_ = status.solvable();
    statistics_.method = fallback_->statistics().method + " (ldl was unstable)";
    statistics_.memory_bytes += fallback_->statistics().memory_bytes;
    return status;
  }

  SolverOptions options_;
  mutable TaskPool pool_;
  SymmetricPattern pattern_;
  std::optional<Multifrontal> multifrontal_;
  std::vector<double> diagonal_;  // |a_ii| by position
  std::unique_ptr<SymmetricSolver> fallback_;
  bool factored_ = false, use_fallback_ = false;
  std::optional<Inertia> inertia_;
  SolverStatistics statistics_;
};

}  // namespace

std::unique_ptr<SymmetricSolver> make_ldl_solver(const SolverOptions& options) {
  return std::make_unique<LdlSolver>(options);
}

}  // namespace brachium::fem
