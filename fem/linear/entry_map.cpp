#include "fem/linear/entry_map.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "data/model/error.hpp"
#include "fem/linear/dense_front.hpp"

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

// A run before it is known where it goes.
struct Piece {
  int column, entry, length;
};

// Adds the runs of one piece; `place` is the row of a position inside the front. Rows break at the ends of
// panels.
void add_runs(const Piece& piece, int column, int row, const DenseFront& shape, std::vector<EntryRun>& runs) {
  if (column > row) {  // the rows are the pivots
    runs.push_back(
        {piece.entry, static_cast<int>(shape.w_offset(column)) + row * kRows, piece.length, kRows});
    return;
  }
  for (int done = 0; done < piece.length;) {
    const int offset = static_cast<int>(shape.w_offset(row + done)) + column * kRows;
    int length = 1;
    while (done + length < piece.length &&
           shape.w_offset(row + done + length) + column * kRows == offset + length) {
      ++length;
    }
    runs.push_back({piece.entry + done, offset, length, 1});
    done += length;
  }
}

}  // namespace

EntryMap make_entry_map(const SymmetricPattern& pattern, const BlockGraph& graph, const AssemblyTree& tree) {
  const int count = static_cast<int>(tree.fronts.size());
  std::vector<int> front_at(pattern.n);  // by position
  for (int f = 0; f < count; ++f) {
    const Front& front = tree.fronts[f];
    DenseFront shape;
    shape.pivots = front.pivots;
    shape.updates = front.updates;
    if (shape.w_size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw data::InputError("linear-size",
                             "a front of a sparse factorisation has " + std::to_string(front.size()) +
                                 " rows and " + std::to_string(front.pivots) + " columns",
                             "the matrix is too dense for a sparse solver");
    }
    std::fill_n(front_at.begin() + front.first, front.pivots, f);
  }
  const auto front_of = [&](int j, int e) {
    return front_at[std::min(tree.position_of[j], tree.position_of[pattern.row[e]])];
  };
  std::vector<long long> start(static_cast<std::size_t>(count) + 1, 0);
  for_runs(pattern, graph, tree, [&](int j, int e, int) { ++start[front_of(j, e) + 1]; });
  for (int f = 0; f < count; ++f) start[f + 1] += start[f];
  std::vector<Piece> pieces(static_cast<std::size_t>(start.back()));
  std::vector<long long> next(start.begin(), start.end() - 1);
  for_runs(pattern, graph, tree, [&](int j, int e, int length) {
    pieces[next[front_of(j, e)]++] = {j, e, length};
  });

  EntryMap map;
  map.start.push_back(0);
  map.runs.reserve(pieces.size() + pieces.size() / 4);
  std::vector<int> place(pattern.n);  // of a position in the front at hand
  for (int f = 0; f < count; ++f) {
    const Front& front = tree.fronts[f];
    DenseFront shape;
    shape.pivots = front.pivots;
    shape.updates = front.updates;
    for (int k = 0; k < front.pivots; ++k) place[front.first + k] = k;
    for (int k = 0; k < front.updates; ++k) place[tree.row[front.row_start + k]] = front.pivots + k;
    for (long long r = start[f]; r < start[f + 1]; ++r) {
      const Piece& piece = pieces[r];
      add_runs(piece, place[tree.position_of[piece.column]],
               place[tree.position_of[pattern.row[piece.entry]]], shape, map.runs);
    }
    map.start.push_back(static_cast<long long>(map.runs.size()));
  }
  return map;
}

}  // namespace brachium::fem
