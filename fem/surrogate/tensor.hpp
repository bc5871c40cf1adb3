#pragma once
/// Surrogates on a full grid of angles and activations: splines through values, and Hermite interpolation
/// with the exact derivatives that each state gives from its last factorisation.

#include "fem/surrogate/surrogate.hpp"

namespace brachium::fem {

enum class ThetaCurve {
  linear,    ///< continuous only
  monotone,  ///< once differentiable, no overshoot between states (piecewise.hpp)
  cubic,     ///< twice differentiable
  quintic    ///< four times differentiable
};
enum class AlphaCurve { linear, cubic, quintic };

struct TensorOptions {
  ThetaCurve theta = ThetaCurve::cubic;
  AlphaCurve alpha = AlphaCurve::cubic;
  bool estimate_error = true;
};

/// Tensor spline through the values, F = Σ_ij c_ij B_i(θ) B_j(α). With n <= degree nodes in a direction the
/// polynomial of degree n - 1 there; `method` says the degrees. Reproduces polynomials of its degree in each
/// variable.
Surrogate tensor_spline(const SampleGrid& grid, const TensorOptions& options = {});

enum class HermiteDegree {
  cubic = 3,  ///< once differentiable, error h^4
  quintic =
      5  ///< twice differentiable, and more inside; error h^6 in θ and α, h^2 times that of d²F/dθ dα mixed
};

struct HermiteOptions {
  HermiteDegree degree = HermiteDegree::quintic;
  bool estimate_error = true;
};

/// Tensor Hermite interpolation of F, dF/dθ, dF/dα. The mixed derivative at the states, which no state gives,
/// is the mean of the slopes over α of splines through dF/dθ and over θ of those through dF/dα, of degree 5
/// (less with fewer nodes). Throws InputError("missing-derivative") naming the first state without.
Surrogate hermite_surrogate(const SampleGrid& grid, const HermiteOptions& options = {});

/// Samples with slopes at every state: of outputs whose derivatives are known, those; of the others, the
/// slopes of the spline (of degree 5 where there are nodes enough) through their values. `known` holds some
/// of the outputs, at the same states. Throws InputError as as_grid, "missing-derivative" where `known` has
/// none, "unknown-output".
SampleSet with_spline_slopes(const SampleSet& values, const SampleSet& known);

}  // namespace brachium::fem
