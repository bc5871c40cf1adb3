/// Time to the optimum of two calibrations on noise-free twins, rigid and elastic tendon:
///   elbow12  7 muscles, 12 parameters (C1, C2, A, seven slack lengths, two strength groups), 2 trials x 10 s
///   at 200 Hz,
///            the curves and the recursion of CEINMS, one thread; asked for: 0.5 s rigid, 5 s elastic
///   elbow20  7 muscles, 20 parameters, 6 trials x 30 s at 200 Hz, two threads; asked for: 5 s rigid, 30 s
///   elastic
/// elbow12 uses three starts: the first ends in a local optimum in which two heads of the triceps have
/// swapped their errors. Time counts everything from trials in memory to a subject with verdicts. Exit code 1 where
/// a time is exceeded or a parameter is not found to 1e-6 of its bounds' half width. Run:
///   optimise_calibration_bench SCENE_FILE [GEOMETRY_CSV]
/// with pipelines/scenes/elbow_twin.toml and, for elbow12 on the very elbow of the reference, its geometry.csv (muscle,
/// moment arm r_c0.., length l_c0.. as coefficients of the angle; the muscles' parameters are the same).

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "data/io/csv.hpp"
#include "data/io/scene_file.hpp"
#include "optimise/calibration.hpp"
#include "optimise/twin.hpp"

namespace {

using namespace brachium;
using namespace brachium::optimise;

FreeQuantity free_quantity(optimise::Quantity quantity, Scope scope) {
  FreeQuantity f;
  f.quantity = quantity;
  f.scope = scope;
  return f;
}

TwinOptions random_trials(int count, double duration_s) {
  TwinOptions options;
  options.raw_emg = false;
  for (int t = 0; t < count; ++t) {
    TwinTrial trial;
    trial.name = fmt::format("random-{}", t + 1);
    trial.duration_s = duration_s;
    trial.lower_rad = 0.35;
    trial.upper_rad = 2.1;
    trial.effort = 0.7;
    options.trials.push_back(trial);
  }
  return options;
}

/// Every muscle with a channel of its own, flexors and extensors as groups, the recursion's coefficients -0.4
/// and -0.6.
data::Scene twelve(data::Scene scene) {
  for (data::SceneMuscle& m : scene.muscles) {
    m.group = m.name.starts_with("TRI") ? "extensors" : "flexors";
    m.drive = {};
    m.drive.kind = data::MuscleDrive::Kind::channels;
    m.drive.channels = {{m.name, 1.0}};
    m.activation.delay_s = 0.0;
    m.activation.time_constant_1_s = emg::time_constant(-0.4, 200.0);
    m.activation.time_constant_2_s = emg::time_constant(-0.6, 200.0);
  }
  return scene;
}

/// The scene with the paths of a table of polynomials.
data::Scene with_paths(data::Scene scene, const std::filesystem::path& file) {
  std::ifstream table(file);
  std::string line;
  std::size_t replaced = 0;
  for (std::getline(table, line); std::getline(table, line);) {
    const std::vector<std::string> fields = io::split_fields(line, ",");
    for (data::SceneMuscle& m : scene.muscles) {
      if (m.name != fields.at(0)) continue;
      m.path.moment_arm_m.clear();
      m.path.length_m.clear();
      for (std::size_t k = 1; k <= 4; ++k) m.path.moment_arm_m.push_back(std::stod(fields.at(k)));
      for (std::size_t k = 5; k <= 9; ++k) m.path.length_m.push_back(std::stod(fields.at(k)));
      ++replaced;
    }
  }
  if (replaced != scene.muscles.size())
    throw data::InputError("missing-row", fmt::format("{} of {} muscles have a path in {}", replaced,
                                                      scene.muscles.size(), file.string()));
  return scene;
}

data::Scene disturbed(data::Scene scene) {
  double sign = 1.0;
  for (data::SceneMuscle& m : scene.muscles) {
    sign = -sign;
    m.parameters.strength = 1.2;
    m.parameters.tendon_slack_length_m *= 1.0 + 0.03 * sign;
    m.activation.shape = -0.9;
    if (m.activation.delay_s > 0.0) {
      m.activation.delay_s = 0.055;
      m.parameters.optimal_fibre_length_m *= 1.0 - 0.04 * sign;
    } else {
      m.activation.time_constant_1_s = emg::time_constant(-0.3, 200.0);
      m.activation.time_constant_2_s = emg::time_constant(-0.7, 200.0);
    }
  }
  return scene;
}

/// Largest |fitted - true| over the bounds' half width.
double worst_error(const CalibrationResult& result, const CalibrationProblem& truth) {
  const Eigen::VectorXd x = start_of(truth.parameters()), scale = scale_of(truth.parameters());
  return ((result.x - x).cwiseQuotient(scale)).cwiseAbs().maxCoeff();
}

bool run(const std::string& name, const data::Scene& truth, TwinOptions twin,
         CalibrationProblemOptions problem, std::size_t starts, double asked_s) {
  problem.coordinate = truth.coordinates[0].name;
  twin.model = problem.model;
  const auto trials = noise_free_trials(make_twin(truth, twin), problem.coordinate);
  const CalibrationProblem at_truth(truth, trials, problem);
  CalibrationOptions options;
  options.problem = problem;
  options.solver.starts = starts;
  const std::clock_t cpu_begin = std::clock();
  const auto begin = std::chrono::steady_clock::now();
  const CalibrationResult result = calibrate(disturbed(truth), trials, options);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double cpu = static_cast<double>(std::clock() - cpu_begin) / CLOCKS_PER_SEC;
  fmt::print(
      "{:<8} {:<8} {:>6} parameters {:>8} residuals {:>4} evaluations  cost {:9.2e}  worst error {:8.1e}  "
      "{:7.3f} s, CPU {:7.3f} s (asked {} s)  {}\n",
      name, hill::to_string(problem.model.tendon), at_truth.parameters().size(), at_truth.residual_count(),
      result.summary.evaluations, result.summary.cost, worst_error(result, at_truth), seconds, cpu, asked_s,
      result.summary.reason);
  return seconds <= asked_s && worst_error(result, at_truth) < 1e-6;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    fmt::print(stderr, "usage: optimise_calibration_bench SCENE_FILE [GEOMETRY_CSV]\n");
    return 2;
  }
  using enum optimise::Quantity;
  const data::Scene scene = io::read_scene(argv[1]);
  const data::Scene reference = argc == 3 ? with_paths(scene, argv[2]) : scene;
  bool good = true;
  for (const hill::TendonKind tendon : {hill::TendonKind::rigid, hill::TendonKind::elastic}) {
    const bool rigid = tendon == hill::TendonKind::rigid;
    CalibrationProblemOptions small;
    small.model.curves = "lloyd_2003";
    small.model.tendon = tendon;
    small.model.optimal_length_coupling = 0.15;
    small.model.activation.form = emg::ActivationForm::recursive;
    small.model.recursion_rate_hz = 200.0;
    small.free = {free_quantity(recursion_1, Scope::global), free_quantity(recursion_2, Scope::global),
                  free_quantity(shape, Scope::global), free_quantity(tendon_slack_length, Scope::each),
                  free_quantity(strength, Scope::group)};
    good = run("elbow12", twelve(reference), random_trials(2, 10.0), small, 3, rigid ? 0.5 : 5.0) && good;
    CalibrationProblemOptions large;
    large.model.tendon = tendon;
    large.threads = 2;
    large.free = {free_quantity(strength, Scope::group), free_quantity(tendon_slack_length, Scope::each),
                  free_quantity(optimal_fibre_length, Scope::each), free_quantity(delay, Scope::global),
                  free_quantity(shape, Scope::global)};
    good = run("elbow20", scene, random_trials(6, 30.0), large, 1, rigid ? 5.0 : 30.0) && good;
  }
  return good ? 0 : 1;
}
