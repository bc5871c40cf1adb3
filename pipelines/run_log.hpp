#pragma once
/// The run's log, log.txt: one line per event, appended, while the events go on to whoever watches.

#include <fstream>

#include "pipelines/runner.hpp"

namespace brachium::pipelines {

class RunLog final : public RunObserver {
 public:
  /// The log is a convenience: where it cannot be written (a full disk), the run goes on without it.
  RunLog(const std::filesystem::path& file, RunObserver& next);

  void stage_begins(const StageRecord& stage, std::size_t place, std::size_t count) override;
  void stage_progress(const StageRecord& stage, double fraction, const std::string& what) override;
  void stage_ends(const StageRecord& stage, const std::vector<data::Diagnostic>& findings) override;
  void message(const std::string& text) override;

 private:
  void line(const std::string& text);

  std::ofstream file_;
  RunObserver& next_;
};

}  // namespace brachium::pipelines
