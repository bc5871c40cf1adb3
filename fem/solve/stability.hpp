#pragma once
/// Whether an equilibrium is stable: the number of negative eigenvalues of its tangent (Sylvester's law of
/// inertia, by the signs of the pivots), less those that the pressures of a saddle point bring.
///
/// With multipliers the tangent is that of the augmented Lagrangian: for a large penalty it has as many
/// negative modes as the exactly incompressible body (Nocedal & Wright 2006, doi:10.1007/978-0-387-40065-5,
/// theorem 17.5). Where loads make the tangent unsymmetric, a positive definite symmetric part means stable;
/// otherwise nothing is said.

#include "fem/solve/equations.hpp"
#include "fem/solve/tangent_factor.hpp"

namespace brachium::fem {

/// The factor at hand serves where it was made within 1e-3 of a cell's size of the state, under the same
/// loads; else the tangent is factorised again at the state. The method says which.
Stability check_stability(Equations& equations, TangentFactor& factor, const SolveOptions& options,
                          Configuration& configuration, const LoadPoint& load);

}  // namespace brachium::fem
