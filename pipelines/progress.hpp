#pragma once
/// Progress for whoever waits: one line that is written over on a terminal, plain lines elsewhere.

#include <chrono>
#include <ostream>
#include <string>

#include "pipelines/runner.hpp"

namespace brachium::pipelines {

class ProgressPrinter final : public RunObserver {
 public:
  /// `terminal`: lines may be written over. `quiet`: only warnings and errors.
  ProgressPrinter(std::ostream& out, bool terminal, bool quiet);

  void stage_begins(const StageRecord& stage, std::size_t place, std::size_t count) override;
  void stage_progress(const StageRecord& stage, double fraction, const std::string& what) override;
  void stage_ends(const StageRecord& stage, const std::vector<data::Diagnostic>& findings) override;
  void message(const std::string& text) override;

 private:
  using Clock = std::chrono::steady_clock;
  void clear();
  void show(const std::vector<data::Diagnostic>& findings);

  std::ostream& out_;
  const bool terminal_, quiet_;
  bool line_open_ = false;
  Clock::time_point begin_, shown_;
};

}  // namespace brachium::pipelines
