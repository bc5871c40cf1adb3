#pragma once
/// Where the entries of a sparse symmetric matrix stand. One mesh has one pattern; its values change from
/// iteration to iteration.

#include <span>
#include <string_view>
#include <vector>

namespace brachium::fem {

/// Lower triangle with the whole diagonal, column by column, the rows of a column ascending (so its first is
/// the diagonal).
struct SymmetricPattern {
  int n = 0;  ///< unknowns
  std::vector<int>
      column_start;      ///< n + 1 entries; column j has the entries [column_start[j], column_start[j + 1])
  std::vector<int> row;  ///< row of an entry, j <= row < n

  int entries() const { return column_start.empty() ? 0 : column_start.back(); }
};

/// A pattern with one value per entry.
struct SymmetricMatrixView {
  const SymmetricPattern* pattern;
  const double* values;
};

/// The full matrix by columns, for solvers that know no symmetry: entry p holds lower-triangle entry
/// `source[p]`.
struct FullPattern {
  std::vector<int> column_start, row, source;
};

/// Throws InputError("linear-pattern") that names the first column at fault: sizes, order of rows, missing
/// diagonal.
void check(const SymmetricPattern& pattern);

/// Throws InputError("linear-size") when `count` is not `expected`; `what` names the argument.
void check_size(std::string_view what, std::size_t count, std::size_t expected);

/// The pattern of both triangles. Rows ascend.
FullPattern expand(const SymmetricPattern& pattern);

/// y = A x for the full matrix; x and y have n entries each.
void multiply(const SymmetricMatrixView& matrix, std::span<const double> x, std::span<double> y);

}  // namespace brachium::fem
