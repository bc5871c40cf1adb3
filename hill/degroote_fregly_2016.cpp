#include "hill/degroote_fregly_2016.hpp"

#include "hill/parameter_check.hpp"

namespace brachium::hill {

DeGrooteFregly2016::DeGrooteFregly2016(const Parameters& p) {
  ParameterCheck check("curve set `degroote_fregly_2016`");
  check.require(p.passive_strain_at_one_force > 0, "passive_strain_at_one_force",
                p.passive_strain_at_one_force, "positive");
  check.require(p.passive_stiffness > 0, "passive_stiffness", p.passive_stiffness, "positive");
  check.require(p.tendon_strain_at_one_force > 0, "tendon_strain_at_one_force", p.tendon_strain_at_one_force,
                "positive");
  check.finish();
  passive_rate_ = p.passive_stiffness / p.passive_strain_at_one_force;
  passive_offset_ = std::exp(passive_rate_ * (kMinimumFibre - 1.0));
  passive_scale_ = 1.0 / (std::exp(p.passive_stiffness) - passive_offset_);
  tendon_rate_ = std::log((1.0 + kC3) / kC1) / p.tendon_strain_at_one_force;
}

}  // namespace brachium::hill
