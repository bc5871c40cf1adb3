#pragma once
/// How a body leaves an unstable equilibrium: the mode that grows fastest when it may flow with the stress S
/// + 2 η Ė,
///   K x = μ V x   over motions x that keep the volume,  μ < 0 the least,
/// K the tangent, V that of the viscosity (η = the problem's stiffness x 1 s). Inverse iteration with K + s
/// V, where s > 0 is the least found (within a factor of 3) for which K + s V has no negative modes: then -μ
/// lies below s, and the wanted mode is the first that the iteration brings forth. (Saad 2011,
/// doi:10.1137/1.9781611970739, section 4.1)
///
/// Inverse iteration with K alone finds the eigenvalues next to 0, whatever their sign, and in a saddle point
/// those of pressures.

#include <optional>

#include "fem/solve/equations.hpp"
#include "fem/solve/tangent_factor.hpp"

namespace brachium::fem {

/// By unknown; largest displacement 1. Empty where no direction was found along which the energy falls.
/// Leaves a factor of the viscous tangent behind.
std::optional<Eigen::VectorXd> growing_mode(Equations& equations, TangentFactor& factor,
                                            const Configuration& equilibrium, const LoadPoint& load);

}  // namespace brachium::fem
