#pragma once
/// Nodes that a name stands for.

#include <string>
#include <vector>

#include "data/model/mesh.hpp"

namespace brachium::fem {

/// Points of a node set or of a surface, each once. Throws InputError("missing-surface").
std::vector<int> surface_nodes(const data::Mesh& mesh, const std::string& name);

}  // namespace brachium::fem
