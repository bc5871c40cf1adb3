/// How time and memory grow with the number of unknowns, and what a sweep of activations costs on one mesh:
/// the clamped active block (40 x 10 x 10 mm, quadratic hexahedra, linear pressure per cell, bulk modulus 100
/// MPa).
///   fem_scaling_bench [THREADS]
/// Memory is the process's peak so far; sizes rise. Exit code 1 where a solve does not
/// complete, the peak is 3 GB or more, the largest size has fewer than 1e5 unknowns, or a sweep 0, 0.1, ..., 1
/// needs more than 3 Newton iterations a state on average.

#include <fmt/format.h>
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "fem/quantities/wrench.hpp"
#include "fem/solve/solve.hpp"
#include "tests/fem/verification/study.hpp"

namespace {

using namespace brachium::fem;
using namespace brachium::fem::verification;

Problem block(int n, double stretch) {
  Problem problem;
  problem.mesh = box_mesh({.cells = {4 * n, n, n}, .size_m = Eigen::Vector3d(0.04, 0.01, 0.01)});
  problem.formulation = Formulation::q2_p1_discontinuous;
  problem.materials = {{block_muscle(), {VolumetricLaw::quadratic, 1e8}}};
  problem.tissue = uniform_fibres(*problem.mesh, problem.formulation, Eigen::Vector3d::UnitX());
  problem.conditions = {
      condition("left", "x0", Fixed{}),
      condition("right", "x1",
                RigidMotion{.translation_m = Eigen::Vector3d((stretch - 1.0) * 0.04, 0.0, 0.0)})};
  problem.programme = {phase("stretch", {{"right", 1.0}})};
  return problem;
}

double peak_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

double cpu_s() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

int main(int count, char** arguments) {
  SolveOptions options;
  options.threads = count > 1 ? static_cast<std::size_t>(std::atoi(arguments[1])) : 1;
  options.on_instability = "report";

  fmt::print(
      "stretch 1.1, alpha 0.5\n{:>9} {:>6} {:>6} {:>9} {:>9} {:>9} {:>9} {:>9} {:>10} {:>9} {:>9} {:>10}\n",
      "unknowns", "newton", "chord", "cpu s", "wall s", "analyse", "assemble", "factor", "factor nnz",
      "GFlop", "peak MB", "force N");
  bool met = true;
  long largest = 0;
  for (const int n : {2, 4, 10}) {
    Problem problem = block(n, 1.1);
    problem.programme.push_back(phase("activate", {}, {{"body", 0.5}}));
    const double start = cpu_s();
    const Solved solved = run(problem, options, true);
    const Summary& s = solved.summary;
    fmt::print(
        "{:>9} {:>6} {:>6} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>10.3g} {:>9.2f} {:>9.0f} "
        "{:>10.5f}\n",
        s.unknowns, s.newton_iterations, s.chord_iterations, cpu_s() - start, s.total_seconds,
        s.analyse_seconds, s.assembly_seconds, s.factor_seconds, s.factor_nonzeros, s.factor_flops * 1e-9,
        peak_mb(), solved.reaction("x1")[0]);
    if (!s.completed) fmt::print("    stopped: {}\n", s.reason);
    met = met && s.completed && peak_mb() < 3000.0;
    largest = static_cast<long>(s.unknowns);
    std::fflush(stdout);
  }

  Problem sweep = block(4, 1.1);
  for (int k = 1; k <= 10; ++k)
    sweep.programme.push_back(phase(fmt::format("{:.1f}", 0.1 * k), {}, {{"body", 0.1 * k}}));
  for (const bool reuse : {true, false}) {
    options.chord = reuse;
    fmt::print("\nactivation sweep at stretch 1.1, {}\n{:>6} {:>6} {:>6} {:>6} {:>10} {:<10}\n",
               reuse ? "factors used again" : "a factor for every iteration", "alpha", "steps", "newton",
               "chord", "residual", "state");
    const Summary summary = solve(sweep, options);
    int states = 0;
    double newton = 0.0;
    for (const Phase& phase : sweep.programme) {
      int steps = 0, full = 0, chord = 0;
      const StepRecord* last = nullptr;
      for (const StepRecord& step : summary.steps) {
        if (step.phase != phase.name) continue;
        ++steps;
        full += step.newton_iterations;
        chord += step.chord_iterations;
        last = &step;
      }
      if (last == nullptr) continue;
      fmt::print("{:>6} {:>6} {:>6} {:>6} {:>10.2e} {:<10}\n", phase.name, steps, full, chord,
                 last->relative_residual, last->stability.verdict);
      if (phase.name == "stretch") continue;
      ++states;
      newton += full;
    }
    if (!summary.completed) fmt::print("    stopped: {}\n", summary.reason);
    fmt::print("{:.2f} Newton iterations a state\n", states > 0 ? newton / states : 0.0);
    met = met && summary.completed && newton <= 3.0 * states;
  }
  met = met && largest >= 100000;
  fmt::print("targets {}\n", met ? "met" : "MISSED");
  return met ? 0 : 1;
}
