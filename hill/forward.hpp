#pragma once
/// The forward chain of one muscle over one trial: activation and path in, force out, with exact tangents.
///
/// | symbol | identifier         | unit | meaning                                             |
/// |--------|--------------------|------|-----------------------------------------------------|
/// | L      | length_m           | m    | muscle-tendon length (n)                            |
/// | L'     | velocity_m_s       | m/s  | its rate (n), e.g. -r q'; may be empty              |
/// | r      | moment_arm_m       | m    | r = -dL/dq (n); may be empty                        |
/// | a      | activation         | 1    | in [0, 1] (n)                                       |
/// | F      | force_N            | N    | tension along the tendon (n)                        |
/// | M      | moment_N_m         | N m  | r F (n), empty without moment arms                  |

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hill/differences.hpp"
#include "hill/muscle_tendon.hpp"

namespace brachium::hill {

/// One muscle's path over a trial of n equally spaced frames.
struct PathTrace {
  double rate_hz = 0.0;                  ///< > 0
  std::span<const double> length_m;      ///< n
  std::span<const double> velocity_m_s;  ///< n, or empty: then the rigid tendon differentiates length_m
  std::span<const double> moment_arm_m;  ///< n, or empty: then no moment is given
};

/// What became of a frame.
enum class FrameStatus : std::uint8_t {
  ok,
  unloaded,  ///< the fibres would push: the tendon is not taut, force 0
  slack      ///< the path is too short for the slack tendon and the shortest fibre: force 0
};
std::string to_string(FrameStatus status);

/// Output of forward(); vectors are resized to n (no allocation when they already are).
struct MuscleTrace {
  std::vector<double> force_N;
  std::vector<double> moment_N_m;
  std::vector<double> fibre_length_m;
  std::vector<double> fibre_velocity_m_s;  ///< lengthening positive
  std::vector<FrameStatus> status;
  /// Parts for the report, in units of F0 strength along the fibre; filled only if `parts` is set.
  bool parts = false;
  std::vector<double> active_norm;    ///< a f_l f_v
  std::vector<double> passive_norm;   ///< f_p
  std::vector<double> velocity_norm;  ///< f_v
  std::vector<double> damping_norm;   ///< d v~
  std::vector<double> pennation_rad;  ///< phi

  std::size_t count(FrameStatus which) const;
};

/// Parameters of data::MuscleParameters that forward() differentiates.
enum class MuscleParameter {
  max_isometric_force,
  strength,
  optimal_fibre_length,
  tendon_slack_length,
  pennation,
  max_contraction_velocity,
  fibre_damping
};
/// Key of the parameter with its unit ("tendon_slack_length_m"), and back; throws
/// InputError("unknown-parameter").
std::string to_string(MuscleParameter parameter);
MuscleParameter parse_muscle_parameter(std::string_view name);
double get(const data::MuscleParameters& parameters, MuscleParameter which);
void set(data::MuscleParameters& parameters, MuscleParameter which, double value);

/// One direction theta: dF/dtheta = dF/da da/dtheta + dF/dparameter.
struct Tangent {
  std::span<const double> dactivation;  ///< n [1/theta], or empty: the activation does not depend on theta
  std::optional<MuscleParameter> parameter;  ///< set: theta is this parameter
  std::span<double> dforce;                  ///< n, output [N/theta]
};

/// Working memory; reuse it over calls. Not to be shared between threads.
class MuscleScratch {
 public:
  static constexpr std::size_t kSlots = 40;
  /// Slot `slot` with n elements, whose values are left over from earlier.
  std::vector<double>& array(std::size_t slot, std::size_t n) {
    arrays_[slot].resize(n);
    return arrays_[slot];
  }
  SplineSlopes spline;  ///< factors kept between calls

 private:
  std::array<std::vector<double>, kSlots> arrays_;
};

/// Whether a frame's result depends on that frame alone, so that a trial may be run in pieces: a rigid tendon whose path
/// comes with its velocity (or whose fibre velocity is not asked for).
bool frames_are_independent(const MuscleModelOptions& options, bool has_velocity);

/// Runs the chain over all frames. The tangents are those of the discrete chain itself, differences in time
/// included. Throws InputError (sizes that disagree, "trial-too-short", "not-finite", "activation-range") and
/// ConvergenceFailure naming muscle and frame.
void forward(const MuscleTendon& muscle, const PathTrace& path, std::span<const double> activation,
             MuscleScratch& scratch, MuscleTrace& out, std::span<const Tangent> tangents = {});

}  // namespace brachium::hill
