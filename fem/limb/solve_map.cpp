#include "fem/limb/solve_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <optional>

#include "data/model/parallel.hpp"

namespace brachium::fem {
namespace {

constexpr double same = 1e-12;

bool at_same_place(const StatePoint& a, const StatePoint& b) {
  return std::abs(a.theta_rad - b.theta_rad) < same && std::abs(a.activation - b.activation) < same;
}

bool contains(const std::vector<StatePoint>& states, const StatePoint& s) {
  return std::any_of(states.begin(), states.end(), [&](const StatePoint& o) { return at_same_place(o, s); });
}

struct Muscle {
  std::optional<MuscleStates> states;
  std::optional<Discretisation> discretisation;
};

/// Solves one after the other; what fails is put down.
void solve_all(const std::vector<StatePoint>& wanted, const MapRequest& request, MuscleStates& states,
               std::vector<FailedState>& failed, const std::function<void(const SolvedMuscle&)>& reached) {
  for (const StatePoint& s : wanted) {
    if (contains(request.known, s)) continue;
    const SolvedMuscle* reading = nullptr;
    try {
      reading = &states.solve_state(s.theta_rad, s.activation);
    } catch (const data::ConvergenceFailure& failure) {
      failed.push_back({s, failure.details().reason});
      continue;
    }
    reached(*reading);
  }
}

/// Angles from the reference outwards.
std::vector<StatePoint> trunk_of(const MapRequest& request) {
  std::vector<StatePoint> trunk;
  for (const StatePoint& s : states_of(request)) {
    if (s.activation < same) trunk.push_back(s);
  }
  std::stable_sort(trunk.begin(), trunk.end(), [&](const StatePoint& a, const StatePoint& b) {
    return std::abs(a.theta_rad - request.body.reference_rad) <
           std::abs(b.theta_rad - request.body.reference_rad);
  });
  return trunk;
}

}  // namespace

std::vector<StatePoint> states_of(const MapRequest& request) {
  std::vector<StatePoint> all;
  for (const StatePoint& s : request.wanted) {
    for (const StatePoint& with : {s, StatePoint{s.theta_rad, 0.0}}) {
      if (!contains(all, with)) all.push_back(with);
    }
  }
  std::sort(all.begin(), all.end(), [](const StatePoint& a, const StatePoint& b) {
    return std::pair(a.theta_rad, a.activation) < std::pair(b.theta_rad, b.activation);
  });
  return all;
}

std::vector<MapOutcome> solve_maps(const std::vector<MapRequest>& requests, std::size_t threads,
                                   const std::function<void(const MapState&)>& observer) {
  std::vector<MapOutcome> outcomes(requests.size());
  std::vector<Muscle> muscles(requests.size());
  std::mutex one_at_a_time;
  const auto observe = [&](std::size_t m, const MuscleStates& states, const SolvedMuscle& reading) {
    const std::lock_guard lock(one_at_a_time);
    observer({m, reading, states.solved(reading.q_rad, reading.activation), states.problem(),
              *muscles[m].discretisation});
  };
  data::parallel_for(requests.size(), threads, [&](std::size_t m) {
    const MapRequest& r = requests[m];
    const std::vector<StatePoint> all = states_of(r);
    const bool done =
        std::all_of(all.begin(), all.end(), [&](const StatePoint& s) { return contains(r.known, s); });
    if (done) return;
    muscles[m].states.emplace(r.body, r.range, r.hinge, r.bones, r.options);
    MuscleStates& states = *muscles[m].states;
    muscles[m].discretisation.emplace(states.problem().mesh, states.problem().formulation);
    outcomes[m].log = states.log();
    outcomes[m].unknowns = states.unknowns();
    solve_all(trunk_of(r), r, states, outcomes[m].failed,
              [&](const SolvedMuscle& s) { observe(m, states, s); });
  });
  struct Ray {
    std::size_t muscle;
    std::vector<StatePoint> states;
    std::vector<FailedState> failed;
  };
  std::vector<Ray> rays;
  for (std::size_t m = 0; m < requests.size(); ++m) {
    if (!muscles[m].states) continue;
    std::map<double, std::vector<StatePoint>> by_angle;
    for (const StatePoint& s : states_of(requests[m])) {
      if (s.activation >= same) by_angle[s.theta_rad].push_back(s);
    }
    for (auto& [angle, states] : by_angle) rays.push_back({m, std::move(states), {}});
  }
  data::parallel_for(rays.size(), threads, [&](std::size_t k) {
    Ray& ray = rays[k];
    MuscleStates states = *muscles[ray.muscle].states;
    solve_all(ray.states, requests[ray.muscle], states, ray.failed,
              [&](const SolvedMuscle& s) { observe(ray.muscle, states, s); });
  });
  for (Ray& ray : rays) {
    std::vector<FailedState>& all = outcomes[ray.muscle].failed;
    all.insert(all.end(), ray.failed.begin(), ray.failed.end());
  }
  return outcomes;
}

MuscleState map_state(const SolvedMuscle& s, const Hinge& hinge) {
  MuscleState state;
  state.at = {s.q_rad, s.activation};
  state.force_n = s.force_n;
  state.wrench_force_n = s.wrench.force_n;
  state.wrench_moment_n_m = s.wrench.moment_n_m + (s.end_m - hinge.centre_m).cross(s.wrench.force_n);
  state.moment_n_m = s.moment_n_m;
  const auto gradient = [](const StateSlope& slope) -> std::optional<Gradient> {
    if (!std::isfinite(slope.by_q) || !std::isfinite(slope.by_activation)) return std::nullopt;
    return Gradient{slope.by_q, slope.by_activation};
  };
  state.force_gradient = gradient(s.force_slope_n);
  state.moment_gradient = gradient(s.moment_slope_n_m);
  state.vrla_m = s.arms.vrla_m;
  state.vrla_plus_m = s.arms.vrla_plus_m;
  double contact = 0.0;
  for (const BoneContact& c : s.contacts) contact += c.force_n;
  state.contact_force_n = contact;
  state.fibre_stretch = FibreStretch{s.stretch_min, s.stretch_mean, s.stretch_max, 0.0};
  state.stability = s.stability == "stable"     ? StateStability::stable
                    : s.stability == "unstable" ? StateStability::unstable
                                                : StateStability::unknown;
  return state;
}

std::vector<std::pair<double, double>> passive_lever_arms(const std::vector<SolvedMuscle>& readings) {
  std::map<double, double> lengths;
  for (const SolvedMuscle& s : readings) {
    if (s.activation < same) lengths[s.q_rad] = s.length_m;
  }
  if (lengths.size() < 4) return {};
  std::vector<double> q, length;
  for (const auto& [angle, l] : lengths) q.push_back(angle), length.push_back(l);
  const std::vector<double> arms = tendon_displacement_lever_arms(q, length);
  std::vector<std::pair<double, double>> out;
  for (std::size_t i = 0; i < q.size(); ++i) out.emplace_back(q[i], arms[i]);
  return out;
}

}  // namespace brachium::fem
