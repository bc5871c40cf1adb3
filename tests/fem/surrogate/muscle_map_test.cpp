// The map of a muscle's states and the samples taken from it.

#include "fem/surrogate/muscle_map.hpp"

#include "data/model/error.hpp"
#include "fem/surrogate/tensor.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

MuscleMap map_of(std::size_t n_theta, std::size_t n_alpha) {
  MuscleMap map{"triceps", "rigid-tendon", elbow(), {}, {}};
  for (const StatePoint& p :
       grid_states(equidistant(10.0 * deg, 150.0 * deg, n_theta), equidistant(0.0, 1.0, n_alpha))) {
    const OutputValue F = muscle(p.theta_rad, p.activation);
    MuscleState s;
    s.at = p;
    s.force_n = F.value;
    s.force_gradient = Gradient{F.dtheta, F.dalpha};
    s.moment_n_m = -0.02 * F.value;
    s.moment_gradient = Gradient{-0.02 * F.dtheta, -0.02 * F.dalpha};
    s.vrla_m = 0.02;
    s.stability = StateStability::stable;
    map.states.push_back(s);
  }
  return map;
}

TEST(MuscleMap, GivesSamplesWithDerivativesWhereEveryOutputHasThem) {
  const MuscleMap map = map_of(5, 3);
  const MapSamples both = samples_of(map, {MapOutput::force, MapOutput::moment});
  EXPECT_TRUE(both.set.has_derivatives());
  EXPECT_EQ(both.set.outputs, (std::vector<std::string>{"force_n", "moment_n_m"}));
  EXPECT_NO_THROW(hermite_surrogate(as_grid(both.set)));
  const MapSamples arms = samples_of(map, {MapOutput::force, MapOutput::vrla});
  EXPECT_FALSE(arms.set.has_derivatives());
  EXPECT_NO_THROW(tensor_spline(as_grid(arms.set)));
}

TEST(MuscleMap, LeavesOutUnstableAndFailedStatesByName) {
  MuscleMap map = map_of(5, 3);
  map.states[4].stability = StateStability::unstable;
  map.failed.push_back({map.states[7].at, "J below 0"});
  map.states.erase(map.states.begin() + 7);
  const MapSamples samples = samples_of(map, {MapOutput::force});
  EXPECT_EQ(samples.set.size(), 13u);
  ASSERT_EQ(samples.left_out.size(), 2u);
  EXPECT_EQ(samples.left_out[0].reason, "J below 0");
  EXPECT_EQ(samples.left_out[1].reason, "unstable");
}

TEST(MuscleMap, NamesTheStateThatLacksAnOutput) {
  MuscleMap map = map_of(3, 2);
  EXPECT_THROW(samples_of(map, {MapOutput::tdm}), data::InputError);
  EXPECT_THROW(samples_of(map, {MapOutput::mean_fibre_stretch}), data::InputError);
}

TEST(MuscleMap, RefusesStatesOutsideTwiceOrNotFinite) {
  MuscleMap map = map_of(3, 2);
  EXPECT_NO_THROW(map.check());
  EXPECT_NE(map.find({80.0 * deg, 1.0}), nullptr);
  EXPECT_EQ(map.find({81.0 * deg, 1.0}), nullptr);
  MuscleMap twice = map, outside = map, broken = map;
  twice.states.push_back(map.states[2]);
  outside.states[0].at.theta_rad = 0.0;
  broken.states[0].force_n = std::nan("");
  for (const MuscleMap* m : {&twice, &outside, &broken}) EXPECT_THROW(m->check(), data::InputError);
}

TEST(MuscleMap, AsATableHasARowForEveryStateAndEveryFailure) {
  MuscleMap map = map_of(3, 2);
  map.failed.push_back({{0.5, 0.5}, "no convergence"});
  const data::Table table = map.table();
  EXPECT_EQ(table.rows(), 7u);
  EXPECT_EQ(table.texts("outcome").back(), "failed: no convergence");
  EXPECT_NEAR(table.numbers("angle_deg")[2], 80.0, 1e-12);
  EXPECT_TRUE(std::isnan(table.numbers("force_N").back()));
}

}  // namespace
}  // namespace brachium::fem::test
