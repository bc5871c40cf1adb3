#pragma once
/// Elimination tree of a graph under an order, in postorder, with the number of rows of every column of L.

#include <vector>

#include "fem/linear/block_graph.hpp"

namespace brachium::fem {

/// All vectors by position in a postorder that is equivalent to the order given (same fill).
struct EliminationTree {
  std::vector<int> vertex;  ///< vertex at a position
  std::vector<int> parent;  ///< position of the parent, -1: none
  std::vector<long> rows;   ///< unknowns in the rows of L of this vertex' columns, its own included
};

EliminationTree make_elimination_tree(const BlockGraph& graph, const std::vector<int>& order);

}  // namespace brachium::fem
