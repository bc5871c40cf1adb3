#pragma once
/// A Hill-type muscle-tendon unit: parameters and model choices, checked once, constant afterwards.
///
///   F = F0 s [ a f_l(l~_a) f_v(v~, a) + f_p(l~) + d v~ ] cos(phi)                       (Zajac 1989, PMID
///   2676342) l_MT = l_M cos(phi) + l_T,   l_M sin(phi) = l_opt sin(phi_opt)                     (constant
///   thickness) l~ = l_M / l_opt,  l~_a = l_M / (l_opt (1 + p (1 - a))),  v~ = v_M / (v_max l_opt) (p: Lloyd
///   & Besier 2003,
///                                                                      doi:10.1016/S0021-9290(03)00010-1)

#include <string>
#include <string_view>

#include "data/model/muscle.hpp"
#include "hill/curve_set.hpp"

namespace brachium::hill {

enum class TendonKind {
  rigid,   ///< l_T = l_slack
  elastic  ///< tendon force = fibre force, a root per frame
};

/// Where the fibre velocity of a trial comes from; hill/README.md gives orders and limits.
enum class FibreVelocity {
  zero_lag,  ///< offline: symmetric differences (fourth order), uses frames before and after
  causal,    ///< online: backward differences, uses past frames only
  none       ///< v~ = 0: f_v = 1 and no damping
};

/// Whose conventions the batch chain follows where they differ from ours.
enum class Compatibility {
  none,
  ceinms  ///< CEINMS 2015 offline: hill/README.md lists each difference
};

struct MuscleModelOptions {
  CurveSet curves;  ///< default Lloyd & Besier 2003, monotone interpolant
  TendonKind tendon = TendonKind::rigid;
  FibreVelocity velocity = FibreVelocity::zero_lag;
  Compatibility compatibility = Compatibility::none;
  double optimal_length_coupling = 0.0;  ///< p in [0, 1]
};

/// All of CEINMS' choices: its spline through the points of Lloyd & Besier, p = 0.15, its conventions.
MuscleModelOptions ceinms_options(TendonKind tendon);

/// "rigid" | "elastic"; "zero_lag" | "causal" | "none"; "none" | "ceinms". Throw
/// InputError("unknown-choice") with the nearest name.
TendonKind parse_tendon(std::string_view name);
FibreVelocity parse_fibre_velocity(std::string_view name);
Compatibility parse_compatibility(std::string_view name);
std::string to_string(TendonKind kind);
std::string to_string(FibreVelocity kind);
std::string to_string(Compatibility kind);

class MuscleTendon {
 public:
  /// Throws InputError("bad-parameter") carrying every parameter outside its range: muscle, parameter, value,
  /// range.
  MuscleTendon(std::string name, const data::MuscleParameters& parameters, const MuscleModelOptions& options);

  const std::string& name() const { return name_; }
  const data::MuscleParameters& parameters() const { return parameters_; }
  const MuscleModelOptions& options() const { return options_; }

 private:
  std::string name_;
  data::MuscleParameters parameters_;
  MuscleModelOptions options_;
};

}  // namespace brachium::hill
