#include "fem/linear/block_graph.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <cholmod.h>

#include "fem/linear/linear_checks.hpp"

namespace brachium::fem {

namespace {

constexpr int kSmallGraph = 200;  // METIS itself hands graphs of this size to minimum degree

void number_vertices(const SymmetricPattern& pattern, const UnknownGroups& groups, BlockGraph& graph) {
  const int n = pattern.n;
  graph.vertex_of.resize(n);
  int vertices = n;
  if (groups.block_of_unknown.empty()) {
    std::iota(graph.vertex_of.begin(), graph.vertex_of.end(), 0);
  } else {
    const std::vector<int>& label = groups.block_of_unknown;
    std::vector<int> vertex_of_label(
        static_cast<std::size_t>(*std::max_element(label.begin(), label.end())) + 1, -1);
    vertices = 0;
    for (int i = 0; i < n; ++i) {
      int& vertex = vertex_of_label[label[i]];
      if (vertex < 0) vertex = vertices++;
      graph.vertex_of[i] = vertex;
    }
  }
  graph.first_unknown.assign(static_cast<std::size_t>(vertices) + 1, 0);
  for (const int v : graph.vertex_of) ++graph.first_unknown[v + 1];
  std::partial_sum(graph.first_unknown.begin(), graph.first_unknown.end(), graph.first_unknown.begin());
  graph.unknown.resize(n);
  std::vector<int> next(graph.first_unknown.begin(), graph.first_unknown.end() - 1);
  graph.constraint.assign(vertices, 0);
  std::vector<char> seen(vertices, 0);
  for (int i = 0; i < n; ++i) {
    const int v = graph.vertex_of[i];
    graph.unknown[next[v]++] = i;
    const char mark = groups.constraint.empty() ? 0 : static_cast<char>(groups.constraint[i] != 0);
    if (seen[v] && mark != graph.constraint[v]) {
      throw data::InputError(
          "linear-size",
          "the block of unknown `" + std::to_string(i) + "` holds constraint unknowns and others",
          "give pressures blocks of their own");
    }
    seen[v] = 1;
    graph.constraint[v] = mark;
  }
}

}  // namespace

BlockGraph make_block_graph(const SymmetricPattern& pattern, const UnknownGroups& groups) {
  check(pattern);
  check_groups(groups, pattern.n);
  BlockGraph graph;
  number_vertices(pattern, groups, graph);
  const int vertices = graph.vertices();
  // Edges (v, w), v < w, each once, from the columns of v; then both directions by a counting sort.
  std::vector<int> mark(vertices, -1), tail, head;
  // Edges whose lower entry stands in the column of the higher vertex are kept with the vertex of their
  // column.
  for (int v = 0; v < vertices; ++v) {
    mark[v] = v;
    for (int k = graph.first_unknown[v]; k < graph.first_unknown[v + 1]; ++k) {
      const int j = graph.unknown[k];
      for (int e = pattern.column_start[j]; e < pattern.column_start[j + 1]; ++e) {
        const int w = graph.vertex_of[pattern.row[e]];
        if (mark[w] == v) continue;
        mark[w] = v;
        tail.push_back(v);
        head.push_back(w);
      }
    }
  }
  std::vector<int> count(static_cast<std::size_t>(vertices) + 1, 0);
  for (std::size_t e = 0; e < tail.size(); ++e) {
    ++count[tail[e] + 1];
    ++count[head[e] + 1];
  }
  std::partial_sum(count.begin(), count.end(), count.begin());
  std::vector<int> both(count.back()), next(count.begin(), count.end() - 1);
  for (std::size_t e = 0; e < tail.size(); ++e) {
    both[next[tail[e]]++] = head[e];
    both[next[head[e]]++] = tail[e];
  }
  // Blocks that interleave give an edge from both ends: sort and keep one.
  graph.start.assign(1, 0);
  for (int v = 0; v < vertices; ++v) {
    const auto begin = both.begin() + count[v], end = both.begin() + count[v + 1];
    std::sort(begin, end);
    graph.neighbour.insert(graph.neighbour.end(), begin, std::unique(begin, end));
    graph.start.push_back(static_cast<int>(graph.neighbour.size()));
  }
  return graph;
}

BlockOrder order(const BlockGraph& graph, Ordering ordering) {
  const int vertices = graph.vertices();
  if (ordering == Ordering::automatic) {
    ordering = vertices < kSmallGraph ? Ordering::amd : Ordering::metis;
  }
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  // Lower triangle by columns for CHOLMOD (stype -1).
  std::vector<int> column_start{0}, row;
  row.reserve(graph.neighbour.size() / 2 + vertices);
  for (int v = 0; v < vertices; ++v) {
    row.push_back(v);
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      if (graph.neighbour[e] > v) row.push_back(graph.neighbour[e]);
    }
    column_start.push_back(static_cast<int>(row.size()));
  }
  cholmod_sparse matrix{};
  matrix.nrow = matrix.ncol = static_cast<std::size_t>(vertices);
  matrix.nzmax = row.size();
  matrix.p = column_start.data();
  matrix.i = row.data();
  matrix.stype = -1;
  matrix.itype = CHOLMOD_INT;
  matrix.xtype = CHOLMOD_PATTERN;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = matrix.packed = 1;
  BlockOrder result;
  result.position_to_vertex.resize(vertices);
  const bool metis = ordering == Ordering::metis;
  const int ok = metis ? cholmod_metis(&matrix, nullptr, 0, 0, result.position_to_vertex.data(), &common)
                       : cholmod_amd(&matrix, nullptr, 0, result.position_to_vertex.data(), &common);
  const int status = common.status;
  cholmod_finish(&common);
  if (ok == 0) {
    if (status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::logic_error("SuiteSparse refused to order a graph, status " + std::to_string(status));
  }
  result.name = metis ? "METIS" : "AMD";
  return result;
}

}  // namespace brachium::fem
