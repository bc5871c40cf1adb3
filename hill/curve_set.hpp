#pragma once
/// A named set of the four normalised curves of a Hill-type muscle. One question asked of five published
/// sets.
///
/// | symbol | identifier | unit          | meaning                                                        |
/// |--------|------------|---------------|----------------------------------------------------------------|
/// | l~     | x          | 1             | fibre length / optimal fibre length                            |
/// | v~     | v          | 1             | fibre velocity / (v_max l_opt), lengthening positive           |
/// | e      | strain     | 1             | tendon length / slack length - 1                               |
/// | a      | a          | 1             | activation in [0, 1]                                           |
/// | f_l    | active     | F0            | active force-length multiplier                                 |
/// | f_p    | passive    | F0            | passive force-length multiplier                                |
/// | f_v    | velocity   | 1             | force-velocity multiplier                                      |
/// | f_t    | tendon     | F0            | tendon force                                                   |

#include <concepts>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "data/model/curve.hpp"
#include "hill/curve_values.hpp"
#include "hill/degroote_fregly_2016.hpp"
#include "hill/guenther_2007.hpp"
#include "hill/lloyd_2003.hpp"
#include "hill/millard_2012.hpp"
#include "hill/thelen_2003.hpp"

namespace brachium::hill {

/// Any of the published sets, with the parameters it was built with. A value type; safe to share between
/// threads.
class CurveSet {
 public:
  using Variant = std::variant<DeGrooteFregly2016, Thelen2003, Millard2012, Lloyd2003, Guenther2007>;

  CurveSet() : CurveSet(Lloyd2003()) {}  ///< Lloyd & Besier 2003, monotone interpolant
  template <class Set>
  requires std::is_constructible_v<Variant, Set> CurveSet(Set set) : set_(std::move(set)) {}

  /// "degroote_fregly_2016", "thelen_2003", "millard_2012", "lloyd_2003", "lloyd_2003_spline" or
  /// "guenther_2007"; throws InputError("unknown-curve-set") with the nearest name otherwise.
  static CurveSet named(std::string_view name);
  static const std::vector<std::string>& names();

  std::string name() const;
  data::CurveValue active(double x) const;
  data::CurveValue passive(double x) const;
  VelocityValue velocity(double v, double a) const;
  /// f_t as published, also below slack length.
  data::CurveValue tendon(double strain) const;
  CurveDomains domains() const;

  const Variant& variant() const { return set_; }

 private:
  Variant set_;
};

}  // namespace brachium::hill
