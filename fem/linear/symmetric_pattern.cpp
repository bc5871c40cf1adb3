#include "fem/linear/symmetric_pattern.hpp"

#include <algorithm>
#include <string>

#include "data/model/error.hpp"

namespace brachium::fem {

namespace {

[[noreturn]] void reject(const std::string& message) {
  throw data::InputError("linear-pattern", message,
                         "a pattern is the lower triangle with its diagonal, rows of a column ascending");
}

}  // namespace

void check(const SymmetricPattern& p) {
  if (p.n <= 0) reject("a sparse pattern has `" + std::to_string(p.n) + "` unknowns");
  if (p.column_start.size() != static_cast<std::size_t>(p.n) + 1 || p.column_start.front() != 0 ||
      p.column_start.back() < 0 || static_cast<std::size_t>(p.column_start.back()) != p.row.size()) {
    reject("the column starts of a sparse pattern of " + std::to_string(p.n) +
           " unknowns do not fit its rows");
  }
  for (int j = 0; j < p.n; ++j) {
    const int begin = p.column_start[j], end = p.column_start[j + 1];
    if (end <= begin || end > p.entries() || p.row[begin] != j) {
      reject("column " + std::to_string(j) + " of a sparse pattern does not begin with its diagonal");
    }
    for (int e = begin + 1; e < end; ++e) {
      if (p.row[e] <= p.row[e - 1] || p.row[e] >= p.n) {
        reject("the rows of column " + std::to_string(j) +
               " of a sparse pattern do not ascend within the matrix");
      }
    }
  }
}

void check_size(std::string_view what, std::size_t count, std::size_t expected) {
  if (count == expected) return;
  throw data::InputError("linear-size", std::string(what) + " has " + std::to_string(count) + " entries, " +
                                            std::to_string(expected) + " are needed");
}

FullPattern expand(const SymmetricPattern& p) {
  FullPattern full;
  full.column_start.assign(static_cast<std::size_t>(p.n) + 1, 0);
  for (int j = 0; j < p.n; ++j) {
    for (int e = p.column_start[j]; e < p.column_start[j + 1]; ++e) {
      ++full.column_start[j + 1];
      if (p.row[e] != j) ++full.column_start[p.row[e] + 1];
    }
  }
  for (int j = 0; j < p.n; ++j) full.column_start[j + 1] += full.column_start[j];
  full.row.resize(full.column_start.back());
  full.source.resize(full.column_start.back());
  std::vector<int> next(full.column_start.begin(), full.column_start.end() - 1);
  // Column i gets its entries above the diagonal from columns j < i, which come first: rows ascend.
  for (int j = 0; j < p.n; ++j) {
    for (int e = p.column_start[j]; e < p.column_start[j + 1]; ++e) {
      const int i = p.row[e];
      if (i != j) {
        full.row[next[i]] = j;
        full.source[next[i]++] = e;
      }
    }
  }
  for (int j = 0; j < p.n; ++j) {
    for (int e = p.column_start[j]; e < p.column_start[j + 1]; ++e) {
      full.row[next[j]] = p.row[e];
      full.source[next[j]++] = e;
    }
  }
  return full;
}

void multiply(const SymmetricMatrixView& matrix, std::span<const double> x, std::span<double> y) {
  const SymmetricPattern& p = *matrix.pattern;
  check_size("the vector of a product", x.size(), static_cast<std::size_t>(p.n));
  check_size("the result of a product", y.size(), static_cast<std::size_t>(p.n));
  std::fill(y.begin(), y.end(), 0.0);
  for (int j = 0; j < p.n; ++j) {
    const int begin = p.column_start[j];
    double sum = matrix.values[begin] * x[j];
    for (int e = begin + 1; e < p.column_start[j + 1]; ++e) {
      sum += matrix.values[e] * x[p.row[e]];
      y[p.row[e]] += matrix.values[e] * x[j];
    }
    y[j] += sum;
  }
}

}  // namespace brachium::fem
