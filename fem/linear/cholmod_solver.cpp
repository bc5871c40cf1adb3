// Cholesky of SuiteSparse, A = L L': supernodal, with the order computed on the block graph. CHOLMOD stops at
// the first pivot that is not positive; a simplicial L D L' without pivoting then gives factor and inertia.
// Source: Chen, Davis, Hager, Rajamanickam 2008, doi:10.1145/1391989.1391995.

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>

#include <cholmod.h>

#include "data/model/parallel.hpp"
#include "fem/linear/blas_threads.hpp"
#include "fem/linear/block_graph.hpp"
#include "fem/linear/linear_checks.hpp"
#include "fem/linear/solver_parts.hpp"
#include "fem/linear/stopwatch.hpp"

namespace brachium::fem {

namespace {

class CholmodSolver final : public SymmetricSolver {
 public:
  explicit CholmodSolver(const SolverOptions& options) : options_(options) {
    cholmod_start(&common_);
    common_.print = 0;
    common_.nmethods = 1;
    common_.method[0].ordering = CHOLMOD_GIVEN;
    common_.postorder = 1;
    common_.quick_return_if_not_posdef = 1;
    // Blocks of unknowns make small supernodes; larger ones, with more stored zeros, run at the speed of
    // dgemm.
    common_.nrelax[0] = 12;
    common_.nrelax[1] = 60;
    common_.nrelax[2] = 200;
    common_.zrelax[0] = 0.8;
    common_.zrelax[1] = 0.2;
    common_.zrelax[2] = 0.05;
    if (options.deterministic) {
      threads_ = 1;
    } else {
      threads_ = static_cast<int>(data::thread_count(static_cast<std::size_t>(std::max(0, options.threads))));
    }
  }

  ~CholmodSolver() override {
    free_factors();
    cholmod_finish(&common_);
  }
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;

  void analyse(const SymmetricPattern& pattern, const UnknownGroups& groups) override {
    const Stopwatch watch;
    const BlockGraph graph = make_block_graph(pattern, groups);
    const BlockOrder order = fem::order(graph, options_.ordering);
    permutation_.clear();
    for (const int vertex : order.position_to_vertex) {
      permutation_.insert(permutation_.end(), graph.unknown.begin() + graph.first_unknown[vertex],
                          graph.unknown.begin() + graph.first_unknown[vertex + 1]);
    }
    pattern_ = pattern;
    free_factors();
    factored_ = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    cholmod_sparse matrix = view(nullptr);
    cholesky_ = cholmod_analyze_p(&matrix, permutation_.data(), nullptr, 0, &common_);
    check_status(cholesky_ != nullptr);
    statistics_ = {};
    statistics_.ordering = order.name;
    statistics_.method = "cholmod, supernodal L L'";
    statistics_.flops = common_.fl;
    statistics_.factor_entries = static_cast<long long>(common_.lnz);
    statistics_.analyse_s = watch.seconds();
  }

  FactorStatus factorise(std::span<const double> values) override {
    check_order(cholesky_ != nullptr, "analyse");
    check_values(values, pattern_.entries());
    const Stopwatch watch;
    const BlasThreads blas(threads_);
    factored_ = nullptr;
    cholmod_sparse matrix = view(values.data());
    common_.supernodal = CHOLMOD_SUPERNODAL;
    cholmod_factorize(&matrix, cholesky_, &common_);
    check_status(common_.status >= CHOLMOD_OK);
    FactorStatus status;
    if (common_.status != CHOLMOD_NOT_POSDEF) {
      status = judge_cholesky(values);
    } else {
      status = factorise_indefinite(matrix, values);
    }
    statistics_.memory_bytes = static_cast<long long>(common_.memory_usage);
    statistics_.factorise_s = watch.seconds();
    return status;
  }

  void solve(std::span<double> x, int columns) const override {
    check_order(factored_ != nullptr, "a factorisation that is solvable");
    check_columns(x.size(), pattern_.n, columns);
    const BlasThreads blas(threads_);
    cholmod_dense right{};
    right.nrow = right.d = static_cast<std::size_t>(pattern_.n);
    right.ncol = static_cast<std::size_t>(columns);
    right.nzmax = x.size();
    right.x = x.data();
    right.xtype = CHOLMOD_REAL;
    right.dtype = CHOLMOD_DOUBLE;
    cholmod_dense* solution = cholmod_solve(CHOLMOD_A, factored_, &right, &common_);
    check_status(solution != nullptr);
    const double* begin = static_cast<const double*>(solution->x);
    std::copy(begin, begin + x.size(), x.begin());
    cholmod_free_dense(&solution, &common_);
  }

  std::optional<Inertia> inertia() const override { return inertia_; }
  SolverStatistics statistics() const override { return statistics_; }

 private:
  cholmod_sparse view(const double* values) {
    cholmod_sparse matrix{};
    matrix.nrow = matrix.ncol = static_cast<std::size_t>(pattern_.n);
    matrix.nzmax = pattern_.row.size();
    matrix.p = pattern_.column_start.data();
    matrix.i = pattern_.row.data();
    matrix.x = const_cast<double*>(values);  // CHOLMOD's interface knows no const; it only reads
    matrix.stype = -1;
    matrix.itype = CHOLMOD_INT;
    matrix.xtype = values == nullptr ? CHOLMOD_PATTERN : CHOLMOD_REAL;
    matrix.dtype = CHOLMOD_DOUBLE;
    matrix.sorted = matrix.packed = 1;
    return matrix;
  }

  void check_status(bool ok) const {
    if (ok) return;
    if (common_.status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::logic_error("CHOLMOD status " + std::to_string(common_.status));
  }

  void free_factors() {
    cholmod_free_factor(&cholesky_, &common_);
    cholmod_free_factor(&indefinite_, &common_);
  }

  int unknown(std::size_t position) const { return static_cast<const int*>(factored_->Perm)[position]; }

  FactorStatus finish(const char* method, const std::vector<std::pair<int, double>>& zero) {
    FactorStatus status;
    statistics_.method = method;
    inertia_->zero = static_cast<long>(zero.size());
    inertia_->positive = pattern_.n - inertia_->negative - inertia_->zero;
    inertia_->method = method;
    status.kind = inertia_->negative > 0 ? FactorKind::indefinite : FactorKind::positive_definite;
    if (!zero.empty()) {
      status.kind = FactorKind::singular;
      status.first_zero_unknown = zero.front().first;
      status.first_zero_pivot = zero.front().second;
      for (const auto& [i, pivot] : zero) status.zero_unknowns.push_back(i);
      std::sort(status.zero_unknowns.begin(), status.zero_unknowns.end());
      factored_ = nullptr;
    }
    return status;
  }

  // A vanishing pivot may come out positive by rounding: Cholesky then succeeds on a singular matrix.
  FactorStatus judge_cholesky(std::span<const double> values) {
    factored_ = cholesky_;
    inertia_.emplace();
    inertia_->growth = 1.0;
    const auto* super = static_cast<const int*>(cholesky_->super);
    const auto* pi = static_cast<const int*>(cholesky_->pi);
    const auto* px = static_cast<const int*>(cholesky_->px);
    const auto* x = static_cast<const double*>(cholesky_->x);
    std::vector<std::pair<int, double>> zero;
    for (std::size_t s = 0; s < cholesky_->nsuper; ++s) {
      const std::size_t rows = static_cast<std::size_t>(pi[s + 1] - pi[s]);
      for (int j = super[s]; j < super[s + 1]; ++j) {
        const std::size_t k = static_cast<std::size_t>(j - super[s]);
        const double l = x[static_cast<std::size_t>(px[s]) + k * rows + k];
        const int i = unknown(static_cast<std::size_t>(j));
        if (l * l <= options_.zero_pivot * values[pattern_.column_start[i]]) zero.emplace_back(i, l * l);
      }
    }
    return finish("cholmod, supernodal L L'", zero);
  }

  FactorStatus factorise_indefinite(cholmod_sparse& matrix, std::span<const double> values) {
    if (indefinite_ == nullptr) {
      common_.supernodal = CHOLMOD_SIMPLICIAL;
      common_.final_ll = 0;
      indefinite_ = cholmod_analyze_p(&matrix, permutation_.data(), nullptr, 0, &common_);
      check_status(indefinite_ != nullptr);
    }
    common_.supernodal = CHOLMOD_SIMPLICIAL;
    cholmod_factorize(&matrix, indefinite_, &common_);
    check_status(common_.status >= CHOLMOD_OK);
    factored_ = indefinite_;
    inertia_.emplace();
    // g_i = (|L| |D| |L'|)_ii by columns; a column starts with its pivot.
    const auto* p = static_cast<const int*>(indefinite_->p);
    const auto* rows = static_cast<const int*>(indefinite_->i);
    const auto* x = static_cast<const double*>(indefinite_->x);
    const auto* count = static_cast<const int*>(indefinite_->nz);
    std::vector<double> g(static_cast<std::size_t>(pattern_.n), 0.0);
    std::vector<std::pair<int, double>> zero;
    statistics_.largest_multiplier = 0.0;
    for (int j = 0; j < pattern_.n; ++j) {
      const double d = x[p[j]];
      const int i = unknown(static_cast<std::size_t>(j));
      const double a = std::abs(values[pattern_.column_start[i]]);
      g[j] += std::abs(d);
      if (!(std::abs(d) > options_.zero_pivot * std::max(a, g[j]))) {
        zero.emplace_back(i, d);
        break;  // nothing after a vanishing pivot means anything
      }
      if (d < 0.0) ++inertia_->negative;
      inertia_->growth = std::max(inertia_->growth, g[j] / std::max(a, std::abs(d)));
      for (int e = 1; e < count[j]; ++e) {
        const double l = x[p[j] + e];
        g[rows[p[j] + e]] += l * l * std::abs(d);
        statistics_.largest_multiplier = std::max(statistics_.largest_multiplier, std::abs(l));
      }
    }
    return finish("cholmod, simplicial L D L' without pivoting", zero);
  }

  SolverOptions options_;
  int threads_;
  mutable cholmod_common common_;
  SymmetricPattern pattern_;
  std::vector<int> permutation_;
  cholmod_factor* cholesky_ = nullptr;
  cholmod_factor* indefinite_ = nullptr;
  cholmod_factor* factored_ = nullptr;
  std::optional<Inertia> inertia_;
  SolverStatistics statistics_;
};

}  // namespace

std::unique_ptr<SymmetricSolver> make_cholmod_solver(const SolverOptions& options) {
  return std::make_unique<CholmodSolver>(options);
}

}  // namespace brachium::fem
