#include "pipelines/run_log.hpp"

#include <fmt/format.h>

#include "pipelines/run_folder.hpp"
#include "pipelines/version.hpp"

namespace brachium::pipelines {

RunLog::RunLog(const std::filesystem::path& file, RunObserver& next)
    : file_(file, std::ios::app), next_(next) {
  line(fmt::format("brachium {}", program_version()));
}

void RunLog::line(const std::string& text) {
  file_ << utc_now() << "  " << text << std::endl;
}

void RunLog::stage_begins(const StageRecord& stage, std::size_t place, std::size_t count) {
  line(fmt::format("{} ({}): runs, {}", stage.name, stage.run, stage.reason));
  next_.stage_begins(stage, place, count);
}

void RunLog::stage_progress(const StageRecord& stage, double fraction, const std::string& what) {
  next_.stage_progress(stage, fraction, what);
}

void RunLog::stage_ends(const StageRecord& stage, const std::vector<data::Diagnostic>& findings) {
  line(fmt::format(
      "{}: {}{}", stage.name, to_string(stage.status),
      stage.status == StageStatus::done ? fmt::format(" in {:.2f} s", stage.seconds) : ", " + stage.reason));
  for (const data::Diagnostic& d : findings) file_ << data::render(d);
  file_.flush();
  next_.stage_ends(stage, findings);
}

void RunLog::message(const std::string& text) {
  line(text);
  next_.message(text);
}

}  // namespace brachium::pipelines
