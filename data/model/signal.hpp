#pragma once
/// A signal: equally spaced samples of one quantity, with all that is needed to know what they mean.

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace brachium::data {

/// What a signal measures. The names stand as they are in files ("emg", "joint_angle", ...).
enum class Quantity {
  emg,                   ///< electrode voltage [V]
  excitation,            ///< normalised linear envelope [1]
  activation,            ///< muscle activation [1]
  joint_angle,           ///< [rad], flexion positive
  joint_velocity,        ///< [rad/s]
  joint_acceleration,    ///< [rad/s^2]
  joint_moment,          ///< [N m], flexion positive
  dynamometer_torque,    ///< raw machine torque [N m]
  dynamometer_angle,     ///< raw machine angle [rad]
  dynamometer_velocity,  ///< raw machine velocity [rad/s]
  muscle_force,          ///< tension along the tendon [N]
  fibre_length,          ///< [m]
  fibre_velocity,        ///< [m/s], lengthening positive
  moment_arm,            ///< r = -dL/dq [m]
  muscle_tendon_length,  ///< [m]
  orientation,           ///< one component of a unit quaternion [1]
  position,              ///< one component of a point [m]
  acceleration,          ///< one component [m/s^2]
  other
};

std::string to_string(Quantity quantity);
/// Throws InputError("unknown-quantity") with the nearest name.
Quantity parse_quantity(const std::string& name);

/// Everything about a signal but its samples.
struct SignalInfo {
  std::string name;  ///< unique in its trial
  Quantity quantity = Quantity::other;
  std::string unit;           ///< unit of the stored samples: SI inside Brachium ("V", "rad", "N m", "1")
  double rate_hz = 0.0;       ///< [Hz] > 0
  double start_time_s = 0.0;  ///< [s] time of sample 0 on the trial's clock
  std::size_t count = 0;      ///< number of samples
  std::string muscle;         ///< muscle the signal belongs to, or empty
  std::string coordinate;     ///< coordinate (joint angle) the signal belongs to, or empty
  std::map<std::string, std::string>
      attributes;  ///< what was done to it: filters, resampling, source file, ...

  double time_s(std::size_t i) const { return start_time_s + static_cast<double>(i) / rate_hz; }
  double end_time_s() const { return count == 0 ? start_time_s : time_s(count - 1); }
  double duration_s() const { return static_cast<double>(count) / rate_hz; }
};

/// A signal with its samples; info.count == samples.size() wherever one is handed over.
struct Signal {
  SignalInfo info;
  std::vector<double> samples;
};

}  // namespace brachium::data
