#include "hill/millard_2012.hpp"

#include <algorithm>

namespace brachium::hill {
namespace {

using P = Millard2012::Parameters;

// Five corners: foot, ascending limb, shallow plateau, peak, descending limb. 0.0259 is half the width of the
// plateau of a sarcomere at optimal overlap, by which the limbs are moved outwards.
QuinticBezier active_curve(const P& p) {
  const double x0 = p.active_minimum_length, x1 = p.active_transition_length, x2 = 1.0,
               x3 = p.active_maximum_length;
  const double half_plateau = 0.0259 * x2;
  const double shoulder = x2 - half_plateau;
  const double y1 = 1.0 - p.active_shallow_slope * (shoulder - x1);
  const double ascent = y1 / (x1 - (x0 + half_plateau));
  const double descent = -1.0 / ((x3 - half_plateau) - (x2 + half_plateau));
  return QuinticBezier({{x0, p.active_minimum_value, 0.0},
                        {0.5 * (x0 + half_plateau + x1), 0.5 * y1, ascent},
                        {0.5 * (x1 + shoulder), 0.5 * (1.0 + y1), p.active_shallow_slope},
                        {x2, 1.0, 0.0},
                        {0.5 * (x2 + x3), 0.5, descent},
                        {x3, p.active_minimum_value, 0.0}},
                       p.active_curviness);
}

// The low-stiffness knot lies on the line of that stiffness through the middle of the foot.
QuinticBezier passive_curve(const P& p) {
  const double zero = 1.0 + p.passive_strain_at_zero_force, one = 1.0 + p.passive_strain_at_one_force;
  const double foot = std::min(0.1 / p.passive_stiffness_at_one_force, 0.1 * (one - zero));
  return QuinticBezier(
      {{zero, 0.0, 0.0},
       {zero + foot, 0.5 * foot * p.passive_stiffness_at_low_force, p.passive_stiffness_at_low_force},
       {one, 1.0, p.passive_stiffness_at_one_force}},
      p.passive_curviness);
}

QuinticBezier velocity_curve(const P& p) {
  const double near = 0.1;  // distance of the inner knots from v = -1 and 1
  const double shortening = 0.5 * near * (p.shortening_slope_near_vmax + p.shortening_slope_at_vmax);
  const double lengthening =
      p.max_lengthening_force - 0.5 * near * (p.lengthening_slope_near_vmax + p.lengthening_slope_at_vmax);
  return QuinticBezier(
      {{-1.0, 0.0, p.shortening_slope_at_vmax},
       {-1.0 + near, shortening, p.shortening_slope_near_vmax},
       {0.0, 1.0, p.isometric_slope},
       {1.0 - near, lengthening, p.lengthening_slope_near_vmax},
       {1.0, p.max_lengthening_force, p.lengthening_slope_at_vmax}},
      {p.shortening_curviness, p.shortening_curviness, p.lengthening_curviness, p.lengthening_curviness});
}

// In strain. The toe's middle knot lies halfway between the foot and the linear part at half the toe's force.
QuinticBezier tendon_curve(const P& p) {
  const double stiffness = p.tendon_stiffness_at_one_force, toe_force = p.tendon_force_at_toe_end;
  const double toe = p.tendon_strain_at_one_force + (toe_force - 1.0) / stiffness;
  const double foot = toe / 10.0;
  const double half_toe = p.tendon_strain_at_one_force + (0.5 * toe_force - 1.0) / stiffness;
  const double slope = 0.5 * toe_force / (half_toe - foot);
  const double middle = 0.5 * (foot + half_toe);
  return QuinticBezier(
      {{0.0, 0.0, 0.0}, {middle, slope * (middle - foot), slope}, {toe, toe_force, stiffness}},
      p.tendon_curviness);
}

}  // namespace

Millard2012::Millard2012(const Parameters& parameters)
    : active_(active_curve(parameters)),
      passive_(passive_curve(parameters)),
      velocity_(velocity_curve(parameters)),
      tendon_(tendon_curve(parameters)) {}

}  // namespace brachium::hill
