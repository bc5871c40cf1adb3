/// Do the stated 95 % intervals cover the truth? The stochastic twin over many seeds: EMG as modulated noise
/// at 20 dB, conditioned as recordings are, calibrated, judged. Prints coverage, mean error and mean stated
/// bias per parameter, with and without the correction. Run: optimise_coverage_bench SCENE_FILE [SEEDS,
/// default 100] [REPLICATES, default 20]

#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "data/io/scene_file.hpp"
#include "data/model/parallel.hpp"
#include "tests/optimise/stochastic_twin.hpp"

int main(int argc, char** argv) {
  using namespace brachium;
  using namespace brachium::optimise;
  if (argc < 2) {
    fmt::print(stderr, "usage: optimise_coverage_bench SCENE_FILE [SEEDS] [REPLICATES]\n");
    return 2;
  }
  const data::Scene scene = io::read_scene(argv[1]);
  const auto seeds = static_cast<std::size_t>(argc > 2 ? std::atoi(argv[2]) : 100);
  const int replicates = argc > 3 ? std::atoi(argv[3]) : 20;
  std::vector<tests::StochasticOutcome> outcomes(seeds);
  outcomes[0] = tests::stochastic_seed(scene, 1, replicates);
  data::parallel_for(seeds - 1, 0, [&](std::size_t k) {
    outcomes[k + 1] = tests::stochastic_seed(scene, k + 2, replicates);
  });

  fmt::print("{:<44} {:>8} {:>9} {:>11} {:>11} {:>11} {:>11}\n", "parameter", "truth", "covered", "error",
             "uncorrected", "stated bias", "stated se");
  std::size_t covered_all = 0, total = 0, seeds_covered[2] = {0, 0};
  const auto& parameters = outcomes[0].result.parameters;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    double error = 0.0, raw = 0.0, bias = 0.0, se = 0.0;
    std::size_t covered = 0;
    for (const auto& o : outcomes) {
      const auto& v = o.result.subject.verdicts[j];
      covered += v.interval_lower <= o.truth[i] && o.truth[i] <= v.interval_upper ? 1 : 0;
      error += (v.fitted - o.truth[i]) / static_cast<double>(seeds);
      raw += (o.result.x_uncorrected[i] - o.truth[i]) / static_cast<double>(seeds);
      bias += v.bias / static_cast<double>(seeds);
      se += v.standard_error / static_cast<double>(seeds);
    }
    fmt::print("{:<44} {:>8.4g} {:>8.1f}% {:>11.2e} {:>11.2e} {:>11.2e} {:>11.2e}\n", parameters[j].label(),
               outcomes[0].truth[i], 100.0 * static_cast<double>(covered) / static_cast<double>(seeds), error,
               raw, bias, se);
    covered_all += covered;
    total += seeds;
    ++seeds_covered[10 * covered >= 9 * seeds ? 0 : 1];
  }
  fmt::print("all: {:.1f} % of {} intervals cover the truth; {} parameters reach 90 %, {} do not\n",
             100.0 * static_cast<double>(covered_all) / static_cast<double>(total), total, seeds_covered[0],
             seeds_covered[1]);
  return 10 * covered_all >= 9 * total ? 0 : 1;
}
