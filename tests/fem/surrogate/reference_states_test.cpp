// Surrogates through the 49 published states of the Upper Limb Model, where they are at hand: the regular
// sparse grid of level 4 without boundary (Valentin 2019, doi:10.18419/opus-10504, ch. 7), and a smooth
// stand-in through the same states.

#include <algorithm>
#include <fstream>
#include <sstream>

#include "fem/surrogate/sparse_spline.hpp"
#include "surrogate_cases.hpp"

namespace brachium::fem::test {
namespace {

std::vector<StatePoint> published_states() {
  std::vector<StatePoint> states;
  const SparseGrid grid = SparseGrid::regular(SparseBoundary::modified, 4);
  for (const SparseIndex& p : grid.points()) states.push_back(state_of(p, elbow()));
  return states;
}

// Published for the model itself: relative L2 error 3.31 and 3.56 permille.
TEST(PublishedStates, GiveASmoothStandInToTheErrorOfThePublishedSurrogate) {
  ASSERT_EQ(published_states().size(), 49u);
  const Surrogate s =
      sparse_surrogate(sample(published_states(), {muscle}, false), elbow(), SparseBoundary::modified);
  const SampleSet known =
      sample(grid_states(equidistant(10.0 * deg, 150.0 * deg, 29), equidistant(0.0, 1.0, 17)), {muscle});
  EXPECT_LT(error_at(s, known).outputs[0].relative_l2, 5e-3);
}

// F at alpha = 0 and 1, seven angles, of the same model (same source); the surrogate extrapolates there.
struct Passive {
  double angle_deg, triceps0, triceps1, biceps0, biceps1;
};
constexpr Passive table[] = {{10, 24.5, 337.9, 391.7, 716.7},   {45, 157.2, 632.2, 242.2, 600.0},
                             {60, 242.8, 773.0, 182.6, 535.8},  {80, 368.6, 948.8, 124.9, 428.2},
                             {90, 424.8, 1021.3, 102.0, 366.8}, {115, 499.6, 1114.4, 50.0, 202.5},
                             {150, 452.7, 1013.0, 1.0, 35.4}};

TEST(PublishedStates, InterpolatedAreSane) {
  const std::string folder = BRACHIUM_REFERENCE_DIR;
  std::ifstream file(folder + "/upper_limb_forces_49.csv");
  if (folder.empty() || !file) GTEST_SKIP() << "the published states are not at hand";
  SampleSet set{{"triceps_n", "biceps_n"}, {}};
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line.front() == '#' || line.starts_with("theta")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream row(line);
    double theta = 0.0, alpha = 0.0, triceps = 0.0, biceps = 0.0;
    row >> theta >> alpha >> triceps >> biceps;
    set.samples.push_back({{theta * deg, alpha}, Eigen::Vector2d(triceps, -biceps)});
  }
  ASSERT_EQ(set.size(), 49u);
  const Surrogate s = sparse_surrogate(set, elbow(), SparseBoundary::modified);
  std::vector<OutputValue> out(2);
  for (const Sample& x : set.samples) {
    s.evaluate(x.at.theta_rad, x.at.activation, out);
    EXPECT_NEAR(out[0].value, x.value(0), 1e-8);
    EXPECT_NEAR(out[1].value, x.value(1), 1e-8);
  }
  for (const StatePoint& p :
       grid_states(equidistant(10.0 * deg, 150.0 * deg, 57), equidistant(0.0, 1.0, 21))) {
    s.evaluate(p.theta_rad, p.activation, out);
    EXPECT_GT(out[0].dalpha, 0.0) << p.theta_rad / deg << " deg, " << p.activation;
    EXPECT_GT(out[1].dalpha, 0.0) << p.theta_rad / deg << " deg, " << p.activation;
  }
  // Inside the range of angles only activation is extrapolated, by a sixteenth and more; at its ends the
  // angle is as well, and the corner at 10 deg without activation is off by 45 N of 392 N: what the published
  // choice of states leaves open.
  for (const Passive& row : table) {
    const bool end = row.angle_deg < 20.0 || row.angle_deg > 140.0;
    for (const double alpha : {0.0, 1.0}) {
      s.evaluate(row.angle_deg * deg, alpha, out);
      EXPECT_NEAR(out[0].value, alpha == 0.0 ? row.triceps0 : row.triceps1, end ? 10.0 : 1.5)
          << row.angle_deg;
      EXPECT_NEAR(out[1].value, alpha == 0.0 ? row.biceps0 : row.biceps1, end ? 50.0 : 4.5) << row.angle_deg;
    }
  }
}

}  // namespace
}  // namespace brachium::fem::test
