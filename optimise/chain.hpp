#pragma once
/// The chain of a calibration: excitation -> activation -> force -> moment, prepared once, with caches per
/// muscle and trial. Internal to optimise/.

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "data/limb/drive.hpp"
#include "data/limb/muscle_path.hpp"
#include "hill/forward.hpp"
#include "optimise/calibration_problem.hpp"
#include "optimise/free_parameters.hpp"
#include "optimise/sampling.hpp"

namespace brachium::optimise {

/// What does not change from point to point: frames are the reference's samples inside the common span.
struct PreparedTrial {
  std::string name;
  double frame_rate_hz = 0.0;
  std::vector<double> frame_time_s;
  std::vector<double> angle_rad, velocity_rad_s;                   ///< at the frames
  std::vector<std::vector<double>> length_m, velocity_m_s, arm_m;  ///< by muscle, at the frames
  double excitation_rate_hz = 0.0;
  std::size_t excitation_count = 0;
  Resampling to_frames;           ///< from the excitations' grid
  std::vector<std::size_t> rows;  ///< frames that are residuals
  std::vector<double> reference;  ///< [N m] at rows
  double weight = 1.0;            ///< of a residual [1 / (N m)]
  std::size_t first_row = 0;      ///< of all residuals
  TrialWindow window;
};

/// A number of one muscle that some free parameter sets.
struct Slot {
  Quantity quantity = Quantity::strength;
  std::size_t channel = 0;  ///< gains
};

struct Chain {
  data::Scene scene;
  CalibrationProblemOptions options;
  std::vector<data::SceneMuscle> muscles;  ///< on the coordinate
  std::vector<bool> driven;
  limb::DriveMap drive;
  Eigen::MatrixXd weights;  ///< muscles x channels
  ChainValues start;
  FreeParameters free;
  std::vector<std::vector<Slot>> slots;  ///< by muscle; strength apart
  double scale_N_m = 1.0;
  std::size_t residual_count = 0;
  hill::MuscleModelOptions muscle_options;
  std::vector<std::shared_ptr<const PreparedTrial>> trials;
};

/// One muscle on one trial at the last point.
class MuscleRun {
 public:
  /// Brings the run up to date; true if the muscle was run, false if the cache served.
  bool update(const Chain& chain, std::size_t muscle, const PreparedTrial& trial,
              const std::vector<std::vector<double>>& channel_samples, const ChainValues& values,
              bool tangents);

  /// Force at strength 1 [N], at the frames.
  const std::vector<double>& force() const { return trace_.force_N; }
  /// d force / d slot at strength 1.
  const std::vector<double>& dforce(std::size_t slot) const { return dforce_[slot]; }
  const std::vector<double>& activation() const { return activation_; }
  const hill::MuscleTrace& trace() const { return trace_; }

 private:
  void activate(const Chain& chain, std::size_t muscle, const PreparedTrial& trial,
                const std::vector<std::vector<double>>& channel_samples, const ChainValues& values,
                bool tangents);

  std::vector<double> activation_key_, hill_key_;
  bool valid_ = false, activation_tangents_ = false, force_tangents_ = false;
  std::vector<double> excitation_, fine_, neural_, work_;
  std::vector<std::vector<double>> fine_tangent_;  ///< da/dslot on the excitations' grid
  std::vector<double> activation_;                 ///< at the frames, inside [0, 1]
  std::vector<std::vector<double>> dactivation_;   ///< by slot, at the frames; empty for hill slots
  std::vector<std::vector<double>> dforce_;
  hill::MuscleTrace trace_;
  hill::MuscleScratch scratch_;
};

}  // namespace brachium::optimise
