#pragma once
/// The muscle map: what was solved for one muscle over angle and activation, state by state. A value;
/// surrogates are made from it.

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "data/model/table.hpp"
#include "fem/surrogate/samples.hpp"

namespace brachium::fem {

enum class StateStability { stable, unstable, unknown };

struct Gradient {
  double dtheta = 0.0;  ///< [unit/rad]
  double dalpha = 0.0;  ///< [unit]
};

struct FibreStretch {
  double least = 0.0, mean = 0.0, greatest = 0.0, deviation = 0.0;  ///< λ over the muscle's volume
};

/// One solved state. What a variant does not have stays empty.
struct MuscleState {
  StatePoint at;
  double force_n = 0.0;  ///< |R|, resultant of the consistent reactions at the moving attachment
  std::optional<Gradient> force_gradient;
  Eigen::Vector3d wrench_force_n = Eigen::Vector3d::Zero();     ///< R
  Eigen::Vector3d wrench_moment_n_m = Eigen::Vector3d::Zero();  ///< about the joint's centre
  double moment_n_m = 0.0;                                      ///< about the joint's axis, flexion positive
  std::optional<Gradient> moment_gradient;
  std::optional<double> tdm_m, vrla_m, vrla_plus_m;  ///< lever arms
  std::optional<double> contact_force_n;
  std::optional<FibreStretch> fibre_stretch;
  StateStability stability = StateStability::unknown;
  double force_tolerance_n = 0.0;  ///< what the solver's tolerance leaves open in F
};

struct FailedState {
  StatePoint at;
  std::string reason;
};

struct MuscleMap {
  std::string muscle;
  std::string variant;  ///< "rigid-tendon", "muscle-tendon complex"
  StateBounds bounds;   ///< what was asked for
  std::vector<MuscleState> states;
  std::vector<FailedState> failed;

  /// Null where no state was solved (to a billionth of the range).
  const MuscleState* find(const StatePoint& at) const;
  /// Throws InputError("bad-sample") for a state outside the bounds, twice there, or not finite.
  void check() const;
  /// One row a state, failed ones with empty figures and their reason.
  data::Table table() const;
};

/// Quantities of a map that a surrogate can be made of.
enum class MapOutput { force, moment, tdm, vrla, vrla_plus, contact_force, mean_fibre_stretch };
std::string name_of(MapOutput output);  ///< "force_n", "moment_n_m", "tdm_m", ...

struct MapSamples {
  SampleSet set;  ///< of all states that are not unstable; derivatives where every output has them
  std::vector<FailedState> left_out;  ///< unstable and failed states, with the reason
};

/// Throws InputError("missing-output") naming the first state that lacks an output.
MapSamples samples_of(const MuscleMap& map, const std::vector<MapOutput>& outputs);

}  // namespace brachium::fem
