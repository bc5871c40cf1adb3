#include "fem/linear/umfpack_lu.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>

#include <umfpack.h>

#include "data/model/parallel.hpp"
#include "fem/linear/blas_threads.hpp"
#include "fem/linear/block_graph.hpp"
#include "fem/linear/linear_checks.hpp"
#include "fem/linear/stopwatch.hpp"

namespace brachium::fem {

namespace {

void check_status(int status) {
  if (status == UMFPACK_OK || status == UMFPACK_WARNING_singular_matrix) return;
  if (status == UMFPACK_ERROR_out_of_memory) throw std::bad_alloc();
  throw std::logic_error("UMFPACK status " + std::to_string(status));
}

}  // namespace

UmfpackLu::UmfpackLu(const SolverOptions& options) : options_(options), control_(UMFPACK_CONTROL) {
  umfpack_di_defaults(control_.data());
  control_[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
  control_[UMFPACK_PRL] = 0;
  control_[UMFPACK_IRSTEP] = 1;
  if (options.ordering != Ordering::amd) control_[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
  if (!options.deterministic) {
    threads_ = static_cast<int>(data::thread_count(static_cast<std::size_t>(std::max(0, options.threads))));
  }
}

UmfpackLu::~UmfpackLu() {
  free_numeric();
  umfpack_di_free_symbolic(&symbolic_);
}

void UmfpackLu::free_numeric() {
  if (numeric_ != nullptr) umfpack_di_free_numeric(&numeric_);
  numeric_ = nullptr;
}

void UmfpackLu::analyse(int n, const FullPattern& pattern) {
  const Stopwatch watch;
  n_ = n;
  column_start_ = pattern.column_start;
  row_ = pattern.row;
  free_numeric();
  if (symbolic_ != nullptr) umfpack_di_free_symbolic(&symbolic_);
  std::vector<double> info(UMFPACK_INFO);
  const std::lock_guard lock(metis_mutex());
  check_status(umfpack_di_symbolic(n_, n_, column_start_.data(), row_.data(), nullptr, &symbolic_,
                                   control_.data(), info.data()));
  statistics_ = {};
  statistics_.method = "umfpack, LU with partial pivoting";
  statistics_.ordering = info[UMFPACK_ORDERING_USED] == UMFPACK_ORDERING_METIS ? "METIS" : "AMD";
  statistics_.analyse_s = watch.seconds();
}

FactorStatus UmfpackLu::factorise(std::vector<double> values) {
  const Stopwatch watch;
  const BlasThreads blas(threads_);
  free_numeric();
  values_ = std::move(values);
  std::vector<double> info(UMFPACK_INFO);
  check_status(umfpack_di_numeric(column_start_.data(), row_.data(), values_.data(), symbolic_, &numeric_,
                                  control_.data(), info.data()));
  statistics_.flops = info[UMFPACK_FLOPS];
  statistics_.factor_entries = static_cast<long long>(info[UMFPACK_LNZ] + info[UMFPACK_UNZ]);
  statistics_.memory_bytes = static_cast<long long>(info[UMFPACK_PEAK_MEMORY] * info[UMFPACK_SIZE_OF_UNIT]);

  // Pivots by unknown: column q[k] of A has the pivot u_kk of the row-scaled matrix.
  std::vector<double> pivot(static_cast<std::size_t>(n_));
  std::vector<int> column(static_cast<std::size_t>(n_));
  int reciprocal = 0;
  check_status(umfpack_di_get_numeric(nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
                                      column.data(), pivot.data(), &reciprocal, nullptr, numeric_));
  // The rows are scaled to sum 1: the largest scaled entry of a column is what its pivot is held against.
  std::vector<double> row_sum(static_cast<std::size_t>(n_), 0.0);
  for (std::size_t e = 0; e < values_.size(); ++e) row_sum[row_[e]] += std::abs(values_[e]);
  FactorStatus status;
  for (int k = 0; k < n_; ++k) {
    const int j = column[k];
    double scale = 0.0;
    for (int e = column_start_[j]; e < column_start_[j + 1]; ++e) {
      if (row_sum[row_[e]] > 0.0) scale = std::max(scale, std::abs(values_[e]) / row_sum[row_[e]]);
    }
    if (std::abs(pivot[k]) > options_.zero_pivot * scale) continue;
    if (status.zero_unknowns.empty()) {
      status.first_zero_unknown = j;
      status.first_zero_pivot = pivot[k];
    }
    status.zero_unknowns.push_back(j);
  }
  if (!status.zero_unknowns.empty()) {
    status.kind = FactorKind::singular;
    std::sort(status.zero_unknowns.begin(), status.zero_unknowns.end());
    free_numeric();
  }
  statistics_.factorise_s = watch.seconds();
  return status;
}

void UmfpackLu::solve(std::span<double> x, int columns) const {
  check_order(numeric_ != nullptr, "a factorisation that is solvable");
  check_columns(x.size(), n_, columns);
  const BlasThreads blas(threads_);
  std::vector<double> right(static_cast<std::size_t>(n_));
  for (int c = 0; c < columns; ++c) {
    double* column = x.data() + static_cast<std::size_t>(c) * right.size();
    std::copy(column, column + n_, right.begin());
    check_status(umfpack_di_solve(UMFPACK_A, column_start_.data(), row_.data(), values_.data(), column,
                                  right.data(), numeric_, control_.data(), nullptr));
  }
}

}  // namespace brachium::fem
