#pragma once
/// Tabulated curves of Lloyd & Besier 2003, doi:10.1016/S0021-9290(03)00010-1, with the points that CEINMS
/// ships as its default (Pizzolato et al. 2015, doi:10.1016/j.jbiomech.2015.09.021).
///
/// Two interpolants by name:
///   monotone  (default) no overshoot between points (data::PiecewiseCubic::monotone), so that the elastic
///             equilibrium stays unambiguous
///   spline    the twice continuously differentiable spline that CEINMS uses
///   (data::PiecewiseCubic::forsythe); it
///             overshoots: f_l < 0 beside its feet, f_t < 0 below slack length

#include <array>
#include <cstdint>
#include <vector>

#include "hill/compiled_cubic.hpp"
#include "hill/curve_values.hpp"

namespace brachium::hill {

class Lloyd2003 {
 public:
  enum class Interpolant { monotone, spline };

  /// Points of one curve, x strictly increasing.
  struct Points {
    std::vector<double> x, y;
  };
  struct Table {
    Points active;    ///< f_l against l~
    Points passive;   ///< f_p against l~
    Points velocity;  ///< f_v against v~
    Points tendon;    ///< f_t against strain
  };
  static Table published();

  Lloyd2003() : Lloyd2003(Interpolant::monotone) {}
  explicit Lloyd2003(Interpolant interpolant) : Lloyd2003(interpolant, published()) {}
  /// Throws InputError("bad-curve").
  Lloyd2003(Interpolant interpolant, const Table& table);

  const char* name() const {
    return interpolant_ == Interpolant::monotone ? "lloyd_2003" : "lloyd_2003_spline";
  }
  Interpolant interpolant() const { return interpolant_; }

  data::CurveValue active(double x) const { return active_(x); }
  data::CurveValue passive(double x) const { return passive_(x); }
  VelocityValue velocity(double v, double) const {
    const data::CurveValue f = velocity_(v);
    return {f.value, f.slope, 0.0};
  }
  data::CurveValue tendon(double strain) const { return tendon_(strain); }

  CurveDomains domains() const {
    return {active_.domain(), passive_.domain(), velocity_.domain(), tendon_.domain()};
  }

  /// The same curves for one run over smooth arguments: remembers the last piece of each. Not shared by
  /// threads.
  class Reader {
   public:
    explicit Reader(const Lloyd2003& set) : set_(set) {}
    data::CurveValue active(double x) const { return set_.active_.at(x, hint_[0]); }
    data::CurveValue passive(double x) const { return set_.passive_.at(x, hint_[1]); }
    VelocityValue velocity(double v, double) const {
      const data::CurveValue f = set_.velocity_.at(v, hint_[2]);
      return {f.value, f.slope, 0.0};
    }
    data::CurveValue tendon(double strain) const { return set_.tendon_.at(strain, hint_[3]); }

   private:
    const Lloyd2003& set_;
    mutable std::array<std::uint32_t, 4> hint_{};
  };

 private:
  Interpolant interpolant_;
  CompiledCubic active_, passive_, velocity_, tendon_;
};

}  // namespace brachium::hill
