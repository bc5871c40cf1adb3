#pragma once
/// What is known of a muscle before any model of it is built: plain values shared by every muscle model.

#include <map>
#include <string>
#include <vector>

namespace brachium::data {

/// Hill-type parameters of one muscle-tendon unit (Zajac 1989).
struct MuscleParameters {
  double max_isometric_force_N = 0.0;      ///< F0 > 0
  double optimal_fibre_length_m = 0.0;     ///< l_opt > 0
  double tendon_slack_length_m = 0.0;      ///< l_slack >= 0
  double pennation_at_optimal_rad = 0.0;   ///< phi_opt in [0, pi/2)
  double max_contraction_velocity = 10.0;  ///< v_max [optimal fibre lengths / s] > 0
  double fibre_damping = 0.1;              ///< d [F0 per (v_max l_opt)] >= 0
  double strength = 1.0;                   ///< coefficient on F0, calibrated, > 0
};

/// Second-order activation dynamics of one muscle.
struct ActivationParameters {
  double delay_s = 0.040;            ///< electromechanical delay d >= 0
  double time_constant_1_s = 0.015;  ///< tau1 > 0
  double time_constant_2_s = 0.035;  ///< tau2 > 0
  double shape = -1.5;  ///< A of a = (exp(A u) - 1)/(exp(A) - 1); -3 < A < 0 (piecewise: 0 < A <= 0.12)
};

/// Muscle-tendon length and moment arm as functions of one coordinate.
struct PathGeometry {
  enum class Kind {
    none,        ///< not given
    polynomial,  ///< L(q) = sum_k length[k] q^k [m, rad]; r(q) = sum_k moment_arm[k] q^k [m]
    table        ///< knots angle_rad[i] -> length[i], moment_arm[i], monotone/Hermite interpolation
  };
  Kind kind = Kind::none;
  std::string coordinate;         ///< the coordinate q it depends on
  std::vector<double> angle_rad;  ///< table only: knots, strictly increasing
  std::vector<double> length_m;  ///< coefficients or values; may be empty if only the moment arm is known and
                                 ///< a reference length is given
  std::vector<double> moment_arm_m;  ///< coefficients or values; r = -dL/dq
  double reference_length_m = 0.0;   ///< L at reference_angle_rad, used when length_m is empty
  double reference_angle_rad = 0.0;
  double consistency_tolerance_m =
      1e-3;  ///< largest |r + dL/dq| accepted where length and moment arm are both given
};

/// How a muscle gets its excitation: e = sum_k weight_k * channel_k.
struct MuscleDrive {
  enum class Kind {
    channels,  ///< linear map of recorded channels
    rule,      ///< named rule over other muscles' excitations
    undriven   ///< no excitation: the muscle is passive and is reported as such
  };
  Kind kind = Kind::undriven;
  std::map<std::string, double> channels;  ///< channel -> weight (>= 0)
  std::string rule;                        ///< "same_as" or "mean_of"
  std::vector<std::string> muscles;        ///< muscles the rule refers to
  std::string reason;                      ///< why undriven, as the scene says
};

}  // namespace brachium::data
