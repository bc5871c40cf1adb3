#pragma once
/// Saddle points: an unknown without stiffness of its own (a pressure) is eliminated after displacements that
/// it couples to, so that their Schur complement, -B K^-1 B', has given it a pivot.

#include <vector>

#include "fem/linear/block_graph.hpp"

namespace brachium::fem {

/// Moves every constraint vertex behind half of the neighbours that it couples to, in the order of
/// elimination; the other vertices keep their order. Nothing happens to a graph without constraints.
void move_constraints(const BlockGraph& graph, std::vector<int>& order);

}  // namespace brachium::fem
