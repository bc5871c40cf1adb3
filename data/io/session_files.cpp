#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "data/io/session_description.hpp"
#include "data/io/template_text.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;

std::vector<std::string> entries_of(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  std::filesystem::directory_iterator at(folder, error);
  for (; !error && at != std::filesystem::directory_iterator(); at.increment(error))
    names.push_back(at->path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

bool is_pattern(const std::string& part) {
  return part.find_first_of("*?") != std::string::npos;
}

/// Files that match a path with * and ?; on none, what stands where the search ended, as a hint.
struct Search {
  std::vector<std::filesystem::path> found;
  std::string hint;
};

Search search(const std::filesystem::path& folder, const std::filesystem::path& pattern) {
  std::vector<std::filesystem::path> level{folder};
  Search result;
  for (auto part = pattern.begin(); part != pattern.end(); ++part) {
    const std::string name = part->string();
    const bool last = std::next(part) == pattern.end();
    std::vector<std::filesystem::path> next;
    for (const std::filesystem::path& at : level) {
      if (!is_pattern(name)) {
        if (std::filesystem::exists(at / name)) next.push_back(at / name);
        continue;
      }
      for (const std::string& entry : entries_of(at)) {
        if (data::matches(name, entry) && (last || std::filesystem::is_directory(at / entry)))
          next.push_back(at / entry);
      }
    }
    if (next.empty()) {
      const std::filesystem::path& at = level.front();
      const std::vector<std::string> names = entries_of(at);
      const std::string suggestion = data::suggest(name, names);
      const std::string where =
          at == folder ? "the folder" : fmt::format("`{}`", at.lexically_relative(folder).string());
      result.hint = names.empty() ? fmt::format("{} is empty", where)
                                  : fmt::format("no `{}` in {}; {}", name, where, suggestion);
      return result;
    }
    level = std::move(next);
  }
  for (std::filesystem::path& at : level) {
    if (!std::filesystem::is_directory(at)) result.found.push_back(std::move(at));
  }
  if (result.found.empty()) result.hint = "that is a folder, not a file";
  return result;
}

bool belongs(const FileMapping& file, const std::string& trial) {
  return file.trials.empty() || std::any_of(file.trials.begin(), file.trials.end(),
                                            [&](const auto& p) { return data::matches(p, trial); });
}

}  // namespace

std::vector<ResolvedFile> resolve_files(const SessionDescription& description) {
  if (!std::filesystem::is_directory(description.recordings)) {
    throw InputError(
        Diagnostic{Severity::error, "missing-folder",
                   fmt::format("there is no folder of recordings `{}`", description.recordings.string()),
                   description.recordings_where, "give it with `--set recordings=FOLDER`"});
  }
  std::vector<ResolvedFile> files;
  std::vector<Diagnostic> mistakes;
  for (std::size_t t = 0; t < description.trials.size(); ++t) {
    const TrialDescription& trial = description.trials[t];
    for (std::size_t f = 0; f < description.files.size(); ++f) {
      const FileMapping& file = description.files[f];
      if (!belongs(file, trial.info.name)) continue;
      const auto fail = [&](const char* code, const std::string& message, const std::string& help) {
        mistakes.push_back({Severity::error, code, fmt::format("trial `{}`: {}", trial.info.name, message),
                            file.where, help});
      };
      std::vector<std::string> unknown;
      const std::string path = fill(file.path, trial.variables, unknown);
      if (!unknown.empty()) {
        std::vector<std::string> known;
        for (const auto& [name, value] : trial.variables) known.push_back(name);
        fail("unknown-variable", fmt::format("`{{{}}}` is not a variable of this trial", unknown.front()),
             data::suggest(unknown.front(), known));
        continue;
      }
      const Search result = search(description.recordings, path);
      if (result.found.empty()) {
        fail("missing-file", fmt::format("there is no file `{}`", path), result.hint);
      } else if (result.found.size() > 1) {
        std::vector<std::string> names;
        for (const auto& found : result.found)
          names.push_back(found.lexically_relative(description.recordings).string());
        if (names.size() > 4) names.resize(4);
        fail("ambiguous-file", fmt::format("{} files match `{}`", result.found.size(), path),
             fmt::format("{}", fmt::join(names, " | ")));
      } else {
        files.push_back({t, f, result.found.front()});
      }
    }
  }
  if (!mistakes.empty()) throw InputError(std::move(mistakes));
  return files;
}

}  // namespace brachium::io
