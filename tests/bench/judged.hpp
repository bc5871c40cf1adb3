#pragma once
/// Benchmarks of Google Benchmark that are held against what is asked of them.

#include <benchmark/benchmark.h>

#include <cstdio>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace brachium::bench {

/// What a run lacks, as "<figure>, asked <figure>"; empty where it reaches what is asked, or nothing is.
using Complaint = std::function<std::string(const benchmark::BenchmarkReporter::Run&)>;

class Judge : public benchmark::ConsoleReporter {
 public:
  explicit Judge(Complaint complaint) : complaint_(std::move(complaint)) {}

  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs)
      if (const std::string text = complaint_(run); !text.empty())
        missed_.push_back(run.benchmark_name() + ": " + text);
  }
  const std::vector<std::string>& missed() const { return missed_; }

 private:
  Complaint complaint_;
  std::vector<std::string> missed_;
};

/// Runs all that is registered. The program's exit code: 2 for arguments it does not know, 1 where a run is too slow.
inline int run_judged(int argc, char** argv, Complaint complaint) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  Judge judge(std::move(complaint));
  benchmark::RunSpecifiedBenchmarks(&judge);
  for (const std::string& line : judge.missed()) std::fprintf(stderr, "too slow: %s\n", line.c_str());
  return judge.missed().empty() ? 0 : 1;
}

}  // namespace brachium::bench
