#pragma once
/// The contractile and parallel elements of one muscle at one instant, with every partial derivative.
///
///   N(l, v~, a) = a f_l(l/(l_opt κ)) f_v(v~, a) + f_p(l/l_opt) + d v~,   κ = 1 + p (1 - a)
///   Q(z, w, a)  = c N,   l = √(h² + z²), c = z/l, v~ = c w/V
///
/// | symbol | identifier | unit | meaning                                                            |
/// |--------|------------|------|--------------------------------------------------------------------|
/// | z      | z          | m    | fibre length projected on the tendon, l cos(phi)                   |
/// | w      | w          | m/s  | dz/dt; the fibre's own rate is l' = c w (constant thickness)       |
/// | h      | h          | m    | muscle thickness, l_opt sin(phi_opt)                               |
/// | c      | c          | 1    | cos(phi)                                                           |
/// | V      | V          | m/s  | v_max l_opt                                                        |
/// | S      | S          | N    | F0 strength                                                        |
/// | N, Q   | N, Q       | 1    | normalised force along the fibre, along the tendon                 |

#include <array>
#include <cmath>

#include "hill/forward.hpp"
#include "hill/muscle_tendon.hpp"

namespace brachium::hill {

inline constexpr std::size_t kParameterCount = 7;
inline std::size_t index_of(MuscleParameter p) {
  return static_cast<std::size_t>(p);
}

/// Shortest projection of the fibres on the tendon that is taken as physical, in optimal fibre lengths.
inline constexpr double kShortestProjection = 0.01;

/// The constants of one muscle, as the inner loops want them.
struct ElementConstants {
  double S, lo, ls, h, sin_opt, cos_opt, V, vmax, damping, coupling, z_min;
  double per_lo, per_ls, per_V;  // reciprocals
  bool with_velocity;

  explicit ElementConstants(const MuscleTendon& muscle) {
    const data::MuscleParameters& p = muscle.parameters();
    S = p.max_isometric_force_N * p.strength;
    lo = p.optimal_fibre_length_m;
    ls = p.tendon_slack_length_m;
    sin_opt = std::sin(p.pennation_at_optimal_rad);
    cos_opt = std::cos(p.pennation_at_optimal_rad);
    h = lo * sin_opt;
    vmax = p.max_contraction_velocity;
    V = vmax * lo;
    damping = p.fibre_damping;
    coupling = muscle.options().optimal_length_coupling;
    z_min = kShortestProjection * lo;
    per_lo = 1.0 / lo;
    per_ls = ls > 0.0 ? 1.0 / ls : 0.0;
    per_V = 1.0 / V;
    with_velocity = muscle.options().velocity != FibreVelocity::none;
  }
};

/// N and its derivatives at one instant.
struct FibreForce {
  double N, N_l, N_v, N_a;
  double active, passive, fv;  ///< a f_l f_v, f_p, f_v
  double x, xa;                ///< l/l_opt, l/(l_opt κ)
  double active_slope;         ///< a f_v df_l/dx_a
  double passive_slope;        ///< df_p/dx

  /// dN/dl_opt at constant l and v~.
  double N_lo(double lo) const { return -(active_slope * xa + passive_slope * x) / lo; }
};

template <class Set>
inline FibreForce fibre_force(const Set& set, const ElementConstants& k, double l, double vn, double a) {
  FibreForce f;
  const double per_kappa = k.coupling == 0.0 ? 1.0 : 1.0 / (1.0 + k.coupling * (1.0 - a));
  f.x = l * k.per_lo;
  f.xa = f.x * per_kappa;
  const data::CurveValue fl = set.active(f.xa);
  const data::CurveValue fp = set.passive(f.x);
  VelocityValue fv{1.0, 0.0, 0.0};
  double damping = 0.0;
  if (k.with_velocity) {
    fv = set.velocity(vn, a);
    damping = k.damping;
  }
  f.fv = fv.value;
  f.active = a * fl.value * fv.value;
  f.passive = fp.value;
  f.active_slope = a * fv.value * fl.slope;
  f.passive_slope = fp.slope;
  f.N = f.active + f.passive + damping * vn;
  f.N_l = (f.active_slope * per_kappa + f.passive_slope) * k.per_lo;
  f.N_v = a * fl.value * fv.slope + damping;
  f.N_a = fl.value * (fv.value + a * fv.slope_activation) + f.active_slope * f.xa * k.coupling * per_kappa;
  return f;
}

/// Q and its derivatives at one instant.
struct Projected {
  FibreForce fibre;
  double l, c, vn;
  double Q, Q_z, Q_w, Q_a;
};

template <class Set>
inline Projected project(const Set& set, const ElementConstants& k, double z, double w, double a) {
  Projected q;
  double c_z = 0.0;
  if (k.h == 0.0) {
    q.l = z;
    q.c = 1.0;
  } else {
    q.l = std::sqrt(k.h * k.h + z * z);
    const double per_l = 1.0 / q.l;
    q.c = z * per_l;
    c_z = (1.0 - q.c * q.c) * per_l;
  }
  const double rate = w * k.per_V;
  q.vn = k.with_velocity ? q.c * rate : 0.0;
  q.fibre = fibre_force(set, k, q.l, q.vn, a);
  const FibreForce& f = q.fibre;
  q.Q = q.c * f.N;
  q.Q_z = c_z * (f.N + (k.with_velocity ? q.c * f.N_v * rate : 0.0)) + q.c * q.c * f.N_l;
  q.Q_w = q.c * q.c * f.N_v * k.per_V;
  q.Q_a = q.c * f.N_a;
  if (!k.with_velocity) q.Q_w = 0.0;
  return q;
}

/// dQ/dparameter at constant z, w and a.
inline double dQ(const Projected& q, const ElementConstants& k, double w, MuscleParameter parameter) {
  const FibreForce& f = q.fibre;
  const double N_v = k.with_velocity ? f.N_v : 0.0;
  const double sine = k.h / q.l;
  // Through the thickness: l_h = sin, c_h = -c sin/l, v_h = c_h w/V.
  const double Q_h = -q.c * sine / q.l * (f.N + q.c * N_v * w / k.V) + q.c * f.N_l * sine;
  switch (parameter) {
    case MuscleParameter::optimal_fibre_length:
      return Q_h * k.sin_opt + q.c * (f.N_lo(k.lo) - N_v * q.vn / k.lo);
    case MuscleParameter::pennation:
      return Q_h * k.lo * k.cos_opt;
    case MuscleParameter::max_contraction_velocity:
      return -q.c * N_v * q.vn / k.vmax;
    case MuscleParameter::fibre_damping:
      return q.c * q.vn;
    default:
      return 0.0;
  }
}

}  // namespace brachium::hill
