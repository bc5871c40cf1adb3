#pragma once
/// Parameters of the material laws: plain values in SI units. Nothing has a default that could pass for a
/// material: what is not given is NaN and refused by check() (fem/material/material.hpp). Named sets:
/// fem/material/parameter_sets.hpp. The formulas are in fem/material/laws.inc.

#include <limits>

namespace brachium::fem {

constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

// ---------------------------------------------------------------- muscle and tendon

/// One tissue of a muscle-tendon complex: isotropic ground c1 (I1 - 3) + c2 (I2 - 3), fibres that bear
/// tension only, nominal stress c3/lambda (lambda^c4 - 1) for lambda >= 1.
struct FibrousTissue {
  double c1_pa = not_given;  ///< >= 0, c1 + c2 > 0
  double c2_pa = not_given;  ///< >= 0
  double c3_pa = not_given;  ///< >= 0
  double c4 = not_given;     ///< [1, 200]
};

/// Active force-length multiplier, a bell with flanks of its own on both sides (Günther, Schmitt & Wank 2007,
/// doi:10.1007/s00422-007-0160-6):  f_l = exp(-|(lambda/lambda_opt - 1)/dW|^nu).
struct ForceLength {
  double optimal_stretch = not_given;      ///< lambda_opt, (0, 10]
  double ascending_width = not_given;      ///< dW where lambda <= lambda_opt, > 0
  double ascending_exponent = not_given;   ///< nu there, [1.2, 10]
  double descending_width = not_given;     ///< dW where lambda > lambda_opt, > 0
  double descending_exponent = not_given;  ///< nu there, [1.2, 10]
};

/// Active force-velocity multiplier over the fibre's rate of stretch v = (d lambda/dt)/(v_max lambda_opt),
/// lengthening positive:
///   v <= -1      f_v = 0
///   -1 < v <= 0  f_v = (1 + v)/(1 - v/k)                    Hill 1938, doi:10.1098/rspb.1938.0050, k = a/F0
///   v > 0        f_v = 1 + (e - 1) v/(v + (e - 1)/s)        s = 1 + 1/k, the slope from the left
/// The eccentric branch is a hyperbola that tends to e, as in van Soest & Bobbert 1993,
/// doi:10.1007/BF00198959, who make its slope at 0 twice the concentric one; here the slope is continuous, so
/// that Newton's tangent is.
struct ForceVelocity {
  double max_rate_per_s = not_given;   ///< v_max, optimal lengths a second, > 0
  double curvature = not_given;        ///< k, > 0 (Hill's a/F0, about 0.25)
  double eccentric_force = not_given;  ///< e, > 1 (about 1.5)
};

/// How muscle and tendon blend where 0 < gamma_M < 1.
enum class Blending {
  energies,   ///< W = gamma_M W_muscle + (1 - gamma_M) W_tendon
  parameters  ///< c = gamma_M c_muscle + (1 - gamma_M) c_tendon for c1 .. c4: stiffer than tendon in between
};

/// What sigma_max is: S_active = sigma_max f_l/lambda^n a0 x a0.
enum class ActiveStress {
  nominal,  ///< n = 1
  cauchy    ///< n = 2
};

/// Muscle-tendon complex, nomenclature of Valentin 2019 (ch. 7), stress-free at rest.
struct MuscleTendon {
  FibrousTissue muscle;
  FibrousTissue tendon;
  double max_stress_pa = not_given;  ///< sigma_max, >= 0
  ForceLength force_length;
  Blending blending = Blending::energies;
  ActiveStress active_stress = ActiveStress::nominal;
  bool rate_dependent = false;   ///< multiply the active stress by f_v where the point has inverse_dt > 0
  ForceVelocity force_velocity;  ///< read only if rate_dependent
};

// ---------------------------------------------------------------- isotropic

/// W = mu/2 (I1 - 3) - mu ln J, or with `isochoric` mu/2 (J^(-2/3) I1 - 3).
struct NeoHooke {
  double shear_modulus_pa = not_given;  ///< mu > 0
  bool isochoric = false;
};

/// W = c10 (I1 - 3) + c01 (I2 - 3) - (2 c10 + 4 c01) ln J, or with `isochoric` c10 (J^(-2/3) I1 - 3) +
/// c01 (J^(-4/3) I2 - 3). Shear modulus at rest 2 (c10 + c01).
struct MooneyRivlin {
  double c10_pa = not_given;  ///< >= 0, c10 + c01 > 0
  double c01_pa = not_given;  ///< >= 0
  bool isochoric = false;
};

// ---------------------------------------------------------------- transversely isotropic

/// W = C/2 (exp Q - 1), Q = bf E_ff^2 + bt (E_ss^2 + E_nn^2 + 2 E_sn^2) + 2 bfs (E_fs^2 + E_fn^2), f along a0
/// (Guccione, McCulloch & Waldman 1991, doi:10.1115/1.2894084; Land et al. 2015, doi:10.1098/rspa.2015.0641),
/// of E = (C - 1)/2 or with `isochoric` of (J^(-2/3) C - 1)/2.
struct FungGuccione {
  double stiffness_pa = not_given;  ///< C > 0
  double bf = not_given;            ///< > 0
  double bt = not_given;            ///< > 0
  double bfs = not_given;           ///< > 0
  bool isochoric = false;
};

/// Muscle of Blemker, Pinsky & Delp 2005, doi:10.1016/j.jbiomech.2004.04.009, as FEBio's "muscle material"
/// has it: all of J^(-2/3) C. Along-fibre and cross-fibre shear, fibres with passive and active stress.
struct BlemkerMuscle {
  double along_fibre_shear_pa = not_given;   ///< G1 >= 0
  double cross_fibre_shear_pa = not_given;   ///< G2 > 0
  double passive_coefficient = not_given;    ///< P1 >= 0
  double passive_exponent = not_given;       ///< P2 > 0
  double optimal_stretch = not_given;        ///< Lofl > 0
  double max_stress_pa = not_given;          ///< sigma_max >= 0
  double straightening_stretch = not_given;  ///< lambda_max > Lofl: passive stress is linear above
};

}  // namespace brachium::fem
