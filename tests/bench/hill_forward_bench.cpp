// Speed of the forward chain, one core: activation, fibre kinematics, force, moment, in muscle-frames per
// second. Seven muscles over 20 s at 200 Hz: lengths and moment arms of a slow curl, excitations of
// co-contracting muscles. Exit code 1 where a measured chain without tangents is slower than the least that is asked:
// 15 million muscle-frames per second of CPU time rigid, 3 million elastic. The machine must be quiet: work on the other
// thread of a core halves all figures.
//
//   ./hill_forward_bench --benchmark_min_time=1

#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "emg/activation.hpp"
#include "hill/forward.hpp"
#include "tests/bench/judged.hpp"

namespace {

using namespace brachium;

struct Muscle {
  data::MuscleParameters parameters;
  double length_m, amplitude_m, arm_m;
};

// arm26 (OpenSim), lengths near the middle of the elbow's range.
std::vector<Muscle> elbow() {
  const auto make = [](double f0, double lo, double ls, double phi, double amplitude, double arm) {
    data::MuscleParameters p;
    p.max_isometric_force_N = f0;
    p.optimal_fibre_length_m = lo;
    p.tendon_slack_length_m = ls;
    p.pennation_at_optimal_rad = phi;
    return Muscle{p, lo * std::cos(phi) * 0.95 + ls * 1.005, amplitude, arm};
  };
  return {
      make(798.52, 0.134, 0.143, 0.20944, 0.012, -0.021),  make(624.3, 0.1138, 0.098, 0.15708, 0.012, -0.021),
      make(624.3, 0.1138, 0.0908, 0.15708, 0.012, -0.021), make(624.3, 0.1157, 0.2723, 0.0, -0.015, 0.038),
      make(435.56, 0.1321, 0.1923, 0.0, -0.015, 0.038),    make(987.26, 0.0858, 0.0535, 0.0, -0.010, 0.024),
      make(261.33, 0.1726, 0.133, 0.0, -0.030, 0.053)};
}

struct Trial {
  static constexpr double kRate = 200.0;
  static constexpr std::size_t kFrames = 4000;
  std::vector<std::vector<double>> length, velocity, arm, excitation;

  Trial() {
    const std::vector<Muscle> muscles = elbow();
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      std::vector<double> L(kFrames), V(kFrames), r(kFrames), e(kFrames);
      for (std::size_t k = 0; k < kFrames; ++k) {
        const double t = static_cast<double>(k) / kRate, w = 2.0 * std::numbers::pi * 0.4;
        L[k] = muscles[m].length_m + muscles[m].amplitude_m * std::sin(w * t);
        V[k] = muscles[m].amplitude_m * w * std::cos(w * t);
        r[k] = muscles[m].arm_m * (1.0 + 0.1 * std::sin(w * t));
        e[k] = 0.25 + 0.2 * std::sin(1.7 * w * t + 0.8 * static_cast<double>(m)) +
               0.04 * std::sin(23.0 * t + static_cast<double>(m));
      }
      length.push_back(L);
      velocity.push_back(V);
      arm.push_back(r);
      excitation.push_back(e);
    }
  }
};

/// The recursion and the exponential nonlinearity, as an EMG-driven model has them.
void activate(std::span<const double> excitation, std::span<double> activation) {
  const emg::ActivationModel model{emg::ActivationForm::recursive, emg::Nonlinearity::exponential,
                                   emg::StartUp::steady_state};
  emg::RecursionParameters parameters;
  parameters.rate_hz = Trial::kRate;
  emg::activate(model, parameters, excitation, Trial::kRate, activation);
}

void run(benchmark::State& state, const hill::MuscleModelOptions& options, std::size_t tangents) {
  const Trial trial;
  std::vector<hill::MuscleTendon> muscles;
  for (const Muscle& m : elbow())
    muscles.emplace_back("m" + std::to_string(muscles.size()), m.parameters, options);
  hill::MuscleScratch scratch;
  hill::MuscleTrace out;
  std::vector<double> a(Trial::kFrames), moment(Trial::kFrames);
  std::vector<std::vector<double>> derivative(tangents, std::vector<double>(Trial::kFrames));
  for (auto _ : state) {
    std::fill(moment.begin(), moment.end(), 0.0);
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      activate(trial.excitation[m], a);
      std::vector<hill::Tangent> wanted;
      for (std::size_t i = 0; i < tangents; ++i) {
        wanted.push_back({a,
                          i == 0 ? std::optional(hill::MuscleParameter::tendon_slack_length) : std::nullopt,
                          derivative[i]});
      }
      hill::forward(muscles[m], {Trial::kRate, trial.length[m], trial.velocity[m], trial.arm[m]}, a, scratch,
                    out, wanted);
      for (std::size_t k = 0; k < moment.size(); ++k) moment[k] += out.moment_N_m[k];
    }
    benchmark::DoNotOptimize(moment.data());
  }
  state.counters["muscle_frames_per_s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * muscles.size() * Trial::kFrames), benchmark::Counter::kIsRate);
}

void register_chains() {
  const auto add = [](const std::string& name, const hill::MuscleModelOptions& options,
                      std::size_t tangents) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& s) { run(s, options, tangents); });
  };
  for (const std::string& set : hill::CurveSet::names()) {
    hill::MuscleModelOptions options;
    options.curves = hill::CurveSet::named(set);
    add("rigid/" + set, options, 0);
    options.tendon = hill::TendonKind::elastic;
    add("elastic_zero_lag/" + set, options, 0);
    options.velocity = hill::FibreVelocity::causal;
    add("elastic_causal/" + set, options, 0);
    options.velocity = hill::FibreVelocity::none;
    add("elastic_static/" + set, options, 0);
  }
  for (const auto tendon : {hill::TendonKind::rigid, hill::TendonKind::elastic}) {
    const std::string name = hill::to_string(tendon);
    add("ceinms_" + name, hill::ceinms_options(tendon), 0);
    hill::MuscleModelOptions options;
    options.tendon = tendon;
    add("tangents_4_" + name, options, 4);
    add("ceinms_tangents_4_" + name, hill::ceinms_options(tendon), 4);
  }
}

double asked_per_s(const std::string& chain) {
  if (chain.starts_with("tangents") || chain.find("_tangents_") != std::string::npos) return 0.0;
  const bool rigid = chain.starts_with("rigid") || chain == "ceinms_rigid";
  return rigid ? 15e6 : 3e6;
}

std::string too_slow(const benchmark::BenchmarkReporter::Run& run) {
  const double reached = run.counters.at("muscle_frames_per_s"), asked = asked_per_s(run.benchmark_name());
  return reached >= asked ? "" : fmt::format("{:.3g} muscle-frames/s, asked {:.3g}", reached, asked);
}

}  // namespace

int main(int argc, char** argv) {
  register_chains();
  return bench::run_judged(argc, argv, too_slow);
}
