#include "fem/linear/constraint_order.hpp"

#include <algorithm>

namespace brachium::fem {

void move_constraints(const BlockGraph& graph, std::vector<int>& order) {
  if (std::find(graph.constraint.begin(), graph.constraint.end(), 1) == graph.constraint.end()) return;
  const int n = graph.vertices();
  std::vector<int> position(n);
  for (int i = 0; i < n; ++i) position[order[i]] = i;
  // Twice the position to come behind, plus one: ties keep the order that was.
  std::vector<long> key(n);
  std::vector<int> behind;
  for (int v = 0; v < n; ++v) {
    key[v] = 2L * position[v];
    if (graph.constraint[v] == 0) continue;
    behind.clear();
    for (int e = graph.start[v]; e < graph.start[v + 1]; ++e) {
      if (graph.constraint[graph.neighbour[e]] == 0) behind.push_back(position[graph.neighbour[e]]);
    }
    if (behind.empty()) continue;
    const auto half = behind.begin() + static_cast<std::ptrdiff_t>((behind.size() - 1) / 2);
    std::nth_element(behind.begin(), half, behind.end());
    key[v] = std::max(key[v], 2L * *half + 1);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key[a] < key[b]; });
}

}  // namespace brachium::fem
