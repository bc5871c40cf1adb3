#pragma once
/// What every curve set hands back besides data::CurveValue.

#include "data/model/curve.hpp"

namespace brachium::hill {

/// A force-velocity multiplier that may depend on the activation, f_v(v~, a).
struct VelocityValue {
  double value = 0.0;             ///< f_v [1]
  double slope = 0.0;             ///< df_v/dv~ [1]
  double slope_activation = 0.0;  ///< df_v/da [1], zero for all sets but Thelen's
};

/// Where each curve of a set is defined by its source. Outside, a curve goes on as its file says.
struct CurveDomains {
  data::Domain active;    ///< in fibre length / optimal fibre length
  data::Domain passive;   ///< in fibre length / optimal fibre length
  data::Domain velocity;  ///< in fibre velocity / (v_max l_opt)
  data::Domain tendon;    ///< in strain
};

}  // namespace brachium::hill
