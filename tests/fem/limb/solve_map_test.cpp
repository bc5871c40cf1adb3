// Maps: the same figures as states solved one by one, for any number of threads, and known states are not
// solved again.

#include "fem/limb/solve_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "fem/limb/upper_limb.hpp"

namespace brachium::fem {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

std::vector<MapRequest> both_muscles(const std::vector<StatePoint>& wanted) {
  LimbMesh coarse;
  coarse.belly_cells = 4;
  const UpperLimb arm = generic_arm(coarse);
  std::vector<MapRequest> requests;
  for (const MuscleBody& body : {arm.biceps, arm.triceps})
    requests.push_back({body, arm.range, arm.hinge, arm.humerus, {}, wanted, {}});
  return requests;
}

using Figures = std::map<std::tuple<std::size_t, double, double>, SolvedMuscle>;

Figures solved(const std::vector<MapRequest>& requests, std::size_t threads) {
  Figures figures;
  const auto outcomes = solve_maps(requests, threads, [&](const MapState& s) {
    EXPECT_TRUE(
        figures.emplace(std::tuple(s.muscle, s.reading.q_rad, s.reading.activation), s.reading).second);
    EXPECT_EQ(s.solved.configuration.activation[0], s.reading.activation);
  });
  for (const MapOutcome& o : outcomes) EXPECT_TRUE(o.failed.empty()) << o.failed.front().reason;
  return figures;
}

TEST(MuscleMaps, DoNotDependOnThreadsAndAddThePassiveStatesOfTheirAngles) {
  const std::vector<MapRequest> requests =
      both_muscles({{100.0 * degree, 0.6}, {60.0 * degree, 0.3}, {60.0 * degree, 0.6}});
  const Figures one = solved(requests, 1), two = solved(requests, 2);
  ASSERT_EQ(one.size(), 10u) << "five states of each muscle";
  ASSERT_EQ(two.size(), one.size());
  for (const auto& [key, reading] : one) {
    EXPECT_EQ(reading.force_n, two.at(key).force_n);
    EXPECT_EQ(reading.from_q_rad, two.at(key).from_q_rad);
  }
  MuscleStates alone(requests[0].body, requests[0].range, requests[0].hinge, requests[0].bones);
  const double force = alone.solve_state(60.0 * degree, 0.6).force_n;
  EXPECT_NEAR(one.at({0, 60.0 * degree, 0.6}).force_n, force, 1e-6 * force);
}

TEST(MuscleMaps, LeaveOutWhatIsKnown) {
  std::vector<MapRequest> requests = both_muscles({{100.0 * degree, 0.5}, {120.0 * degree, 0.0}});
  requests[0].known = {{100.0 * degree, 0.0}, {120.0 * degree, 0.0}};
  requests[1].known = states_of(requests[1]);
  const Figures rest = solved(requests, 1);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest.begin()->first, std::tuple(std::size_t{0}, 100.0 * degree, 0.5));
}

TEST(MuscleMaps, NameWhatCannotBeReachedAndGoOn) {
  std::vector<MapRequest> requests = both_muscles({{100.0 * degree, 1.0}, {140.0 * degree, 0.0}});
  requests[0].body.material.max_stress_pa = 3e8;  // a thousand times too strong: cells invert
  requests[0].options.solve.smallest_step = 0.25;
  requests[0].options.solve.on_instability = "fail";
  std::vector<std::pair<std::size_t, double>> reached;
  const auto outcomes = solve_maps(
      requests, 1, [&](const MapState& s) { reached.emplace_back(s.muscle, s.reading.activation); });
  ASSERT_EQ(outcomes[0].failed.size(), 1u);
  EXPECT_EQ(outcomes[0].failed[0].at.activation, 1.0);
  EXPECT_NE(outcomes[0].failed[0].reason.find("from 100 deg, activation 0: "), std::string::npos);
  EXPECT_TRUE(outcomes[1].failed.empty());
  EXPECT_EQ(reached.size(), 5u) << "two passive states of the one, three states of the other";
}

TEST(MuscleMaps, AnObserverThatThrowsEndsTheRun) {
  struct Stop {};
  const auto requests = both_muscles({{140.0 * degree, 0.0}});
  EXPECT_THROW(solve_maps(requests, 1, [](const MapState&) { throw Stop(); }), Stop);
}

TEST(MuscleMaps, PassiveLengthsGiveTheLeverArmOfAStraightLine) {
  // L = sqrt(a^2 + b^2 + 2 a b cos q): r = a b sin q / L.
  const double a = 0.30, b = 0.04;
  std::vector<SolvedMuscle> states;
  for (double q = 0.2; q < 2.6; q += 0.1) {
    SolvedMuscle s;
    s.q_rad = q;
    s.length_m = std::sqrt(a * a + b * b + 2.0 * a * b * std::cos(q));
    states.push_back(s);
    s.activation = 1.0;
    s.length_m = 1.0;  // active states say nothing of it
    states.push_back(s);
  }
  for (const auto& [q, arm] : passive_lever_arms(states))
    EXPECT_NEAR(arm, a * b * std::sin(q) / std::sqrt(a * a + b * b + 2.0 * a * b * std::cos(q)), 2e-5);
  states.resize(6);
  EXPECT_TRUE(passive_lever_arms(states).empty()) << "three angles are too few";
}

}  // namespace
}  // namespace brachium::fem
