#pragma once
/// Vertices that are eliminated together: first those whose columns of L have the same rows, then those for
/// which the zeros stored by joining them cost less time than a front of their own.

#include <vector>

#include "fem/linear/elimination_tree.hpp"

namespace brachium::fem {

struct Supernode {
  std::vector<int> vertices;  ///< in the order of elimination; empty: joined to another
  long pivots = 0;            ///< unknowns of the vertices
  long updates = 0;           ///< unknowns in the rows below
  int parent = -1;            ///< a supernode of higher number
};

/// Supernodes without stored zeros, children before parents.
std::vector<Supernode> find_supernodes(const BlockGraph& graph, const EliminationTree& tree);

/// Joins supernodes to their parents where the model of the time of a front says that it pays.
std::vector<Supernode> amalgamate(std::vector<Supernode> nodes);

/// Modelled time of one front [s].
double front_seconds(double pivots, double updates);

}  // namespace brachium::fem
