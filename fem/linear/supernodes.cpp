#include "fem/linear/supernodes.hpp"

#include <algorithm>

#include "fem/linear/assembly_tree.hpp"

namespace brachium::fem {

std::vector<Supernode> find_supernodes(const BlockGraph& graph, const EliminationTree& tree) {
  const int n = static_cast<int>(tree.vertex.size());
  std::vector<Supernode> nodes;
  std::vector<int> node_of(n);
  for (int i = 0; i < n; ++i) {
    const int size = graph.size(tree.vertex[i]);
    const bool same_rows =
        i > 0 && tree.parent[i - 1] == i && tree.rows[i - 1] - graph.size(tree.vertex[i - 1]) == tree.rows[i];
    if (!same_rows) nodes.emplace_back();
    node_of[i] = static_cast<int>(nodes.size()) - 1;
    nodes.back().vertices.push_back(tree.vertex[i]);
    nodes.back().pivots += size;
    nodes.back().updates = tree.rows[i] - size;
  }
  for (int i = 0; i < n; ++i) {
    if (tree.parent[i] >= 0 && node_of[tree.parent[i]] != node_of[i])
      nodes[node_of[i]].parent = node_of[tree.parent[i]];
  }
  return nodes;
}

double front_seconds(double w, double u) {
  // Measured on one core with AVX2 (order of magnitude is enough): start of a front, traffic of one entry of
  // the panel, of one entry of the Schur complement (written, then read and added in the parent), arithmetic,
  // which is slow for few pivots because every entry of the Schur complement is then loaded and stored for
  // little work.
  constexpr double start = 1.5e-6, panel_entry = 1.2e-9, update_entry = 1.5e-9, flop = 1.0 / 45e9;
  return start + panel_entry * w * (0.5 * w + u) + update_entry * 0.5 * u * u +
         flop * front_flops(w, u) * (1.0 + 10.0 / std::max(w, 1.0));
}

std::vector<Supernode> amalgamate(std::vector<Supernode> nodes) {
  const int count = static_cast<int>(nodes.size());
  std::vector<std::vector<int>> children(nodes.size());
  for (int s = 0; s < count; ++s) {
    if (nodes[s].parent >= 0) children[nodes[s].parent].push_back(s);
  }
  for (int p = 0; p < count; ++p) {
    // Children with the most update rows lose least; what they bring along as children of their own is tried
    // too.
    std::vector<int> candidates = children[p], kept;
    while (!candidates.empty()) {
      const auto best = std::max_element(candidates.begin(), candidates.end(), [&](int a, int b) {
        return nodes[a].updates != nodes[b].updates ? nodes[a].updates < nodes[b].updates : a < b;
      });
      const int c = *best;
      candidates.erase(best);
      Supernode &child = nodes[c], &parent = nodes[p];
      const double apart = front_seconds(double(child.pivots), double(child.updates)) +
                           front_seconds(double(parent.pivots), double(parent.updates));
      if (front_seconds(double(child.pivots + parent.pivots), double(parent.updates)) > apart) {
        kept.push_back(c);
        continue;
      }
      child.vertices.insert(child.vertices.end(), parent.vertices.begin(), parent.vertices.end());
      parent.vertices = std::move(child.vertices);
      child.vertices.clear();
      parent.pivots += child.pivots;
      for (const int grandchild : children[c]) nodes[grandchild].parent = p;
      candidates.insert(candidates.end(), children[c].begin(), children[c].end());
      children[c].clear();
    }
    children[p] = std::move(kept);
  }
  return nodes;
}

}  // namespace brachium::fem
