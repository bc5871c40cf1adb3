#pragma once
/// Published lever arms of the continuum upper limb, as polynomials of the elbow's angle (Valentin 2019, ch.
/// 7).

namespace brachium::fem {

/// m, positive, at an angle in rad: biceps (flexes) and triceps (extends).
double published_biceps_lever_arm_m(double q_rad);
double published_triceps_lever_arm_m(double q_rad);

}  // namespace brachium::fem
