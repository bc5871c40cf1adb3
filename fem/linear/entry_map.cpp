#include "fem/linear/entry_map.hpp"

#include <limits>
#include <string>

#include "data/model/error.hpp"

namespace brachium::fem {

namespace {

// Calls see(column, first entry, length) for the runs of entries whose rows are unknowns of one vertex at
// consecutive positions. Inside the column's own vertex the rows lie below the column in any order of
// vertices.
template <class See>
void for_runs(const SymmetricPattern& pattern, const BlockGraph& graph, const AssemblyTree& tree,
              const See& see) {
  for (int j = 0; j < pattern.n; ++j) {
    for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1];) {
      int end = e + 1;
      while (end < pattern.column_start[j + 1] &&
             graph.vertex_of[pattern.row[end]] == graph.vertex_of[pattern.row[e]] &&
             tree.position_of[pattern.row[end]] == tree.position_of[pattern.row[e]] + end - e) {
        ++end;
      }
      see(j, e, end - e);
      e = end;
    }
  }
}

}  // namespace

EntryMap make_entry_map(const SymmetricPattern& pattern, const BlockGraph& graph, const AssemblyTree& tree) {
  const int count = static_cast<int>(tree.fronts.size());
  std::vector<int> front_at(pattern.n);  // by position
  for (int f = 0; f < count; ++f) {
    const Front& front = tree.fronts[f];
    if (static_cast<long long>(front.size()) * front.pivots > std::numeric_limits<int>::max()) {
      throw data::InputError("linear-size",
                             "a front of a sparse factorisation has " + std::to_string(front.size()) +
                                 " rows and " + std::to_string(front.pivots) + " columns",
                             "the matrix is too dense for a sparse solver");
    }
    for (int k = 0; k < front.pivots; ++k) front_at[front.first + k] = f;
  }
  EntryMap map;
  map.start.assign(static_cast<std::size_t>(count) + 1, 0);
  const auto front_of = [&](int j, int e) {
    return front_at[std::min(tree.position_of[j], tree.position_of[pattern.row[e]])];
  };
  for_runs(pattern, graph, tree, [&](int j, int e, int) { ++map.start[front_of(j, e) + 1]; });
  for (int f = 0; f < count; ++f) map.start[f + 1] += map.start[f];
  map.runs.resize(map.start.back());
  std::vector<int> column(map.runs.size());
  std::vector<long long> next(map.start.begin(), map.start.end() - 1);
  for_runs(pattern, graph, tree, [&](int j, int e, int length) {
    const long long at = next[front_of(j, e)]++;
    map.runs[at] = {e, 0, length, 1};
    column[at] = j;
  });
  std::vector<int> place(pattern.n);  // of a position in the front at hand
  for (int f = 0; f < count; ++f) {
    const Front& front = tree.fronts[f];
    for (int k = 0; k < front.pivots; ++k) place[front.first + k] = k;
    for (int k = 0; k < front.updates; ++k) place[tree.row[front.row_start + k]] = front.pivots + k;
    for (long long r = map.start[f]; r < map.start[f + 1]; ++r) {
      EntryRun& run = map.runs[r];
      const int a = tree.position_of[column[r]], b = tree.position_of[pattern.row[run.entry]];
      run.offset = a <= b ? place[a] * front.size() + place[b] : place[b] * front.size() + place[a];
      run.step = a <= b ? 1 : front.size();
    }
  }
  return map;
}

}  // namespace brachium::fem
