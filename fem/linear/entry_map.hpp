#pragma once
/// Where the entries of A go in the fronts.

#include <span>
#include <vector>

#include "fem/linear/assembly_tree.hpp"

namespace brachium::fem {

/// Entries of A that are consecutive in a column and go to consecutive rows of one column of a panel, or,
/// where the rows are eliminated before the column, to consecutive columns of one row.
struct EntryRun {
  int entry;   ///< first entry of A
  int offset;  ///< of the first value in DenseFront::packed_w
  int length;
  int step;  ///< 1, or that of the columns of a panel
};

struct EntryMap {
  std::vector<long long> start;  ///< runs of a front: [start[f], start[f + 1])
  std::vector<EntryRun> runs;

  /// Adds the entries of A that belong to front f to its columns.
  void scatter(int f, std::span<const double> values, double* packed_w) const {
    for (long long r = start[f]; r < start[f + 1]; ++r) {
      const EntryRun& run = runs[r];
      double* to = packed_w + run.offset;
      const double* from = values.data() + run.entry;
      for (int k = 0; k < run.length; ++k) to[static_cast<std::ptrdiff_t>(k) * run.step] += from[k];
    }
  }
};

/// InputError("linear-size") when a single front would hold more than 2^31 values.
EntryMap make_entry_map(const SymmetricPattern& pattern, const BlockGraph& graph, const AssemblyTree& tree);

}  // namespace brachium::fem
