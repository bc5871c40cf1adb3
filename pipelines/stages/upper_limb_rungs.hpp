#pragma once
/// The continuum muscles of fem.upper_limb over the frames of a trial, by surrogate or solved frame by frame.
///
/// | symbol | unit | meaning                                                                      |
/// |--------|------|------------------------------------------------------------------------------|
/// | F      | N    | force at the distal end                                                      |
/// | r      | m    | lever arm by the chosen method, flexion positive; virtual work: M / F        |
/// | M      | N m  | moment, r F                                                                  |
/// | M_p    | N m  | M of the same muscle at the same angle without activation                    |

#include <memory>
#include <string>
#include <vector>

#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// Frames of one trial; those that are not used are not evaluated.
struct LimbFrames {
  std::string trial;
  std::vector<double> time_s, angle_rad;
  std::vector<std::vector<double>> activation;  ///< by muscle
};

struct MuscleFrames {
  std::vector<double> force_n, arm_m, moment_n_m, passive_n_m;  ///< by frame
  std::size_t unstable = 0;                                     ///< frames
};

class LimbRung {
 public:
  virtual ~LimbRung() = default;
  virtual const std::vector<std::string>& muscles() const = 0;
  virtual double lower_rad() const = 0;
  virtual double upper_rad() const = 0;
  virtual double upper_activation() const = 0;
  /// Which rung and what of; for verdict and report.
  virtual std::string words() const = 0;
  /// What is costly, once all that is cheaper has been checked; before the first evaluate.
  virtual void begin(const StageContext&) {}
  /// One muscle over frames that lie in range. Throws ConvergenceFailure naming muscle, trial and time.
  /// Called for different muscles from different threads at a time, for one muscle's trials one after
  /// another.
  virtual MuscleFrames evaluate(std::size_t muscle, const LimbFrames& frames) = 0;
};

/// Throws InputError("contradiction") where the lever arm needs a map and a limb is given.
void check_lever_arm(const Options& options);

/// The input `map`, or the option `limb`. Throws InputError("contradiction") or ("missing-key") where not
/// exactly one of them is given, and as check_lever_arm.
std::unique_ptr<LimbRung> limb_rung(const StageContext& context);

}  // namespace brachium::pipelines
