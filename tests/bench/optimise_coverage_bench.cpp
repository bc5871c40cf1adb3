/// Do the stated 95 % intervals cover the truth? The stochastic twin over many seeds: EMG as modulated noise
/// at 20 dB, conditioned as recordings are, calibrated, judged. Prints coverage, mean error and mean stated
/// bias per parameter, with and without the correction, and how many intervals each seed misses. Exit code 1
/// if those of any parameter that most seeds call identified cover the truth in less than 90 % of the seeds.
/// Run: optimise_coverage_bench SCENE_FILE [SEEDS, default 100] [REPLICATES, default 20] [CSV_FILE, one row a
/// seed and parameter]

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>

#include "data/io/scene_file.hpp"
#include "data/model/parallel.hpp"
#include "tests/optimise/stochastic_twin.hpp"

namespace {

using brachium::optimise::tests::StochasticOutcome;

bool covers(const StochasticOutcome& o, std::size_t j) {
  const auto& v = o.result.subject.verdicts[j];
  const double truth = o.truth[static_cast<Eigen::Index>(j)];
  return v.interval_lower <= truth && truth <= v.interval_upper;
}

void write_rows(const char* path, const std::vector<StochasticOutcome>& outcomes) {
  std::ofstream csv(path);
  csv << "seed,owner,parameter,truth,fitted,uncorrected,standard_error,lower,upper,reliability,limited\n";
  for (std::size_t k = 0; k < outcomes.size(); ++k)
    for (std::size_t j = 0; j < outcomes[k].result.subject.verdicts.size(); ++j) {
      const auto i = static_cast<Eigen::Index>(j);
      const auto& o = outcomes[k];
      const auto& v = o.result.subject.verdicts[j];
      csv << fmt::format("{},{},{},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{:.8g},{:.4g},{}\n", k + 1, v.muscle,
                         v.parameter, o.truth[i], v.fitted, o.result.x_uncorrected[i], v.standard_error,
                         v.interval_lower, v.interval_upper, o.result.excitation_error.least_reliability,
                         o.result.excitation_error.limited ? 1 : 0);
    }
}

/// How many seeds miss no interval, one, two, ...
void print_misses(const std::vector<StochasticOutcome>& outcomes) {
  std::vector<std::size_t> seeds;
  for (const StochasticOutcome& o : outcomes) {
    std::size_t missed = 0;
    for (std::size_t j = 0; j < o.result.parameters.size(); ++j) missed += covers(o, j) ? 0 : 1;
    if (missed >= seeds.size()) seeds.resize(missed + 1);
    ++seeds[missed];
  }
  fmt::print("intervals missed in one seed:");
  for (std::size_t m = 0; m < seeds.size(); ++m)
    if (seeds[m] > 0) fmt::print("  {} in {} seeds", m, seeds[m]);
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace brachium;
  using namespace brachium::optimise;
  if (argc < 2) {
    fmt::print(stderr, "usage: optimise_coverage_bench SCENE_FILE [SEEDS] [REPLICATES] [CSV_FILE]\n");
    return 2;
  }
  const data::Scene scene = io::read_scene(argv[1]);
  const auto seeds = static_cast<std::size_t>(argc > 2 ? std::atoi(argv[2]) : 100);
  const int replicates = argc > 3 ? std::atoi(argv[3]) : 20;
  std::vector<tests::StochasticOutcome> outcomes(seeds);
  tests::StochasticStudy study;
  study.replicates = replicates;
  outcomes[0] = tests::stochastic_seed(scene, 1, study);
  data::parallel_for(seeds - 1, 0,
                     [&](std::size_t k) { outcomes[k + 1] = tests::stochastic_seed(scene, k + 2, study); });

  if (argc > 4) write_rows(argv[4], outcomes);
  fmt::print("{:<44} {:>8} {:>10} {:>8} {:>11} {:>11} {:>11} {:>11} {:>11}\n", "parameter", "truth",
             "identified", "covered", "error", "uncorrected", "stated bias", "error sd", "stated se");
  std::size_t covered_all = 0, total = 0, reached = 0;
  std::vector<std::string> missed;
  const auto& parameters = outcomes[0].result.parameters;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    const auto i = static_cast<Eigen::Index>(j);
    double error = 0.0, square = 0.0, raw = 0.0, bias = 0.0, se = 0.0;
    std::size_t covered = 0, identified = 0;
    for (const auto& o : outcomes) {
      const auto& v = o.result.subject.verdicts[j];
      covered += covers(o, j) ? 1 : 0;
      identified += v.verdict == "identified" ? 1 : 0;
      square += std::pow(v.fitted - o.truth[i], 2) / static_cast<double>(seeds);
      error += (v.fitted - o.truth[i]) / static_cast<double>(seeds);
      raw += (o.result.x_uncorrected[i] - o.truth[i]) / static_cast<double>(seeds);
      bias += v.bias / static_cast<double>(seeds);
      se += v.standard_error / static_cast<double>(seeds);
    }
    const auto percent = [seeds](std::size_t n) {
      return 100.0 * static_cast<double>(n) / static_cast<double>(seeds);
    };
    fmt::print("{:<44} {:>8.4g} {:>9.1f}% {:>7.1f}% {:>11.2e} {:>11.2e} {:>11.2e} {:>11.2e} {:>11.2e}\n",
               parameters[j].label(), outcomes[0].truth[i], percent(identified), percent(covered), error, raw,
               bias, std::sqrt(square - error * error), se);
    covered_all += covered;
    total += seeds;
    if (10 * covered >= 9 * seeds) {
      ++reached;
    } else if (2 * identified > seeds) {
      missed.push_back(parameters[j].label());
    }
  }
  fmt::print("all: {:.1f} % of {} intervals cover the truth; {} of {} parameters reach 90 %\n",
             100.0 * static_cast<double>(covered_all) / static_cast<double>(total), total, reached,
             parameters.size());
  print_misses(outcomes);
  for (const std::string& name : missed) fmt::print(stderr, "below 90 %: {}\n", name);
  return missed.empty() ? 0 : 1;
}
