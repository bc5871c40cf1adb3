#pragma once
/// LU with partial pivoting of SuiteSparse (UMFPACK) of a matrix with symmetric pattern.
/// Source: Davis 2004, doi:10.1145/992200.992206.

#include <span>
#include <vector>

#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

class UmfpackLu {
 public:
  explicit UmfpackLu(const SolverOptions& options);
  ~UmfpackLu();
  UmfpackLu(const UmfpackLu&) = delete;
  UmfpackLu& operator=(const UmfpackLu&) = delete;

  /// Order and symbolic factorisation of a full pattern of `n` columns, which is copied.
  void analyse(int n, const FullPattern& pattern);
  FactorStatus factorise(std::vector<double> values);
  void solve(std::span<double> x, int columns) const;

  bool analysed() const { return symbolic_ != nullptr; }
  bool factored() const { return numeric_ != nullptr; }
  const SolverStatistics& statistics() const { return statistics_; }

 private:
  void free_numeric();

  SolverOptions options_;
  int n_ = 0, threads_ = 1;
  std::vector<double> control_;
  std::vector<int> column_start_, row_;
  std::vector<double> values_;  // UMFPACK refines with them
  void *symbolic_ = nullptr, *numeric_ = nullptr;
  SolverStatistics statistics_;
};

}  // namespace brachium::fem
