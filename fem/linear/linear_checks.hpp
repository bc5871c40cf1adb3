#pragma once
/// What every solver of this folder asks of its input before it computes.

#include <cmath>
#include <span>
#include <string>

#include "data/model/error.hpp"
#include "fem/linear/symmetric_pattern.hpp"
#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

inline void check_order(bool ready, const char* wanted) {
  if (ready) return;
  throw data::InputError("linear-order", std::string("a sparse solver was called before ") + wanted,
                         "call analyse, then factorise, then solve; a singular matrix cannot be solved with");
}

/// Sizes and finiteness of the values of a matrix of `expected` entries.
inline void check_values(std::span<const double> values, int expected) {
  check_size("the values of a sparse matrix", values.size(), static_cast<std::size_t>(expected));
  double sum = 0.0;  // 0 * x is NaN exactly where x is not finite
  for (const double v : values) sum += 0.0 * v;
  if (sum == 0.0) return;
  for (std::size_t e = 0; e < values.size(); ++e) {
    if (!std::isfinite(values[e])) {
      throw data::InputError("linear-value", "entry " + std::to_string(e) + " of a sparse matrix is `" +
                                                 std::to_string(values[e]) + "`");
    }
  }
}

inline void check_columns(std::size_t entries, int n, int columns) {
  check_size("a block of right-hand sides", entries,
             static_cast<std::size_t>(n) * static_cast<std::size_t>(columns));
}

/// Throws InputError("linear-size") unless the groups are empty or have one entry per unknown.
inline void check_groups(const UnknownGroups& groups, int n) {
  const auto count = static_cast<std::size_t>(n);
  if (!groups.block_of_unknown.empty())
    check_size("the blocks of the unknowns", groups.block_of_unknown.size(), count);
  if (!groups.constraint.empty()) check_size("the constraint marks", groups.constraint.size(), count);
  for (const int block : groups.block_of_unknown) {
    if (block < 0) {
      throw data::InputError("linear-size",
                             "a block of unknowns has the label `" + std::to_string(block) + "`",
                             "labels count from 0");
    }
  }
}

}  // namespace brachium::fem
