#include "fem/linear/assembly_tree.hpp"

#include <numeric>
#include <set>

#include "fem/linear/elimination_tree.hpp"
#include "fem/linear/supernodes.hpp"
#include "tests/fem/linear/stokes_matrix.hpp"

namespace brachium::fem {
namespace {

// Rows of each column of L by the definition: neighbours of an eliminated vertex become neighbours of each
// other.
std::vector<std::set<int>> eliminate_by_hand(const BlockGraph& graph, const std::vector<int>& order) {
  const int n = graph.vertices();
  std::vector<int> position(n);
  for (int i = 0; i < n; ++i) position[order[i]] = i;
  std::vector<std::set<int>> below(n);
  for (int i = 0; i < n; ++i) {
    const int v = order[i];
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      if (position[graph.neighbour[e]] > i) below[i].insert(position[graph.neighbour[e]]);
    }
  }
  for (int i = 0; i < n; ++i) {
    if (below[i].empty()) continue;
    const int next = *below[i].begin();
    below[next].insert(std::next(below[i].begin()), below[i].end());
  }
  return below;
}

TEST(BlockGraph, OfHexahedraHasOneVertexANodeAndOneOfScatteredLabelsTheSameFill) {
  test::Matrix m = test::hex27_grid(2, 2, 1);
  const BlockGraph graph = make_block_graph(m.pattern, m.groups);
  EXPECT_EQ(graph.vertices(), m.n() / 3);
  EXPECT_EQ(graph.start[1] - graph.start[0], 26);  // a corner node sees its element
  for (int& label : m.groups.block_of_unknown) label = 5 * label + 2;
  const BlockGraph relabelled = make_block_graph(m.pattern, m.groups);
  EXPECT_EQ(relabelled.neighbour, graph.neighbour);
}

TEST(BlockGraph, OfUnknownsThatInterleaveIsSymmetric) {
  test::Matrix m = test::laplacian(4, 3, 2);
  for (int i = 0; i < m.n(); ++i) m.groups.block_of_unknown.push_back(i % 7);
  const BlockGraph graph = make_block_graph(m.pattern, m.groups);
  ASSERT_EQ(graph.vertices(), 7);
  for (int v = 0; v < 7; ++v) {
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      const int w = graph.neighbour[e];
      EXPECT_NE(w, v);
      const auto begin = graph.neighbour.begin() + graph.start[w],
                 end = graph.neighbour.begin() + graph.start[w + 1];
      EXPECT_TRUE(std::binary_search(begin, end, v));
    }
  }
}

TEST(BlockOrder, IsAPermutationAndTheSameEveryTime) {
  const test::Matrix m = test::hex27_grid(4, 3, 3);
  const BlockGraph graph = make_block_graph(m.pattern, m.groups);
  for (const Ordering ordering : {Ordering::metis, Ordering::amd}) {
    const BlockOrder first = order(graph, ordering);
    std::vector<int> sorted = first.position_to_vertex;
    std::sort(sorted.begin(), sorted.end());
    std::vector<int> all(graph.vertices());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(sorted, all);
    std::rand();
    EXPECT_EQ(order(graph, ordering).position_to_vertex, first.position_to_vertex);
  }
}

TEST(EliminationTree, HasParentsAndRowCountsOfEliminationByHand) {
  const test::Matrix m = test::hex27_grid(3, 2, 1);
  const BlockGraph graph = make_block_graph(m.pattern, m.groups);
  const EliminationTree tree = make_elimination_tree(graph, order(graph, Ordering::amd).position_to_vertex);
  const auto below = eliminate_by_hand(graph, tree.vertex);
  for (int i = 0; i < graph.vertices(); ++i) {
    EXPECT_EQ(tree.parent[i], below[i].empty() ? -1 : *below[i].begin());
    EXPECT_EQ(tree.rows[i], 3 * (1 + static_cast<long>(below[i].size())));
  }
}

TEST(AssemblyTree, HoldsEveryEntryOfLAndFewStoredZeros) {
  for (const Ordering ordering : {Ordering::metis, Ordering::amd}) {
    const test::Matrix m = test::hex27_grid(3, 3, 2);
    const BlockGraph graph = make_block_graph(m.pattern, m.groups);
    const AssemblyTree tree = make_assembly_tree(graph, order(graph, ordering).position_to_vertex);
    std::vector<int> vertices;  // in the order of elimination
    for (std::size_t k = 0; k < tree.unknown_at.size(); k += 3)
      vertices.push_back(graph.vertex_of[tree.unknown_at[k]]);
    const auto below = eliminate_by_hand(graph, vertices);
    long long exact = 0;
    for (const auto& rows : below) exact += 3 * 2 + 9 * static_cast<long long>(rows.size());
    EXPECT_GE(tree.factor_entries, exact);
    EXPECT_LT(static_cast<double>(tree.factor_entries), 1.35 * static_cast<double>(exact));
    for (std::size_t f = 0; f < tree.fronts.size(); ++f) {
      const Front& front = tree.fronts[f];
      const auto begin = tree.row.begin() + front.row_start, end = begin + front.updates;
      EXPECT_TRUE(std::is_sorted(begin, end));
      for (int k = 0; k < front.pivots; k += 3) {
        for (const int row : below[(front.first + k) / 3]) {
          EXPECT_TRUE(3 * row < front.first + front.pivots || std::binary_search(begin, end, 3 * row));
        }
      }
      if (front.parent < 0) continue;
      EXPECT_GT(front.parent, static_cast<int>(f));
      const Front& parent = tree.fronts[front.parent];
      for (int i = 0; i < front.updates; ++i) {
        const int place = tree.row_in_parent[front.row_start + i];
        const int position =
            place < parent.pivots ? parent.first + place : tree.row[parent.row_start + place - parent.pivots];
        EXPECT_EQ(position, *(begin + i));
      }
    }
  }
}

TEST(AssemblyTree, EliminatesAPressureAfterHalfOfTheDisplacementsThatItCouplesTo) {
  const test::Stokes stokes = test::stokes(3, 3, 2);
  const BlockGraph graph = make_block_graph(stokes.matrix.pattern, stokes.matrix.groups);
  const AssemblyTree tree = make_assembly_tree(graph, order(graph, Ordering::metis).position_to_vertex);
  for (int v = 0; v < graph.vertices(); ++v) {
    if (graph.constraint[v] == 0) continue;
    int before = 0, coupled = 0;
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      const int u = graph.unknown[graph.first_unknown[graph.neighbour[e]]];
      if (graph.constraint[graph.neighbour[e]] != 0) continue;
      ++coupled;
      before += tree.position_of[u] < tree.position_of[graph.unknown[graph.first_unknown[v]]] ? 1 : 0;
    }
    EXPECT_GE(2 * before, coupled) << "pressure " << v;
  }
}

TEST(Amalgamation, JoinsAChainOfSmallFronts) {
  // A tridiagonal matrix: without joining, as many fronts as unknowns but one.
  test::Entries entries;
  for (int i = 0; i < 100; ++i) {
    entries[{i, i}] = 2.0;
    if (i > 0) entries[{i - 1, i}] = -1.0;
  }
  const test::Matrix m = test::from_entries(100, entries);
  const BlockGraph graph = make_block_graph(m.pattern, {});
  std::vector<int> natural(100);
  std::iota(natural.begin(), natural.end(), 0);
  EXPECT_EQ(find_supernodes(graph, make_elimination_tree(graph, natural)).size(), 99U);
  EXPECT_LT(make_assembly_tree(graph, natural).fronts.size(), 10U);
}

}  // namespace
}  // namespace brachium::fem
