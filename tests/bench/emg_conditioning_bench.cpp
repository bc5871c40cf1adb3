/// Time of the conditioning chain and of the activation dynamics on one core.
///
///   emg_conditioning_bench                  prints both
///   emg_conditioning_bench SIGNALS RESULT   writes the 16 raw channels and their envelopes (native doubles), for
///                                           emg_conditioning_bench.py, which times the same chain in scipy beside it

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "emg/activation.hpp"
#include "emg/conditioning.hpp"
#include "emg/random.hpp"

namespace {

// CPU time of the process: what other programs do on the machine does not count.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void save(const std::string& file, const std::vector<std::vector<double>>& channels) {
  std::ofstream out(file, std::ios::binary);
  for (const auto& x : channels) {
    out.write(reinterpret_cast<const char*>(x.data()),
              static_cast<std::streamsize>(x.size() * sizeof(double)));
  }
}

double time_conditioning(std::vector<std::vector<double>>& channels) {
  brachium::emg::ConditioningOptions options;  // offset, high-pass 30 Hz, rectify, low-pass 6 Hz, zero lag
  options.cutoff = brachium::emg::CutoffConvention::per_pass;
  options.offset_edge_s = 0.0;
  options.trim_edges = false;
  const std::vector<std::string> names(channels.size(), "emg");
  const auto raw = channels;
  double best = 1e9;
  for (int repeat = 0; repeat < 9; ++repeat) {
    channels = raw;
    std::vector<std::span<double>> spans(channels.begin(), channels.end());
    const double start = cpu_seconds();
    condition(brachium::emg::design_conditioning(options, 2000.0), spans, names, "bench");
    best = std::min(best, (cpu_seconds() - start));
  }
  return best;
}

double time_activation(bool with_tangents) {
  std::vector<double> e(2000), a(e.size()), u(e.size()), t1(e.size()), t2(e.size()), t3(e.size()),
      t4(e.size()), t5(e.size());
  for (std::size_t k = 0; k < e.size(); ++k) e[k] = 0.5 + 0.4 * std::sin(0.03 * static_cast<double>(k));
  const brachium::data::ActivationParameters p{0.0371, 0.012, 0.041, -1.5};
  double best = 1e9;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double start = cpu_seconds();
    for (int i = 0; i < 200; ++i) {
      if (with_tangents) {
        brachium::emg::activate_with_tangents({}, p, e, 200.0, a, {u, t1, t2, t3, t4, t5});
      } else {
        brachium::emg::activate({}, p, e, 200.0, a);
      }
    }
    best = std::min(best, (cpu_seconds() - start) / (200.0 * static_cast<double>(e.size())));
  }
  return best;
}

}  // namespace

int main(int argc, char** argv) {
  brachium::emg::Random random(1);
  std::vector<std::vector<double>> channels(16, std::vector<double>(120000));
  for (auto& x : channels) {
    for (double& v : x) v = 1e-4 * random.normal() + 1e-3;
  }
  if (argc == 3) save(argv[1], channels);
  const double seconds = time_conditioning(channels);
  if (argc == 3) save(argv[2], channels);
  std::printf("conditioning 16 channels x 60 s x 2 kHz: %.6f s CPU (best of 9)\n", seconds);
  std::printf("activation: %.1f ns a sample, with all five tangents %.1f ns\n", 1e9 * time_activation(false),
              1e9 * time_activation(true));
  return 0;
}
