#pragma once
/// Rigid motions of a body that its supports leave free, by name.
///
/// u = t + ω × (x - c) is held by d . u = 0 at x where d . t + ω . ((x - c) × d) = 0: the free motions are
/// the null space of these rows over (t, ω).

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/solve/holds.hpp"

namespace brachium::fem {

/// "translation along x", "rotation about the axis along (0.6, 0.8, 0) through (0.01, 0, 0) m"; empty when
/// held. `nodes` are the part's points, `holds` those on them.
std::vector<std::string> free_motions(const data::Mesh& mesh, const std::vector<int>& nodes,
                                      const std::vector<Hold>& holds);

}  // namespace brachium::fem
