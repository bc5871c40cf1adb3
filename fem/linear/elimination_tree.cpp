#include "fem/linear/elimination_tree.hpp"

namespace brachium::fem {

namespace {

// Parent of every position under the order given: Liu's algorithm with path compression.
std::vector<int> parents(const BlockGraph& graph, const std::vector<int>& order,
                         const std::vector<int>& position) {
  const int n = graph.vertices();
  std::vector<int> parent(n, -1), ancestor(n, -1);
  for (int i = 0; i < n; ++i) {
    const int v = order[i];
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      int k = position[graph.neighbour[e]];
      while (k != -1 && k < i) {
        const int next = ancestor[k];
        ancestor[k] = i;
        if (next == -1) parent[k] = i;
        k = next;
      }
    }
  }
  return parent;
}

std::vector<int> postorder(const std::vector<int>& parent) {
  const int n = static_cast<int>(parent.size());
  std::vector<int> first_child(n, -1), sibling(n, -1), result, stack;
  for (int i = n - 1; i >= 0; --i) {
    if (parent[i] < 0) continue;
    sibling[i] = first_child[parent[i]];
    first_child[parent[i]] = i;
  }
  result.reserve(n);
  for (int root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int i = stack.back();
      if (first_child[i] >= 0) {
        stack.push_back(first_child[i]);
        first_child[i] = sibling[first_child[i]];
      } else {
        result.push_back(i);
        stack.pop_back();
      }
    }
  }
  return result;
}

}  // namespace

EliminationTree make_elimination_tree(const BlockGraph& graph, const std::vector<int>& order) {
  const int n = graph.vertices();
  std::vector<int> position(n);
  for (int i = 0; i < n; ++i) position[order[i]] = i;
  const std::vector<int> parent = parents(graph, order, position);
  const std::vector<int> sequence = postorder(parent);
  std::vector<int> new_position(n);
  for (int i = 0; i < n; ++i) new_position[sequence[i]] = i;
  EliminationTree tree;
  tree.vertex.resize(n);
  tree.parent.resize(n);
  tree.rows.resize(n);
  for (int i = 0; i < n; ++i) {
    const int old = sequence[i];
    tree.vertex[i] = order[old];
    tree.parent[i] = parent[old] < 0 ? -1 : new_position[parent[old]];
    tree.rows[i] = graph.size(order[old]);
  }
  for (int i = 0; i < n; ++i) position[tree.vertex[i]] = i;
  // Row i of L is the part of the tree between the neighbours of i that come before it and i.
  std::vector<int> mark(n, -1);
  for (int i = 0; i < n; ++i) {
    mark[i] = i;
    const int v = tree.vertex[i];
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      for (int k = position[graph.neighbour[e]]; k < i && mark[k] != i; k = tree.parent[k]) {
        mark[k] = i;
        tree.rows[k] += graph.size(v);
      }
    }
  }
  return tree;
}

}  // namespace brachium::fem
