#pragma once
/// A synthetic twin: sessions whose truth is known, generated from a scene.
///
/// The scene's muscles are the truth. Trial programmes give an angle and an effort for flexors and extensors; efforts
/// become channel excitations, these go through activation dynamics and the muscle model to a moment; raw EMG is
/// band-limited noise whose amplitude follows the excitation, to which an electrode's troubles are added. Every random
/// number comes from (seed, trial, signal): the same on every platform.
///
/// | symbol | identifier      | unit | meaning                                                                |
/// |--------|-----------------|------|------------------------------------------------------------------------|
/// | e(t)   | excitation      | 1    | true channel excitation, 1 at the maximal contraction                  |
/// | g      | channel_gains   | 1    | what a recorder shows is e / g (raw EMG and given excitations alike)   |
/// | M(t)   | joint_moment    | N m  | sum of r F over the muscles                                            |

#include <cstdint>
#include <string>
#include <vector>

#include "data/model/scene.hpp"
#include "data/model/session.hpp"
#include "data/model/subject.hpp"
#include "emg/synthetic_emg.hpp"
#include "optimise/calibration_problem.hpp"

namespace brachium::optimise {

/// What is done in a trial.
enum class Programme {
  mvc,             ///< three maximal contractions of 3 s of flexors, then of extensors, at a fixed angle
  isometric_ramp,  ///< effort up to a level and down again, at a fixed angle
  isometric_hold,  ///< holds at rising levels, at a fixed angle
  curl,            ///< slow flexion-extension between two angles, effort against a load
  isokinetic,      ///< constant velocity between two angles with acceleration ramps, high effort
  passive_sweep,   ///< moved slowly through the range at rest
  random           ///< smooth random angle and efforts: the richest of all
};
std::string to_string(Programme programme);
Programme parse_programme(const std::string& name);  ///< throws InputError("unknown-programme")

struct TwinTrial {
  std::string name;
  Programme programme = Programme::random;
  data::TrialKind kind = data::TrialKind::calibration;
  double duration_s = 20.0;
  double lower_rad = 0.3;     ///< lowest angle, or the fixed angle of isometric trials
  double upper_rad = 1.9;     ///< highest angle
  double effort = 0.6;        ///< largest excitation aimed at
  double cycle_s = 4.0;       ///< duration of one repetition
  double load_mass_kg = 0.0;  ///< written as the trial's condition
};

struct TwinOptions {
  std::uint64_t seed = 1;
  std::vector<TwinTrial> trials;      ///< empty: twin_protocol()
  double motion_rate_hz = 200.0;      ///< of angle, velocity and moment
  double excitation_rate_hz = 200.0;  ///< of the true excitation signals
  double cocontraction = 0.1;         ///< excitation of antagonists as a share of the agonists'
  double independence = 0.35;         ///< share of each channel's excitation that others do not follow
  /// Electrode, spectrum and troubles of every channel; seed and stream are set by the twin, the amplitude is
  /// varied between channels by a factor of 0.5 to 2.
  emg::SyntheticEmgOptions emg;
  double moment_noise_sd_N_m = 0.0;  ///< of the reference moment, low-passed at moment_noise_cutoff_hz
  double moment_noise_cutoff_hz = 5.0;
  bool raw_emg = true;       ///< false: excitation signals only
  bool dynamometer = false;  ///< also machine torque, angle and velocity, gravity included
  ModelChoice model;         ///< the chain that makes the truth
  std::map<std::string, double>
      channel_gains;  ///< true gains; 1 where absent. EMG and given excitations are e / gain
};

struct Twin {
  /// What a recorder would have kept: per trial raw EMG per channel (if raw_emg), joint_angle,
  /// joint_velocity, the reference joint_moment, and, if so asked, the dynamometer's signals.
  data::Session recordings;
  /// What nobody can record: per trial excitation per channel (at excitation_rate_hz; divided by the gain),
  /// activation, force and moment share per muscle, and the exact moment.
  data::Session truth;
  data::Subject subject;  ///< true parameters and gains
};

/// Throws InputError for options outside their range, and for a scene that cannot be run.
Twin make_twin(const data::Scene& scene, const TwinOptions& options);

/// A protocol that shows most parameters: mvc, ramps at three angles, holds, curls, a sweep at rest, random.
std::vector<TwinTrial> twin_protocol();

/// Trials as a calibration takes them: true excitations with the recordings' angle, velocity and reference
/// moment.
std::vector<CalibrationTrial> noise_free_trials(const Twin& twin, const std::string& coordinate);

}  // namespace brachium::optimise
