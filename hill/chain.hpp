#pragma once
/// What the chains of the tendon models share. Internal to this folder.

#include <algorithm>
#include <bitset>
#include <cmath>
#include <span>
#include <type_traits>
#include <variant>

#include "hill/element.hpp"
#include "hill/forward.hpp"

namespace brachium::hill {

/// Checked inputs of one run; all spans have n entries but V, which may be empty.
struct ChainInput {
  const MuscleTendon& muscle;
  double step_s;
  std::span<const double> L, V, a;
  MuscleScratch& scratch;
  MuscleTrace& out;
  std::span<const Tangent> tangents;

  std::size_t frames() const { return L.size(); }
  /// Which parameters the tangents differentiate directly.
  std::bitset<kParameterCount> wanted() const {
    std::bitset<kParameterCount> set;
    for (const Tangent& t : tangents) {
      if (t.parameter) set.set(index_of(*t.parameter));
    }
    return set;
  }
};

void rigid_chain(const ChainInput& in);
void elastic_chain(const ChainInput& in);
void ceinms_chain(const ChainInput& in);

/// Calls run(set) with the curves in the form that is fastest to read in one run.
template <class Run>
void with_curves(const CurveSet& curves, const Run& run) {
  std::visit(
      [&run]<class Set>(const Set& set) {
        if constexpr (std::is_same_v<Set, Lloyd2003>) {
          run(Lloyd2003::Reader(set));
        } else {
          run(set);
        }
      },
      curves.variant());
}

/// Writes one frame of fibre quantities.
inline void record(MuscleTrace& out, std::size_t k, const Projected& q, double fibre_velocity,
                   double damping) {
  out.fibre_length_m[k] = q.l;
  out.fibre_velocity_m_s[k] = fibre_velocity;
  if (!out.parts) return;
  out.active_norm[k] = q.fibre.active;
  out.passive_norm[k] = q.fibre.passive;
  out.velocity_norm[k] = q.fibre.fv;
  out.damping_norm[k] = damping * q.vn;
  out.pennation_rad[k] = std::acos(q.c);
}

/// A frame whose path is too short: the shortest fibre, at rest, no force.
inline void record_slack(MuscleTrace& out, std::size_t k, const ElementConstants& c) {
  const double l = std::sqrt(c.h * c.h + c.z_min * c.z_min);
  out.force_N[k] = 0.0;
  out.fibre_length_m[k] = l;
  out.fibre_velocity_m_s[k] = 0.0;
  out.status[k] = FrameStatus::slack;
  if (!out.parts) return;
  out.active_norm[k] = out.passive_norm[k] = out.damping_norm[k] = 0.0;
  out.velocity_norm[k] = 1.0;
  out.pennation_rad[k] = std::acos(c.z_min / l);
}

/// dS/dparameter / S for the two factors of S, else 0.
inline double relative_dS(const MuscleTendon& muscle, MuscleParameter parameter) {
  if (parameter == MuscleParameter::max_isometric_force)
    return 1.0 / muscle.parameters().max_isometric_force_N;
  if (parameter == MuscleParameter::strength) return 1.0 / muscle.parameters().strength;
  return 0.0;
}

inline constexpr MuscleParameter kAllParameters[kParameterCount] = {MuscleParameter::max_isometric_force,
                                                                    MuscleParameter::strength,
                                                                    MuscleParameter::optimal_fibre_length,
                                                                    MuscleParameter::tendon_slack_length,
                                                                    MuscleParameter::pennation,
                                                                    MuscleParameter::max_contraction_velocity,
                                                                    MuscleParameter::fibre_damping};

}  // namespace brachium::hill
