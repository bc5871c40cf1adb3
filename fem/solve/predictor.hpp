#pragma once
/// Where the body will be at the next load point, from the last factor and one back-substitution.
///
///   v = ( R(u_n + δ Δu_held, loads + δ Δloads) - R(u_n, loads) ) / δ,   K Δu = -v,   u = u_n + Δu,   δ =
///   1e-4
/// Held components and activations move with the loads, so that v has the forces of all of them. Pressures of
/// condensed formulations are kept in v; their change Δp = (U'(θ)(u_n + δ Δu_held) - U'(θ)(u_n))/δ goes
/// through the factor's own coupling (tangent_factor.hpp). With the state before, u_(n-1) = u_n - w τ + c τ^2
/// over its step τ (w = Δu/h) gives a second-order prediction u_n + w h + c h^2.

#include "fem/solve/equations.hpp"
#include "fem/solve/tangent_factor.hpp"

namespace brachium::fem {

/// Moves `configuration` from the converged state at `from` to the prediction at `to`, held components
/// imposed, and gives the pressures of condensed formulations there (linear in the move). False (and unmoved)
/// when a residual could not be evaluated.
bool predict(Equations& equations, TangentFactor& factor, const LoadPoint& from, const LoadPoint& to,
             Configuration& configuration, Eigen::MatrixXd& pressure);

/// Adds the second-order term: `first` is the prediction above, `ratio` = h/τ.
Eigen::VectorXd extrapolate(const Eigen::VectorXd& before, const Eigen::VectorXd& now,
                            const Eigen::VectorXd& first, double ratio);

}  // namespace brachium::fem
