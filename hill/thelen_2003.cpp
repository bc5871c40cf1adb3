#include "hill/thelen_2003.hpp"

#include "hill/parameter_check.hpp"

namespace brachium::hill {

Thelen2003::Thelen2003(const Parameters& p) : p_(p) {
  ParameterCheck check("curve set `thelen_2003`");
  check.require(p.active_width > 0, "active_width", p.active_width, "positive");
  check.require(p.passive_shape > 0, "passive_shape", p.passive_shape, "positive");
  check.require(p.passive_strain_at_one_force > 0, "passive_strain_at_one_force",
                p.passive_strain_at_one_force, "positive");
  check.require(p.tendon_strain_at_one_force > 0, "tendon_strain_at_one_force", p.tendon_strain_at_one_force,
                "positive");
  check.require(p.velocity_shape > 0, "velocity_shape", p.velocity_shape, "positive");
  check.require(p.max_lengthening_force > 1, "max_lengthening_force", p.max_lengthening_force, "above 1");
  check.require(p.extrapolation_threshold * p.max_lengthening_force > 1 && p.extrapolation_threshold < 1,
                "extrapolation_threshold", p.extrapolation_threshold,
                "above 1/max_lengthening_force and below 1");
  check.finish();

  inverse_width_ = 1.0 / p.active_width;
  passive_rate_ = p.passive_shape / p.passive_strain_at_one_force;
  passive_scale_ = 1.0 / (std::exp(p.passive_shape) - 1.0);

  const double e3 = std::exp(kToeShape);
  toe_strain_ = 99.0 * p.tendon_strain_at_one_force * e3 / (166.0 * e3 - 67.0);
  toe_rate_ = kToeShape / toe_strain_;
  toe_scale_ = kToeForce / (e3 - 1.0);
  tendon_stiffness_ = 0.67 / (p.tendon_strain_at_one_force - toe_strain_);

  inverse_af_ = 1.0 / p.velocity_shape;
  lengthening_rate_ = (2.0 + 2.0 * inverse_af_) / (p.max_lengthening_force - 1.0);
  // g(w) = threshold F_len, solved for w.
  const double g = p.extrapolation_threshold * p.max_lengthening_force;
  linear_from_ = (g - 1.0) / (lengthening_rate_ * (p.max_lengthening_force - g));
  const double d = 1.0 / (1.0 + lengthening_rate_ * linear_from_);
  linear_ = {g, lengthening_rate_ * (p.max_lengthening_force - 1.0) * d * d};
}

}  // namespace brachium::hill
