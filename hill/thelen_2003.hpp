#pragma once
/// Curves of Thelen 2003, doi:10.1115/1.1531112, as OpenSim's Thelen2003Muscle evaluates them.
///
///   f_l(x) = exp(-(x - 1)²/γ)                                                                           (eq.
///   4) f_p(x) = (exp(k_PE (x - 1)/e₀) - 1)/(exp(k_PE) - 1) for x > 1, else 0 (eq. 3) f_t(e) = F_toe
///   (exp(k_toe e/e_toe) - 1)/(exp(k_toe) - 1) for 0 < e <= e_toe, k_lin (e - e_toe) + F_toe beyond
///            F_toe = 0.33, k_toe = 3, e_toe = 99 e₁ e³/(166 e³ - 67) (the paper prints 0.609 e₁, rounded),
///            k_lin = 0.67/(e₁ - e_toe)                                                                  (eq.
///            5)
///
/// The force-velocity relation is published as v~(F, a) (eqs. 6, 7):
///   v~ = k (F - a f_l)/b, k = 0.25 + 0.75 a,
///   b = a f_l + F/A_f (shortening), b = (2 + 2/A_f)(a f_l F_len - F)/(F_len - 1) (lengthening)
/// Solved for F it is F = a f_l g(w), w = v~/k, so that f_v(v~, a) = g(v~/k) with
///   g = (1 + w)/(1 - w/A_f) for w <= 0,  g = (1 + c F_len)/(1 + c), c = w (2 + 2/A_f)/(F_len - 1) for w > 0.
/// g goes on linearly above 0.95 F_len, as in OpenSim. Below w = -1 (faster than unloaded shortening) we take
/// g = 0: a linear continuation as in OpenSim would let active fibres push.

#include <cmath>

#include "hill/curve_values.hpp"

namespace brachium::hill {

class Thelen2003 {
 public:
  static constexpr const char* kName = "thelen_2003";

  /// Defaults of the OpenSim class; arm26() gives those of OpenSim's arm26 model.
  struct Parameters {
    double active_width = 0.45;                ///< γ > 0
    double passive_shape = 5.0;                ///< k_PE > 0
    double passive_strain_at_one_force = 0.6;  ///< e₀ > 0
    double tendon_strain_at_one_force = 0.04;  ///< e₁ > 0
    double velocity_shape = 0.25;              ///< A_f > 0
    double max_lengthening_force = 1.4;        ///< F_len > 1
    double extrapolation_threshold =
        0.95;  ///< fraction of F_len where the linear continuation starts, in (1/F_len, 1)
  };
  static Parameters arm26() { return {0.5, 4.0, 0.6, 0.033, 0.3, 1.8, 0.95}; }

  Thelen2003() : Thelen2003(Parameters()) {}
  /// Throws InputError("bad-parameter").
  explicit Thelen2003(const Parameters& parameters);

  const char* name() const { return kName; }
  const Parameters& parameters() const { return p_; }

  data::CurveValue active(double x) const {
    const double s = x - 1.0;
    const double f = std::exp(-s * s * inverse_width_);
    return {f, -2.0 * s * inverse_width_ * f};
  }

  data::CurveValue passive(double x) const {
    if (x <= 1.0) return {0.0, 0.0};
    const double e = std::exp(passive_rate_ * (x - 1.0));
    return {(e - 1.0) * passive_scale_, passive_rate_ * e * passive_scale_};
  }

  VelocityValue velocity(double v, double a) const {
    const double k = 0.25 + 0.75 * a;
    const double w = v / k;
    const data::CurveValue g = scaled_velocity(w);
    return {g.value, g.slope / k, -0.75 * g.slope * w / k};
  }

  data::CurveValue tendon(double strain) const {
    if (strain <= 0.0) return {0.0, 0.0};
    if (strain > toe_strain_)
      return {tendon_stiffness_ * (strain - toe_strain_) + kToeForce, tendon_stiffness_};
    const double e = std::exp(toe_rate_ * strain);
    return {(e - 1.0) * toe_scale_, toe_rate_ * e * toe_scale_};
  }

  CurveDomains domains() const {
    return {{0.0, 2.0},
            {0.0, 1.0 + p_.passive_strain_at_one_force},
            {-1.0, 1.0},
            {0.0, 2.0 * p_.tendon_strain_at_one_force}};
  }

 private:
  static constexpr double kToeForce = 0.33, kToeShape = 3.0;

  /// g(w) and g'(w).
  data::CurveValue scaled_velocity(double w) const {
    if (w <= -1.0) return {0.0, 0.0};
    if (w <= 0.0) {
      const double d = 1.0 / (1.0 - w * inverse_af_);
      return {(1.0 + w) * d, (1.0 + inverse_af_) * d * d};
    }
    if (w > linear_from_) return {linear_.value + linear_.slope * (w - linear_from_), linear_.slope};
    const double d = 1.0 / (1.0 + lengthening_rate_ * w);
    return {(1.0 + lengthening_rate_ * w * p_.max_lengthening_force) * d,
            lengthening_rate_ * (p_.max_lengthening_force - 1.0) * d * d};
  }

  Parameters p_;
  double inverse_width_, passive_rate_, passive_scale_;
  double toe_strain_, toe_rate_, toe_scale_, tendon_stiffness_;
  double inverse_af_, lengthening_rate_, linear_from_;
  data::CurveValue linear_;
};

}  // namespace brachium::hill
