#include "pipelines/progress.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "pipelines/report/build.hpp"

namespace brachium::pipelines {
namespace {

double seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

ProgressPrinter::ProgressPrinter(std::ostream& out, bool terminal, bool quiet)
    : out_(out), terminal_(terminal), quiet_(quiet) {}

void ProgressPrinter::clear() {
  if (line_open_) out_ << "\r\x1b[K";
  line_open_ = false;
}

void ProgressPrinter::stage_begins(const StageRecord& stage, std::size_t place, std::size_t count) {
  begin_ = shown_ = Clock::now();
  if (quiet_) return;
  clear();
  out_ << fmt::format("[{}/{}] {} ({}): {}\n", place, count, stage.name, stage.run, stage.reason)
       << std::flush;
}

void ProgressPrinter::stage_progress(const StageRecord& stage, double fraction, const std::string& what) {
  const auto now = Clock::now();
  const double elapsed = seconds(now - begin_);
  // Nothing for what takes less than a second; then often where the line is written over, seldom where it
  // stays.
  if (quiet_ || elapsed < 1.0 || seconds(now - shown_) < (terminal_ ? 0.1 : 10.0)) return;
  shown_ = now;
  const double done = std::clamp(fraction, 0.0, 1.0);
  const std::string left = done > 0.01 ? report::duration(elapsed / done * (1.0 - done)) + " left" : "";
  const std::string line =
      fmt::format("  {}  {:3.0f} %  {}{}{}", stage.name, 100.0 * done, left, what.empty() ? "" : "  ", what);
  if (terminal_) {
    out_ << "\r\x1b[K" << line << std::flush;
    line_open_ = true;
  } else {
    out_ << line << std::endl;
  }
}

void ProgressPrinter::stage_ends(const StageRecord& stage, const std::vector<data::Diagnostic>& findings) {
  clear();
  if (!quiet_) {
    if (stage.status == StageStatus::done)
      out_ << fmt::format("  {} done in {}\n", stage.name, report::duration(stage.seconds));
    if (stage.status == StageStatus::reused)
      out_ << fmt::format("  {} reused: {}\n", stage.name, stage.reason);
  }
  if (stage.status != StageStatus::failed) show(findings);  // what ended the run is told at its end
  out_ << std::flush;
}

void ProgressPrinter::show(const std::vector<data::Diagnostic>& findings) {
  constexpr std::size_t most = 5;  // per stage; all of them are in the report and the log
  std::size_t count = 0;
  for (const data::Diagnostic& d : findings) {
    if (d.severity == data::Severity::note || (quiet_ && d.severity == data::Severity::warning)) continue;
    if (++count <= most) out_ << data::render(d);
  }
  if (count > most) out_ << fmt::format("  and {} more, see the report\n", count - most);
}

void ProgressPrinter::message(const std::string& text) {
  clear();
  if (!quiet_) out_ << text << std::endl;
}

}  // namespace brachium::pipelines
