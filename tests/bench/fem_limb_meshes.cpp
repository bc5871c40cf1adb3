// The generic arm's muscles from coarse to fine meshes: whether every state is reached and stable, in three
// orders that are shuffled, by how much the order matters (a coarse muscle may have two stable shapes at a
// state; share of its largest force), and what the mesh makes of forces and moments. Exit code 1 where a state
// is not reached or is unstable.
//
//   fem_limb_meshes [fine]        fine: also meshes that take minutes
//
// Moments about the hinge: of the reactions (consistent nodal forces), of the stress through the middle of
// the belly with the contact beyond it, and of the stress in the clamped face itself. Differences are over
// the largest moment of the muscle's states.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "data/model/error.hpp"
#include "fem/limb/upper_limb.hpp"
#include "fem/quantities/stress_wrench.hpp"

namespace {

using namespace brachium;
using namespace brachium::fem;

constexpr double degree = std::numbers::pi / 180.0;

struct State {
  double angle_deg, activation;
};

std::vector<State> shuffled_states(unsigned seed) {
  std::vector<State> states;
  for (double q = 10.0; q <= 150.0; q += 20.0)
    for (const double a : {0.0, 0.25, 0.5, 0.75, 1.0}) states.push_back({q, a});
  std::shuffle(states.begin(), states.end(), std::mt19937(seed));
  return states;
}

struct Row {
  int reached = 0, unstable = 0;
  double moment = 0.0, by_section = 0.0, by_face = 0.0, force_n = 0.0, passive_n = 0.0, penetration_m = 0.0;
  double greatest_n = 0.0, spread_n = 0.0;               ///< of the forces; over the orders
  std::map<std::pair<double, double>, double> forces_n;  ///< by angle and activation, as first reached
};

void add(const MuscleStates& muscle, const Discretisation& discretisation, const SolvedMuscle& s,
         const State& at, Row& row) {
  ++row.reached;
  if (s.stability != "stable") {
    ++row.unstable;
    fmt::print("  {} at {} deg, activation {}: {}\n", muscle.body().name, at.angle_deg, at.activation,
               s.stability);
  }
  const Wrench face =
      stress_wrench(muscle.problem(), discretisation, muscle.solved(s.q_rad, s.activation).configuration,
                    "insertion", Eigen::Vector3d::Zero());
  const double first = row.forces_n.try_emplace({at.angle_deg, at.activation}, s.force_n).first->second;
  row.greatest_n = std::max(row.greatest_n, s.force_n);
  row.spread_n = std::max(row.spread_n, std::abs(s.force_n - first));
  row.moment = std::max(row.moment, std::abs(s.arms.moment_n_m));
  row.by_section = std::max(row.by_section, std::abs(s.moment_by_stress_n_m - s.arms.moment_n_m));
  row.by_face = std::max(row.by_face, std::abs(face.moment_n_m.z() - s.arms.moment_n_m));
  for (const BoneContact& c : s.contacts)
    row.penetration_m = std::max(row.penetration_m, c.greatest_penetration_m);
  if (at.angle_deg == 90.0 && at.activation == 1.0) row.force_n = s.force_n;
  if (at.angle_deg == 90.0 && at.activation == 0.0) row.passive_n = s.force_n;
}

bool study(const LimbMesh& mesh, bool biceps) {
  const UpperLimb arm = generic_arm(mesh);
  const auto start = std::chrono::steady_clock::now();
  Row row;
  int unknowns = 0, asked = 0;
  for (const unsigned seed : {1u, 2u, 3u}) {
    MuscleStates muscle(biceps ? arm.biceps : arm.triceps, arm.range, arm.hinge, arm.humerus);
    const Discretisation discretisation(muscle.problem().mesh, muscle.problem().formulation);
    unknowns = static_cast<int>(muscle.unknowns());
    for (const State& s : shuffled_states(seed)) {
      ++asked;
      try {
        add(muscle, discretisation, muscle.solve_state(s.angle_deg * degree, s.activation), s, row);
      } catch (const data::ConvergenceFailure& failure) {
        fmt::print("  FAILED: {}\n", failure.what());
      }
    }
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print(
      "{:<8} {:3d} {:2d} {:2d} {:6d} {:4d}/{} {:9d} {:9.2f} {:9.2f} {:9.2f} {:9.2f} {:8.3f} {:8.1e} "
      "{:8.2f}\n",
      biceps ? arm.biceps.name : arm.triceps.name, mesh.belly_cells, mesh.core_cells, mesh.ring_cells,
      unknowns, row.reached, asked, row.unstable, row.passive_n, row.force_n,
      100.0 * row.by_section / row.moment, 100.0 * row.by_face / row.moment, 1e3 * row.penetration_m,
      row.spread_n / row.greatest_n, seconds);
  std::fflush(stdout);
  return row.reached == asked && row.unstable == 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<LimbMesh> meshes{{3, 1, 1}, {4, 1, 1}, {6, 1, 1}, {8, 1, 1}, {8, 2, 1}, {8, 2, 2}, {12, 2, 2}};
  if (argc > 1 && std::string(argv[1]) == "fine") {
    meshes.push_back({16, 2, 2});
    meshes.push_back({16, 3, 2});
  }
  fmt::print(
      "                                            90 deg, N          moment off by, %    penetr.   "
      "orders\n");
  fmt::print(
      "muscle     mesh    unknowns reached unstable passive   active   section      face      mm   differ  "
      "seconds\n");
  bool met = true;
  for (const LimbMesh& mesh : meshes) {
    for (const bool biceps : {true, false}) met = study(mesh, biceps) && met;
  }
  return met ? 0 : 1;
}
