#pragma once
/// The pattern of a matrix by blocks: unknowns that share their adjacency become one vertex, so that ordering
/// and symbolic factorisation work on a graph a third of the size with a ninth of the edges.

#include <mutex>
#include <string>
#include <vector>

#include "fem/linear/symmetric_pattern.hpp"
#include "fem/linear/symmetric_solver.hpp"

namespace brachium::fem {

/// Undirected graph without loops. Vertices count from 0 in the order of their first unknown.
struct BlockGraph {
  std::vector<int> first_unknown;     ///< vertices + 1 entries, into `unknown`
  std::vector<int> unknown;           ///< unknowns of a vertex, ascending
  std::vector<int> vertex_of;         ///< vertex of each unknown
  std::vector<char> constraint;       ///< 1: the vertex's unknowns have no stiffness of their own
  std::vector<int> start, neighbour;  ///< neighbours of a vertex, ascending

  int vertices() const { return static_cast<int>(first_unknown.size()) - 1; }
  int size(int vertex) const { return first_unknown[vertex + 1] - first_unknown[vertex]; }
};

/// Vertices are the labels of `groups`; edges of any unknown of a block count for the block.
BlockGraph make_block_graph(const SymmetricPattern& pattern, const UnknownGroups& groups);

struct BlockOrder {
  std::vector<int> position_to_vertex;
  std::string name;  ///< "METIS" or "AMD"
};

/// Order of elimination of the vertices. METIS (Karypis & Kumar 1998, doi:10.1137/S1064827595287997): nested
/// dissection, the better of two separators each time, parts up to 10 % out of balance; AMD of SuiteSparse
/// (Amestoy, Davis & Duff 2004, doi:10.1145/1024074.1024081). The same for the same graph, whatever else the
/// process does.
BlockOrder order(const BlockGraph& graph, Ordering ordering);

/// METIS draws its random numbers from one generator for the whole process and sets its seed when it starts:
/// who calls it, directly or through SuiteSparse, holds this.
std::mutex& metis_mutex();

}  // namespace brachium::fem
