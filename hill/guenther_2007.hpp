#pragma once
/// Bell-shaped active force-length curve of Günther, Schmitt & Wank 2007, doi:10.1007/s00422-007-0160-6, the
/// law that continuum models use as well, so that a lumped and a continuum muscle can share one active law.
///
///   f_l(x) = exp(-|(x - 1)/ΔW|^ν),  ΔW, ν = ΔW_asc, ν_asc for x <= 1 and ΔW_des, ν_des for x > 1
///
/// The source's other elements have parameters of their own kind; passive force, force-velocity and tendon
/// curve are borrowed from De Groote & Fregly 2016 (kBorrowed).

#include <cmath>

#include "hill/degroote_fregly_2016.hpp"

namespace brachium::hill {

class Guenther2007 {
 public:
  static constexpr const char* kName = "guenther_2007";
  static constexpr const char* kBorrowed = DeGrooteFregly2016::kName;

  struct Parameters {
    double ascending_width = 0.57;     ///< ΔW_asc > 0
    double ascending_exponent = 4.0;   ///< ν_asc > 1
    double descending_width = 0.14;    ///< ΔW_des > 0
    double descending_exponent = 3.0;  ///< ν_des > 1
  };

  Guenther2007() : Guenther2007(Parameters()) {}
  /// Throws InputError("bad-parameter").
  explicit Guenther2007(const Parameters& parameters);

  const char* name() const { return kName; }

  data::CurveValue active(double x) const {
    const bool ascending = x <= 1.0;
    const double width = ascending ? p_.ascending_width : p_.descending_width;
    const double exponent = ascending ? p_.ascending_exponent : p_.descending_exponent;
    const double s = std::abs(x - 1.0) / width;
    if (s == 0.0) return {1.0, 0.0};
    const double power = std::pow(s, exponent - 1.0);
    const double f = std::exp(-power * s);
    return {f, (ascending ? 1.0 : -1.0) * exponent * power / width * f};
  }
  data::CurveValue passive(double x) const { return borrowed_.passive(x); }
  VelocityValue velocity(double v, double a) const { return borrowed_.velocity(v, a); }
  data::CurveValue tendon(double strain) const { return borrowed_.tendon(strain); }

  CurveDomains domains() const {
    CurveDomains d = borrowed_.domains();
    d.active = {0.0, 2.0};
    return d;
  }

 private:
  Parameters p_;
  DeGrooteFregly2016 borrowed_;
};

}  // namespace brachium::hill
