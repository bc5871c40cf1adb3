#pragma once
/// What a material law is asked at one quadrature point, and what it answers. T is double, or `Lanes`, which
/// hold the same point of four cells (fem/material/lanes.inc).
///
/// Symmetric tensors have six components in the order 11 22 33 12 23 13 (tensor components, no factors of 2).
///
/// | symbol   | identifier     | unit | meaning                                                             |
/// |----------|----------------|------|---------------------------------------------------------------------|
/// | C        | C              | 1    | right Cauchy-Green tensor F'F                                       |
/// | a0       | fibre          | 1    | unit fibre direction, reference placement                           |
/// | alpha    | activation     | 1    | in [0, 1]                                                           |
/// | gamma_M  | muscle         | 1    | 1 muscle, 0 tendon                                                  |
/// | gamma_ST | soft_tissue    | 1    | 1 fat or other isotropic tissue, 0 fibres                           |
/// | lambda_n | stretch_before | 1    | fibre stretch at the last accepted state                            |
/// | 1/dt     | inverse_dt     | 1/s  | 0: no rate dependence                                               |
/// | W        | energy         | J/m3 | stored energy per reference volume, without the volumetric part     |
/// | S        | S              | Pa   | second Piola-Kirchhoff stress 2 dW/dC                               |
/// | CC       | CC             | Pa   | 2 dS/dC, upper triangle by rows, entry (i, j) at upper(i, j)        |
///
/// CC_(ij)(kl) are tensor components too: dS_ij = sum over all nine (k, l) of CC_ijkl dE_kl, E = (C - 1)/2.

namespace brachium::fem {

typedef double Lanes __attribute__((vector_size(32)));  ///< one value for each of four points
typedef long long LaneMask __attribute__((vector_size(32)));

/// What a law computes beside the stress, as bits: laws.inc leaves out what is not wanted.
enum Wanted : int { stress_only = 0, with_tangent = 1, with_energy = 2, everything = 3 };

template <class T>
struct MaterialPoint {
  T C[6];
  T fibre[3];
  T activation;
  T muscle;
  T soft_tissue;
  T stretch_before;
  double inverse_dt = 0.0;
};

/// Parts that were not wanted are left as they were.
template <class T>
struct MaterialResponse {
  T energy;
  T S[6];
  T CC[21];
};

/// Index into the upper triangle of a symmetric 6 x 6 matrix, i <= j.
constexpr int upper(int i, int j) {
  return i * 6 - i * (i - 1) / 2 + (j - i);
}

}  // namespace brachium::fem
