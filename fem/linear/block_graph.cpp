#include "fem/linear/block_graph.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <cholmod.h>
#include <metis.h>

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

std::vector<int> order_by_amd(const BlockGraph& graph) {
  // Lower triangle by columns for CHOLMOD (stype -1).
  const int vertices = graph.vertices();
  std::vector<int> column_start{0}, row, result(vertices);
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
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  const int ok = cholmod_amd(&matrix, nullptr, 0, result.data(), &common);
  const int status = common.status;
  cholmod_finish(&common);
  if (ok == 0) {
    if (status == CHOLMOD_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::logic_error("AMD refused to order a graph, status " + std::to_string(status));
  }
  return result;
}

// Empty where METIS fails, as it now and then does on an odd graph.
std::vector<int> order_by_metis(const BlockGraph& graph) {
  std::vector<idx_t> start(graph.start.begin(), graph.start.end());
  std::vector<idx_t> neighbour(graph.neighbour.begin(), graph.neighbour.end());
  idx_t vertices = graph.vertices();
  std::vector<idx_t> vertex_at(graph.start.size(), -1), position_of(graph.start.size());
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_NSEPS] = 2;
  options[METIS_OPTION_UFACTOR] = 100;
  options[METIS_OPTION_SEED] = 1;
  int status = METIS_ERROR;
  {
    const std::lock_guard lock(metis_mutex());
    status = METIS_NodeND(&vertices, start.data(), neighbour.data(), nullptr, options, vertex_at.data(),
                          position_of.data());
  }
  if (status == METIS_ERROR_MEMORY) throw std::bad_alloc();
  if (status != METIS_OK) return {};
  std::vector<int> result(vertex_at.begin(), vertex_at.end() - 1);
  std::vector<char> seen(result.size(), 0);
  for (const int v : result) {
    if (v < 0 || v >= graph.vertices() || seen[v]++ != 0) return {};
  }
  return result;
}

}  // namespace

std::mutex& metis_mutex() {
  static std::mutex mutex;
  return mutex;
}

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
  if (ordering == Ordering::automatic) {
    ordering = graph.vertices() < kSmallGraph ? Ordering::amd : Ordering::metis;
  }
  if (ordering == Ordering::metis && !graph.neighbour.empty()) {
    std::vector<int> result = order_by_metis(graph);
    if (!result.empty()) return {std::move(result), "METIS"};
    return {order_by_amd(graph), "AMD (METIS failed)"};
  }
  return {order_by_amd(graph), "AMD"};
}

}  // namespace brachium::fem
