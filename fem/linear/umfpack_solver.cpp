#include "fem/linear/linear_checks.hpp"
#include "fem/linear/solver_parts.hpp"
#include "fem/linear/umfpack_lu.hpp"
#include "fem/linear/unsymmetric_solver.hpp"

namespace brachium::fem {

namespace {

class UmfpackSolver final : public SymmetricSolver {
 public:
  explicit UmfpackSolver(const SolverOptions& options) : lu_(options) {}

  void analyse(const SymmetricPattern& pattern, const UnknownGroups& groups) override {
    check(pattern);
    check_groups(groups, pattern.n);
    n_ = pattern.n;
    entries_ = pattern.entries();
    FullPattern full = expand(pattern);
    lu_.analyse(n_, full);
    source_ = std::move(full.source);
  }

  FactorStatus factorise(std::span<const double> values) override {
    check_order(lu_.analysed(), "analyse");
    check_values(values, entries_);
    std::vector<double> full(source_.size());
    for (std::size_t e = 0; e < full.size(); ++e) full[e] = values[source_[e]];
    return lu_.factorise(std::move(full));
  }

  void solve(std::span<double> x, int columns) const override { lu_.solve(x, columns); }
  std::optional<Inertia> inertia() const override { return std::nullopt; }
  SolverStatistics statistics() const override { return lu_.statistics(); }

 private:
  UmfpackLu lu_;
  int n_ = 0, entries_ = 0;
  std::vector<int> source_;
};

}  // namespace

std::unique_ptr<SymmetricSolver> make_umfpack_solver(const SolverOptions& options) {
  return std::make_unique<UmfpackSolver>(options);
}

struct UnsymmetricSolver::State {
  explicit State(const SolverOptions& options) : lu(options) {}
  FullPattern pattern;
  UmfpackLu lu;
};

UnsymmetricSolver::UnsymmetricSolver(const SolverOptions& options)
    : state_(std::make_unique<State>(options)) {}
UnsymmetricSolver::~UnsymmetricSolver() = default;
UnsymmetricSolver::UnsymmetricSolver(UnsymmetricSolver&&) noexcept = default;
UnsymmetricSolver& UnsymmetricSolver::operator=(UnsymmetricSolver&&) noexcept = default;

void UnsymmetricSolver::analyse(const SymmetricPattern& pattern) {
  check(pattern);
  state_->pattern = expand(pattern);
  state_->lu.analyse(pattern.n, state_->pattern);
}

const FullPattern& UnsymmetricSolver::pattern() const {
  return state_->pattern;
}

FactorStatus UnsymmetricSolver::factorise(std::span<const double> values) {
  check_order(state_->lu.analysed(), "analyse");
  check_values(values, state_->pattern.column_start.back());
  return state_->lu.factorise({values.begin(), values.end()});
}

void UnsymmetricSolver::solve(std::span<double> x, int columns) const {
  state_->lu.solve(x, columns);
}

SolverStatistics UnsymmetricSolver::statistics() const {
  return state_->lu.statistics();
}

}  // namespace brachium::fem
