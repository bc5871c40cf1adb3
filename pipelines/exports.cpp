#include "pipelines/exports.hpp"

#include <fmt/format.h>

#include <map>
#include <tuple>

#include "data/io/atomic_file.hpp"
#include "data/io/opensim_file.hpp"
#include "data/io/subject_file.hpp"
#include "pipelines/run_folder.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;

bool stands(const fs::path& file, const std::string& text) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && fs::file_size(file, ignored) == text.size() &&
         io::read_text(file) == text;
}

void write_sto(const StageRecord& record, const StageData& data) {
  const auto& trials = data.signals->info().trials;
  for (std::size_t t = 0; t < trials.size(); ++t) {
    std::map<std::tuple<double, double, std::size_t>, std::vector<std::size_t>>
        sets;  // (rate, start, count) -> signals
    for (std::size_t s = 0; s < trials[t].signals.size(); ++s) {
      const data::SignalInfo& info = trials[t].signals[s];
      sets[{info.rate_hz, info.start_time_s, info.count}].push_back(s);
    }
    std::size_t set = 0;
    for (const auto& [stamps, members] : sets) {
      const std::string suffix = sets.size() == 1 ? "" : fmt::format("-{}", ++set);
      const fs::path file = record.output.parent_path() /
                            fmt::format("{}-{}{}.sto", record.output.stem().string(), trials[t].name, suffix);
      std::error_code ignored;
      if (record.status == StageStatus::reused && fs::exists(file, ignored)) continue;
      std::vector<data::Signal> signals;
      for (const std::size_t s : members) signals.push_back(data.signals->signal(t, s));
      io::write_storage(signals, fmt::format("{} {}", data.stage, trials[t].name), file);
    }
  }
}

}  // namespace

void write_exports(const StageDefinition& stage, const StageRecord& record, const StageData& data) {
  if (data.subject) {
    const fs::path file = subject_file(record.output.parent_path(), stage.name);
    const std::string text = io::subject_to_toml(*data.subject);
    if (!stands(file, text)) io::write_text_atomically(file, text);
  }
  if (stage.export_sto) write_sto(record, data);
}

}  // namespace brachium::pipelines
