// Cost of continuum muscles over a hinge: a first state, and a map of 7 angles x 7 activations of each
// muscle.
//
//   fem_limb_bench [belly_cells core_cells ring_cells [map]]      default 16 2 2: about 1e4 unknowns
//
// Asked at about 1e4 unknowns, one core: a state 10 s cold, 1 s in a sweep; the map of both muscles in 240 s
// on two.

#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <numbers>
#include <string>

#include "data/model/error.hpp"
#include "fem/limb/upper_limb.hpp"

namespace {

using namespace brachium;
using namespace brachium::fem;

constexpr double degree = std::numbers::pi / 180.0;

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Totals {
  long states = 0, failed = 0, unstable = 0, newton = 0, chord = 0, steps = 0;
  double seconds = 0.0, worst = 0.0;
};

void row(const SolvedMuscle& s) {
  fmt::print("{:7.1f} {:6.3f} {:9.2f} {:9.2f} {:6d} {:6d} {:6d} {:9.3f}  {}\n", s.q_rad / degree,
             s.activation, s.force_n, s.contacts.empty() ? 0.0 : s.contacts.front().force_n, s.steps,
             s.newton_iterations, s.chord_iterations, s.seconds, s.stability);
}

Totals map_of(MuscleStates& states) {
  Totals t;
  for (int i = 0; i < 7; ++i) {
    for (int k = 0; k < 7; ++k) {
      const double q =
          states.range().lower_rad + (states.range().upper_rad - states.range().lower_rad) * i / 6.0;
      ++t.states;
      try {
        const SolvedMuscle& s = states.solve_state(q, k / 6.0);
        row(s);
        t.newton += s.newton_iterations;
        t.chord += s.chord_iterations;
        t.steps += s.steps;
        t.seconds += s.seconds;
        t.worst = std::max(t.worst, s.seconds);
        if (s.stability != "stable") ++t.unstable;
      } catch (const data::ConvergenceFailure& failure) {
        ++t.failed;
        fmt::print("{:7.1f} {:6.3f}  FAILED: {}\n", q / degree, k / 6.0, failure.what());
      }
    }
  }
  return t;
}

}  // namespace

int main(int argc, char** argv) {
  LimbMesh mesh{16, 2, 2};
  if (argc >= 4) mesh = {std::atoi(argv[1]), std::atoi(argv[2]), std::atoi(argv[3])};
  const bool map = argc < 4 || argc > 4;
  const UpperLimb arm = generic_arm(mesh);
  const auto whole = std::chrono::steady_clock::now();
  for (const MuscleBody* body : {&arm.biceps, &arm.triceps}) {
    const auto start = std::chrono::steady_clock::now();
    MuscleStates states(*body, arm.range, arm.hinge, arm.humerus);
    const double in_situ = seconds_since(start);
    fmt::print("{}: {} unknowns; built and brought to its place in {:.3f} s\n", body->name, states.unknowns(),
               in_situ);
    fmt::print("  q deg  activ   force N contact N  steps newton  chord   seconds\n");
    const auto cold = std::chrono::steady_clock::now();
    row(states.solve_state(80.0 * degree, 1.0));
    fmt::print("cold state: {:.3f} s\n", in_situ + seconds_since(cold));
    if (!map) continue;
    const Totals t = map_of(states);
    fmt::print(
        "map: {} states, {} failed, {} unstable; {} steps, {} Newton and {} chord iterations; {:.2f} s, a "
        "state "
        "{:.3f} s, the slowest {:.3f} s\n",
        t.states, t.failed, t.unstable, t.steps, t.newton, t.chord, t.seconds,
        t.seconds / static_cast<double>(t.states - t.failed), t.worst);
  }
  fmt::print("whole: {:.2f} s\n", seconds_since(whole));
}
