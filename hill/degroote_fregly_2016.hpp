#pragma once
/// Smooth curves for direct collocation, De Groote, Kinney, Rao & Fregly 2016, doi:10.1007/s10439-016-1591-9,
/// supplement, with the constants of its implementation in OpenSim (DeGrooteFregly2016Muscle).
///
///   f_l(x) = Σᵢ b₁ᵢ exp(-½ (x - b₂ᵢ)² / (b₃ᵢ + b₄ᵢ x)²)
///            erratum: the supplement prints the denominator without its square
///   f_p(x) = (exp(k_P (x - 1)/e₀) - exp(k_P (x_min - 1)/e₀)) / (exp(k_P) - exp(k_P (x_min - 1)/e₀)), x_min =
///   0.2 f_v(v) = d₁ ln((d₂ v + d₃) + √((d₂ v + d₃)² + 1)) + d₄ f_t(e) = c₁ exp(k_T (1 + e - c₂)) - c₃, k_T =
///   ln((1 + c₃)/c₁)/e₁
///
/// | symbol | identifier   | unit | meaning                                   |
/// |--------|--------------|------|-------------------------------------------|
/// | e₀     | passive_strain_at_one_force | 1 | fibre strain at f_p = 1    |
/// | k_P    | passive_stiffness           | 1 | exponential shape of f_p   |
/// | e₁     | tendon_strain_at_one_force  | 1 | tendon strain at f_t = 1   |

#include <cmath>

#include "hill/curve_values.hpp"

namespace brachium::hill {

class DeGrooteFregly2016 {
 public:
  static constexpr const char* kName = "degroote_fregly_2016";

  struct Parameters {
    double passive_strain_at_one_force = 0.6;   ///< > 0
    double passive_stiffness = 4.0;             ///< > 0
    double tendon_strain_at_one_force = 0.049;  ///< > 0
  };

  DeGrooteFregly2016() : DeGrooteFregly2016(Parameters()) {}
  /// Throws InputError("bad-parameter").
  explicit DeGrooteFregly2016(const Parameters& parameters);

  const char* name() const { return kName; }

  data::CurveValue active(double x) const {
    data::CurveValue f;
    for (const Gauss& g : kGauss) {
      const double width = g.b3 + g.b4 * x;
      const double s = (x - g.b2) / width;
      const double term = g.b1 * std::exp(-0.5 * s * s);
      f.value += term;
      f.slope -= term * s * (1.0 - s * g.b4) / width;
    }
    return f;
  }

  data::CurveValue passive(double x) const {
    const double e = std::exp(passive_rate_ * (x - 1.0));
    return {(e - passive_offset_) * passive_scale_, passive_rate_ * e * passive_scale_};
  }

  VelocityValue velocity(double v, double) const {
    const double s = kD2 * v + kD3;
    const double root = std::sqrt(s * s + 1.0);
    return {kD1 * std::log(s + root) + kD4, kD1 * kD2 / root, 0.0};
  }

  data::CurveValue tendon(double strain) const {
    const double e = kC1 * std::exp(tendon_rate_ * (1.0 + strain - kC2));
    return {e - kC3, tendon_rate_ * e};
  }

  /// Active: where the third width stays positive; the first term's width would vanish at x < -2.5.
  CurveDomains domains() const { return {{0.2, 1.8}, {0.2, 1.8}, {-1.0, 1.0}, {0.0, 0.2}}; }

 private:
  struct Gauss {
    double b1, b2, b3, b4;
  };
  static constexpr Gauss kGauss[3] = {
      {0.8150671134243542, 1.055033428970575, 0.162384573599574, 0.063303448465465},
      {0.433004984392647, 0.716775413397760, -0.029947116970696, 0.200356847296188},
      {0.1, 1.0, 0.353553390593274, 0.0}};
  static constexpr double kD1 = -0.3211346127989808, kD2 = -8.149, kD3 = -0.374, kD4 = 0.8825327733249912;
  static constexpr double kC1 = 0.2, kC2 = 1.0, kC3 = 0.2;
  static constexpr double kMinimumFibre = 0.2;

  double passive_rate_, passive_offset_, passive_scale_, tendon_rate_;
};

}  // namespace brachium::hill
