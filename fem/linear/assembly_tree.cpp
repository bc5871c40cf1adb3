#include "fem/linear/assembly_tree.hpp"

#include <algorithm>
#include <numeric>

#include "fem/linear/constraint_order.hpp"
#include "fem/linear/dense_front.hpp"
#include "fem/linear/elimination_tree.hpp"
#include "fem/linear/supernodes.hpp"

namespace brachium::fem {

namespace {

// Positions of the fronts so that the work space of a traversal is small: a child whose subtree needs much
// beyond what it leaves behind goes first (Liu 1986, theorem 3.2).
std::vector<int> postorder(const std::vector<Supernode>& nodes) {
  const int count = static_cast<int>(nodes.size());
  std::vector<std::vector<int>> children(nodes.size());
  std::vector<int> roots;
  for (int s = 0; s < count; ++s) {
    if (nodes[s].vertices.empty()) continue;
    (nodes[s].parent < 0 ? roots : children[nodes[s].parent]).push_back(s);
  }
  std::vector<double> peak(nodes.size(), 0.0);
  const auto kept = [&](int s) { return 0.5 * double(nodes[s].updates) * double(nodes[s].updates); };
  for (int s = 0; s < count; ++s) {  // children have lower numbers
    if (nodes[s].vertices.empty()) continue;
    auto& mine = children[s];
    std::stable_sort(mine.begin(), mine.end(),
                     [&](int a, int b) { return peak[a] - kept(a) > peak[b] - kept(b); });
    double held = 0.0;
    for (const int c : mine) {
      peak[s] = std::max(peak[s], held + peak[c]);
      held += kept(c);
    }
    peak[s] = std::max(peak[s], held + kept(s));
  }
  std::vector<int> result, stack;
  std::vector<std::size_t> next(nodes.size(), 0);
  for (const int root : roots) {
    stack.push_back(root);
    while (!stack.empty()) {
      const int s = stack.back();
      if (next[s] < children[s].size()) {
        stack.push_back(children[s][next[s]++]);
      } else {
        result.push_back(s);
        stack.pop_back();
      }
    }
  }
  return result;
}

struct Builder {
  const BlockGraph& graph;
  AssemblyTree tree;
  std::vector<std::vector<int>> pivots, updates;  // vertices of a front
  std::vector<int> rank;                          // of a vertex in the final order

  // Update vertices of a front: those of its children and the neighbours of its pivots, without the pivots.
  void find_rows(int f, std::vector<int>& mark) {
    const int end = rank[pivots[f].back()];
    const auto add = [&](int v) {
      if (rank[v] > end && mark[v] != f) {
        mark[v] = f;
        updates[f].push_back(v);
      }
    };
    for (int c = tree.child_start[f]; c < tree.child_start[f + 1]; ++c) {
      for (const int v : updates[tree.child[c]]) add(v);
    }
    for (const int p : pivots[f]) {
      for (int e = graph.start[p]; e < graph.start[p + 1]; ++e) add(graph.neighbour[e]);
    }
    std::sort(updates[f].begin(), updates[f].end(), [&](int a, int b) { return rank[a] < rank[b]; });
  }

  int position(int v) const { return tree.position_of[graph.unknown[graph.first_unknown[v]]]; }

  void expand_rows(int f) {
    Front& front = tree.fronts[f];
    front.row_start = static_cast<long long>(tree.row.size());
    for (const int v : updates[f]) {
      const int first = position(v);
      for (int k = 0; k < graph.size(v); ++k) tree.row.push_back(first + k);
    }
    front.updates = static_cast<int>(static_cast<long long>(tree.row.size()) - front.row_start);
    front.factor_start = tree.stored_entries;
    const long long w = front.pivots, u = front.updates;
    tree.stored_entries += static_cast<long long>(DenseFront::l_size(front.pivots, front.updates));
    tree.factor_entries += w * (w + 1) / 2 + w * u;
    tree.flops += front_flops(double(w), double(u));
  }

  void place_in_parent(int f) {
    const Front& front = tree.fronts[f];
    if (front.parent < 0) return;
    const Front& parent = tree.fronts[front.parent];
    const int* of_parent = tree.row.data() + parent.row_start;
    int at = 0;
    for (int i = 0; i < front.updates; ++i) {
      const int row = tree.row[front.row_start + i];
      int place = row - parent.first;
      if (place >= parent.pivots) {
        while (of_parent[at] < row) ++at;
        place = parent.pivots + at;
      }
      tree.row_in_parent[front.row_start + i] = place;
    }
  }
};

}  // namespace

double front_flops(double w, double u) {
  return w * u * u + u * w * (w + 1.0) + w * (w + 1.0) * (2.0 * w + 1.0) / 6.0;
}

AssemblyTree make_assembly_tree(const BlockGraph& graph, std::vector<int> order) {
  move_constraints(graph, order);
  const EliminationTree elimination = make_elimination_tree(graph, order);
  const std::vector<Supernode> nodes = amalgamate(find_supernodes(graph, elimination));
  const std::vector<int> sequence = postorder(nodes);
  const int count = static_cast<int>(sequence.size());

  Builder b{graph, {}, {}, {}, std::vector<int>(graph.vertices())};
  AssemblyTree& tree = b.tree;
  b.pivots.resize(count);
  b.updates.resize(count);
  tree.fronts.resize(count);
  std::vector<int> front_of_node(nodes.size(), -1);
  for (int f = 0; f < count; ++f) front_of_node[sequence[f]] = f;
  tree.position_of.resize(graph.unknown.size());
  int next_rank = 0;
  for (int f = 0; f < count; ++f) {
    const Supernode& node = nodes[sequence[f]];
    b.pivots[f] = node.vertices;
    // Inside a front every order is as good: constraints last, where the displacements have given them
    // stiffness.
    std::stable_partition(b.pivots[f].begin(), b.pivots[f].end(),
                          [&](int v) { return graph.constraint[v] == 0; });
    tree.fronts[f].first = static_cast<int>(tree.unknown_at.size());
    tree.fronts[f].parent = node.parent < 0 ? -1 : front_of_node[node.parent];
    for (const int v : b.pivots[f]) {
      b.rank[v] = next_rank++;
      for (int k = graph.first_unknown[v]; k < graph.first_unknown[v + 1]; ++k) {
        tree.position_of[graph.unknown[k]] = static_cast<int>(tree.unknown_at.size());
        tree.unknown_at.push_back(graph.unknown[k]);
      }
    }
    tree.fronts[f].pivots = static_cast<int>(tree.unknown_at.size()) - tree.fronts[f].first;
  }
  tree.child_start.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const Front& front : tree.fronts) {
    if (front.parent >= 0) ++tree.child_start[front.parent + 1];
  }
  std::partial_sum(tree.child_start.begin(), tree.child_start.end(), tree.child_start.begin());
  tree.child.resize(tree.child_start.back());
  std::vector<int> next(tree.child_start.begin(), tree.child_start.end() - 1);
  for (int f = 0; f < count; ++f) {
    if (tree.fronts[f].parent >= 0) tree.child[next[tree.fronts[f].parent]++] = f;
  }
  std::vector<int> mark(graph.vertices(), -1);
  for (int f = 0; f < count; ++f) {
    b.find_rows(f, mark);
    b.expand_rows(f);
  }
  tree.row_in_parent.resize(tree.row.size());
  for (int f = 0; f < count; ++f) b.place_in_parent(f);
  return std::move(tree);
}

}  // namespace brachium::fem
