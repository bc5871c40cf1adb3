#pragma once
/// Symbolic factorisation: which unknowns are eliminated together (the pivots of a front), which rows their
/// elimination touches, and into which front the remainder goes.
///
/// Sources: elimination tree and column counts, Liu 1990, doi:10.1137/0611010; supernodes and their
/// amalgamation, Ashcraft & Grimes 1989, doi:10.1145/76909.76910; order of the children for little memory,
/// Liu 1986, doi:10.1145/7921.11325.

#include <vector>

#include "fem/linear/block_graph.hpp"

namespace brachium::fem {

struct Front {
  int first = 0;               ///< position of the first pivot in the order of elimination
  int pivots = 0;              ///< w
  int updates = 0;             ///< u: rows below the pivots, whose Schur complement goes to the parent
  int parent = -1;             ///< a later front; -1: none
  long long row_start = 0;     ///< into AssemblyTree::row: positions of the u rows, ascending
  long long factor_start = 0;  ///< into the factor: rows of L, see DenseFront::packed_l

  int size() const { return pivots + updates; }
};

struct AssemblyTree {
  std::vector<int> unknown_at;   ///< unknown of a position in the order of elimination
  std::vector<int> position_of;  ///< position of an unknown
  std::vector<Front> fronts;     ///< children before parents, each subtree contiguous
  std::vector<int> row;
  std::vector<int> child_start, child;  ///< children of a front, ascending
  /// Place of each update row inside the parent's front (0 ... w + u of the parent), alongside `row`.
  std::vector<int> row_in_parent;
  long long stored_entries = 0;  ///< values stored for L, with what fills it up to whole panels
  long long factor_entries = 0;  ///< entries of L on and below the diagonal
  double flops = 0.0;            ///< Σ (rows of a column of L)^2
};

/// Multiplications and additions to eliminate w pivots of a front with u update rows, Σ_{k=1}^{w} (u + k)^2.
double front_flops(double pivots, double updates);

/// `order`: vertices of the graph in the order of elimination. Constraint vertices are moved behind
/// neighbours that they couple to, see move_constraints.
AssemblyTree make_assembly_tree(const BlockGraph& graph, std::vector<int> order);

}  // namespace brachium::fem
