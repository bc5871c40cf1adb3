#pragma once
/// Muscle maps: many states of several muscles, in parallel, any of them known already.
///
/// For each muscle first the trunk: the passive state at every angle that is asked for, angle after angle
/// from the reference, whose lengths give the lever arms by tendon displacement. Then from every angle a ray:
/// its other states by rising activation. Trunks run side by side, and so do rays, each on a copy of its own,
/// so that what a state is reached from does not depend on the number of threads.

#include <functional>
#include <string>
#include <vector>

#include "fem/limb/muscle_states.hpp"
#include "fem/surrogate/muscle_map.hpp"

namespace brachium::fem {

struct MapRequest {
  MuscleBody body;
  AngleRange range;
  Hinge hinge;
  std::vector<Bone> bones;
  SolvedMuscleOptions options;
  std::vector<StatePoint> wanted;  ///< in any order; the passive states at their angles are added
  std::vector<StatePoint> known;   ///< of an earlier run: not solved again
};

/// One state as it is reached. References hold during the call only.
struct MapState {
  std::size_t muscle;  ///< index of the request
  const SolvedMuscle& reading;
  const SolveState& solved;
  const Problem& problem;
  const Discretisation& discretisation;
};

struct MapOutcome {
  std::vector<FailedState> failed;
  std::vector<std::string> log;  ///< which bones are modelled, which are left out; one line each
  long unknowns = 0;
};

/// `observer` is called once a state, from one thread at a time, in an order that depends on the threads;
/// what it throws ends the run. A state that cannot be reached is named in its muscle's outcome, and the
/// others go on. Throws InputError as MuscleStates does, ConvergenceFailure where a muscle cannot be brought
/// to its in-situ place.
std::vector<MapOutcome> solve_maps(const std::vector<MapRequest>& requests, std::size_t threads,
                                   const std::function<void(const MapState&)>& observer);

/// States of a request: the wanted ones and the passive ones at their angles, each once, by angle, then
/// activation.
std::vector<StatePoint> states_of(const MapRequest& request);

/// A solved state as the map carries it; without lever arm by tendon displacement.
MuscleState map_state(const SolvedMuscle& reading, const Hinge& hinge);

/// Lever arms by tendon displacement from the passive states among `readings`: by angle, flexion positive.
/// Empty where there are fewer than 4.
std::vector<std::pair<double, double>> passive_lever_arms(const std::vector<SolvedMuscle>& readings);

}  // namespace brachium::fem
