#pragma once
/// Four cells side by side in the lanes of a vector: what a kernel is given and what it returns. Plain memory, so that
/// the same declarations serve every instruction set.
///
/// | symbol    | identifier     | unit | meaning                                                       | size                |
/// |-----------|----------------|------|---------------------------------------------------------------|---------------------|
/// | G         | gradient       | 1/m  | dN_a/dX_J at quadrature points, nodes padded to 4             | n_q n_pad 3         |
/// | w         | weight         | m3   | quadrature weight times det dX/dxi                            | n_q                 |
/// | u         | displacement   | m    | of the cells' nodes                                           | n_pad 3             |
/// | phi       | pressure_shape | 1    | pressure functions                                            | n_q n_p             |
/// | M^-1      | mass_inverse   | 1/m3 | inverse of int phi_m phi_n dV                                 | n_p n_p             |
/// | lambda, p | pressure       | Pa   | multiplier (discontinuous) or pressure dofs (continuous)      | n_p                 |
/// | f         | force          | N    | int P : grad N_a                                              | n_pad 3             |
/// | f_p       | constraint     | m3   | int phi (J - 1 - p / k) (continuous pressure)                 | n_p                 |
/// | K         | tangent        | N/m  | d f_a / d u_b, a >= b: block a (a+1)/2 + b, entries 3 i + k    | n_pad (n_pad+1)/2 9 |
/// | B         | coupling       | m2   | d f_p / d u_b, as 3 b + k (continuous pressure)               | n_p n_pad 3         |

#include "fem/material/material.hpp"

namespace brachium::fem {

inline constexpr int lanes = 4;

/// A vector of lanes as memory; 32-byte aligned.
struct alignas(32) LaneBlock {
  double lane[lanes];
};

/// How a region resists change of volume, as the kernel needs it.
struct KernelVolume {
  enum class Pressure { none, discontinuous, continuous };
  Pressure pressure = Pressure::none;
  VolumetricLaw law = VolumetricLaw::quadratic;
  double modulus = 0.0;  ///< k of U(J) [Pa]; with continuous pressures unused where `inverse_modulus` is 0
  double inverse_modulus = 0.0;  ///< 1/k, continuous pressures; 0: exactly incompressible
};

struct KernelInput {
  int nodes = 0, padded_nodes = 0, points = 0, pressures = 0;
  const LaneBlock* gradient = nullptr;
  const LaneBlock* weight = nullptr;
  const LaneBlock* displacement = nullptr;
  const LaneBlock* displacement_before = nullptr;  ///< null: no rates
  const LaneBlock* fibre = nullptr;                ///< n_q 3
  const LaneBlock* muscle = nullptr;               ///< n_q
  const LaneBlock* soft_tissue = nullptr;          ///< n_q
  const LaneBlock* pressure_shape = nullptr;
  const LaneBlock* mass_inverse = nullptr;
  const LaneBlock* pressure = nullptr;
  double activation = 0.0;
  double inverse_dt = 0.0;
  double viscosity = 0.0;  ///< [Pa s]
  const Material* material = nullptr;
  KernelVolume volume;
};

/// Memory a kernel works in, of the sizes that kernel_scratch() gives.
struct KernelOutput {
  LaneBlock* force = nullptr;
  LaneBlock* constraint = nullptr;
  bool with_energy = false;      ///< not together with the tangent
  LaneBlock* tangent = nullptr;  ///< null: residual only
  LaneBlock* coupling = nullptr;
  LaneBlock* constraint_mass = nullptr;  ///< n_p n_p: int phi_m phi_n / k (continuous, finite k)
  LaneBlock* cell_pressure = nullptr;    ///< n_p: p of discontinuous pressures, multiplier included
  LaneBlock* scratch = nullptr;
  LaneBlock energy, volume, worst_volume, smallest_jacobian;
};

/// Blocks of scratch memory for the sizes of `input`.
std::size_t kernel_scratch_size(const KernelInput& input);

/// Internal forces, and the tangent where output.tangent is given. If a Jacobian is not positive in some
/// lane, only `smallest_jacobian` is valid afterwards.
using Kernel = void (*)(const KernelInput&, KernelOutput&);

/// The kernel for this machine's instruction set; `portable` asks for the one without extensions.
Kernel choose_kernel(bool portable = false);
const char* kernel_name(Kernel kernel);

}  // namespace brachium::fem
