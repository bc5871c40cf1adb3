#pragma once
/// Value of a force-velocity multiplier that may depend on the activation, f_v(v~, a).

namespace brachium::hill {

struct VelocityValue {
  double value = 0.0;             ///< f_v [1]
  double slope = 0.0;             ///< df_v/dv~ [1]
  double slope_activation = 0.0;  ///< df_v/da [1], zero for all sets but Thelen's
};

}  // namespace brachium::hill
