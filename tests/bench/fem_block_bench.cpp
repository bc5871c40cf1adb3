// The clamped active block: 40 x 10 x 10 mm, fibres along x, both ends clamped; stretched, then activated.
// Prints one JSON line with counts, times and the axial force; fem_peer_bench.py runs it beside another
// library.
//
//   fem_block_bench [--cells 24,6,6] [--formulation q2_p1_discontinuous] [--bulk_mpa 100 | inf] [--steps 4]
//                   [--stretch 1.1] [--alpha 0.5] [--threads 1] [--solver ldl] [--ordering automatic]
//                   [--chord on|off]
//                   [--predictor on|off] [--grow on|off] [--stability every_state|phase_ends|off]
//                   [--on_instability relax|report|fail] [--residual 1e-8] [--log on]
// Without a bulk modulus: exactly incompressible (augmented Lagrange, or Taylor-Hood).

#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <sstream>
#include <string>

#include "fem/linear/stopwatch.hpp"
#include "fem/mesh/block.hpp"
#include "fem/mesh/convert.hpp"
#include "fem/solve/log.hpp"
#include "fem/solve/solve.hpp"

namespace {

using namespace brachium;

/// Parameters of this problem only.
fem::MuscleTendon muscle() {
  fem::MuscleTendon m;
  m.muscle = {.c1_pa = 3560.0, .c2_pa = 3860.0, .c3_pa = 0.0357, .c4 = 42.6};
  m.tendon = m.muscle;
  m.max_stress_pa = 0.3e6;
  m.force_length = {.optimal_stretch = 1.2,
                    .ascending_width = 0.25,
                    .ascending_exponent = 3.0,
                    .descending_width = 0.15,
                    .descending_exponent = 4.0};
  return m;
}

double cpu_seconds() {
  rusage u{};
  getrusage(RUSAGE_SELF, &u);
  return static_cast<double>(u.ru_utime.tv_sec + u.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(u.ru_utime.tv_usec + u.ru_stime.tv_usec);
}

std::string quoted(std::string text) {
  for (char& c : text) {
    if (c == '"') c = '\'';
  }
  return '"' + text + '"';
}

}  // namespace

int main(int argc, char** argv) {
  std::map<std::string, std::string> given{{"cells", "24,6,6"},
                                           {"formulation", "q2_p1_discontinuous"},
                                           {"bulk_mpa", "inf"},
                                           {"steps", "4"},
                                           {"stretch", "1.1"},
                                           {"alpha", "0.5"},
                                           {"threads", "1"},
                                           {"solver", "ldl"},
                                           {"ordering", "automatic"},
                                           {"chord", "on"},
                                           {"predictor", "on"},
                                           {"grow", "on"},
                                           {"stability", "every_state"},
                                           {"on_instability", "relax"},
                                           {"residual", "1e-8"},
                                           {"log", "off"},
                                           {"penalty_mpa", "0"}};
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name =
        std::string(argv[i]).substr(std::min<std::size_t>(2, std::string(argv[i]).size()));
    if (!given.contains(name)) {
      std::fputs(fmt::format("unknown option --{}\n", name).c_str(), stderr);
      return 2;
    }
    given[name] = argv[i + 1];
  }
  const double cpu_start = cpu_seconds();
  const fem::Stopwatch watch;
  int nx = 0, ny = 0, nz = 0;
  char comma = 0;
  std::istringstream(given["cells"]) >> nx >> comma >> ny >> comma >> nz;

  fem::Problem problem;
  problem.formulation = fem::formulation_named(given["formulation"]);
  problem.mesh = std::make_shared<data::Mesh>(
      fem::as_type(fem::block({0.04, 0.01, 0.01}, nx, ny, nz), fem::cell_type(problem.formulation)));
  const double bulk = given["bulk_mpa"] == "inf" ? std::numeric_limits<double>::infinity()
                                                 : 1e6 * std::stod(given["bulk_mpa"]);
  problem.materials = {{muscle(), {fem::VolumetricLaw::quadratic, bulk}}};
  const Eigen::Index points = static_cast<Eigen::Index>(fem::cell_quadrature(problem.formulation).size()) *
                              problem.mesh->cell_count();
  problem.tissue.fibre = Eigen::Vector3d::UnitX().replicate(1, points);
  const double stretch = std::stod(given["stretch"]), alpha = std::stod(given["alpha"]);
  problem.conditions = {{"left", "x0", fem::Fixed{}},
                        {"right", "x1", fem::PrescribedDisplacement{{0.04 * (stretch - 1.0), 0.0, 0.0}}}};
  const int steps = std::stoi(given["steps"]);
  if (stretch != 1.0) problem.programme.push_back({"stretch", {{"right", 1.0}}, {}, {}, steps, 1.0});
  if (alpha != 0.0)
    problem.programme.push_back({"activate", {}, {{problem.mesh->regions.front(), alpha}}, {}, steps, 1.0});

  fem::SolveOptions options;
  options.threads = std::stoul(given["threads"]);
  options.linear_solver = given["solver"];
  options.ordering = given["ordering"];
  options.chord = given["chord"] == "on";
  options.predictor = given["predictor"] == "on";
  options.grow_steps = given["grow"] == "on";
  options.stability = given["stability"];
  options.on_instability = given["on_instability"];
  options.relative_residual = std::stod(given["residual"]);
  options.penalty_pa = 1e6 * std::stod(given["penalty_mpa"]);

  double force = 0.0;
  const std::vector<int> right = problem.mesh->surface_points("x1");
  const fem::Summary s = fem::solve(problem, options, [&](const fem::AcceptedState& state) {
    force = 0.0;
    for (const int n : right) force += state.internal_force[3 * n] - state.external_force[3 * n];
  });
  const double cpu = cpu_seconds() - cpu_start;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  if (given["log"] == "on") {
    std::fputs(fem::log_text(s).c_str(), stderr);
    for (const auto& d : s.diagnostics) std::fputs(data::render(d).c_str(), stderr);
  }
  const fem::Stability last = s.steps.empty() ? fem::Stability{} : s.steps.back().stability;
  const double worst_volume = s.steps.empty() ? 0.0 : s.steps.back().worst_volume;
  std::puts(fmt::format("{{\"completed\": {}, \"formulation\": {}, \"cells\": {}, \"bulk_mpa\": {}, "
                        "\"penalty_mpa\": {:.4g}, \"threads\": {}, \"cpu_s\": {:.3f}, "
                        "\"wall_s\": {:.3f}, \"steps\": {}, \"newton_iterations\": {}, \"chord_iterations\": "
                        "{}, \"factorisations\": {}, "
                        "\"augmentations\": {}, \"relaxation_steps\": {}, \"residual_evaluations\": {}, "
                        "\"tangent_evaluations\": {}, "
                        "\"back_substitutions\": {}, \"analyses\": {}, \"cpu_per_full_iteration_s\": {:.4f}, "
                        "\"peak_mb\": {:.1f}, \"force_n\": {:.6f}, "
                        "\"stability\": {}, \"negative_modes\": {}, \"worst_volume\": {:.3g}, "
                        "\"factor_nonzeros\": {:.0f}, \"factor_flops\": {:.4g}, "
                        "\"unknowns\": {}, \"analyse_s\": {:.3f}, \"assembly_s\": {:.3f}, \"factor_s\": "
                        "{:.3f}, \"solve_s\": {:.3f}, \"solver\": {}, "
                        "\"ordering\": {}, \"reason\": {}}}",
                        s.completed, quoted(given["formulation"]), problem.mesh->cell_count(),
                        std::isinf(bulk) ? "null" : fmt::format("{}", 1e-6 * bulk), 1e-6 * s.penalty_pa,
                        options.threads, cpu, watch.seconds(), s.steps.size(), s.newton_iterations,
                        s.chord_iterations, s.factorisations, s.augmentations, s.relaxation_steps,
                        s.residual_evaluations, s.tangent_evaluations, s.back_substitutions, s.analyses,
                        cpu / static_cast<double>(std::max(1L, s.factorisations)),
                        static_cast<double>(usage.ru_maxrss) / 1024.0, force, quoted(last.verdict),
                        last.negative_modes, worst_volume, s.factor_nonzeros, s.factor_flops, s.unknowns,
                        s.analyse_seconds, s.assembly_seconds, s.factor_seconds, s.solve_seconds,
                        quoted(s.linear_solver), quoted(s.ordering), quoted(s.reason))
                .c_str());
  return s.completed ? 0 : 1;
}
