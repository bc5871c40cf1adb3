#pragma once
/// Bézier curves of Millard, Uchida, Seth & Delp 2013, doi:10.1115/1.4023390 (OpenSim's
/// Millard2012EquilibriumMuscle), with its default parameters. Twice continuously differentiable; each is
/// fixed by values and slopes a physiologist can measure.
///
///   f_l  rises from 0.1 at x_min through a shallow slope to 1 at x = 1, and falls to 0.1 at x_max; 0.1
///   outside f_p  0 at 1 + e_zero, 1 at 1 + e_one, slope 0.2 behind its foot and 2.857 at the end, linear
///   beyond f_v  0 at v = -1, 1 at 0, 1.4 at v = 1; slopes 0, 0.25 (at v = -0.9), 5, 0.15 (at v = 0.9), 0 f_t
///   0 at e = 0, 2/3 at the end of the toe, then linear with slope 28.06 through 1 at e_one = 0.049
///
/// The active curve does not reach zero: its floor of 0.1 keeps the source's force-velocity inversion
/// defined. Our chain does not invert; the floor is kept so that the set is the published one.

#include "hill/curve_values.hpp"
#include "hill/quintic_bezier.hpp"

namespace brachium::hill {

class Millard2012 {
 public:
  static constexpr const char* kName = "millard_2012";

  struct Parameters {
    double active_minimum_length = 0.4441;
    double active_transition_length = 0.73;
    double active_maximum_length = 1.8123;
    double active_shallow_slope = 0.8616;
    double active_minimum_value = 0.1;
    double active_curviness = 1.0;
    double passive_strain_at_zero_force = 0.0;
    double passive_strain_at_one_force = 0.7;
    double passive_stiffness_at_low_force = 0.2;
    double passive_stiffness_at_one_force = 2.0 / 0.7;
    double passive_curviness = 0.75;
    double tendon_strain_at_one_force = 0.049;
    double tendon_stiffness_at_one_force = 1.375 / 0.049;
    double tendon_force_at_toe_end = 2.0 / 3.0;
    double tendon_curviness = 0.5;
    double shortening_slope_at_vmax = 0.0;
    double shortening_slope_near_vmax = 0.25;
    double isometric_slope = 5.0;
    double lengthening_slope_at_vmax = 0.0;
    double lengthening_slope_near_vmax = 0.15;
    double max_lengthening_force = 1.4;
    double shortening_curviness = 0.6;
    double lengthening_curviness = 0.9;
  };

  Millard2012() : Millard2012(Parameters()) {}
  /// Throws InputError("bad-curve") if the pieces of a curve cannot be drawn with these parameters.
  explicit Millard2012(const Parameters& parameters);

  const char* name() const { return kName; }

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

 private:
  QuinticBezier active_, passive_, velocity_, tendon_;
};

}  // namespace brachium::hill
