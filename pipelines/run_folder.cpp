#include "pipelines/run_folder.hpp"

#include <fcntl.h>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <vector>

#include "data/io/session_file.hpp"
#include "data/io/stage_file.hpp"
#include "data/io/subject_file.hpp"

namespace brachium::pipelines {
namespace {

namespace fs = std::filesystem;
using data::InputError;

std::string content_of(int file) {
  std::string text(64, '\0');
  const ssize_t size = ::pread(file, text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

RunFolder::RunFolder(const fs::path& folder) : path_(fs::absolute(folder).lexically_normal()) {
  std::error_code failed;
  fs::create_directories(path_, failed);
  if (failed || !fs::is_directory(path_)) {
    throw InputError("cannot-write",
                     fmt::format("cannot make the run folder `{}`: {}", path_.string(),
                                 failed ? failed.message() : "a file is in its place"),
                     "choose another with --out");
  }
  lock_ = ::open((path_ / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (lock_ < 0) {
    throw InputError(
        "cannot-write",
        fmt::format("cannot write to the run folder `{}`: {}", path_.string(), std::strerror(errno)),
        "choose another with --out");
  }
  const std::string holder = content_of(lock_);
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    lock_ = -1;
    throw InputError(
        "run-in-progress",
        fmt::format("process {} is running in `{}`", holder.empty() ? "(unknown)" : holder, path_.string()),
        "wait for it, or choose another folder with --out");
  }
  if (!holder.empty())
    left_behind_ =
        fmt::format("the run of process {} in this folder was killed; going on where it stopped", holder);
  const std::string own = std::to_string(::getpid()) + "\n";
  if (::ftruncate(lock_, 0) != 0 ||
      ::pwrite(lock_, own.data(), own.size(), 0) != static_cast<ssize_t>(own.size())) {
    const int error = errno;
    ::close(lock_);
    throw InputError(
        "cannot-write",
        fmt::format("cannot write to the run folder `{}`: {}", path_.string(), std::strerror(error)),
        "free some space, or choose another with --out");
  }
}

RunFolder::~RunFolder() {
  // Emptied, not removed: removing a file that another process may just have opened would give both a lock.
  if (lock_ >= 0 && ::ftruncate(lock_, 0) == 0) ::flock(lock_, LOCK_UN);
  if (lock_ >= 0) ::close(lock_);
}

void RunFolder::tidy(const Definition& definition) const {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_)) files.push_back(entry.path());
  for (const fs::path& file : files) {
    const std::string name = file.filename().string();
    std::error_code ignored;
    if (name.starts_with(".") && name.find(".partial-") != std::string::npos) fs::remove(file, ignored);
    const std::size_t dash = name.find('-');
    if (dash == std::string::npos || file.extension() != ".h5" ||
        name.find_first_not_of("0123456789") != dash)
      continue;
    const StageDefinition* stage = definition.find(name.substr(dash + 1, name.size() - dash - 4));
    if (!stage) continue;
    const fs::path wanted = output_file(path_, stage->number, stage->name);
    if (file != wanted && !fs::exists(wanted)) fs::rename(file, wanted, ignored);
  }
}

fs::path output_file(const fs::path& folder, std::size_t number, const std::string& stage) {
  return folder / fmt::format("{:02}-{}.h5", number, stage);
}

fs::path subject_file(const fs::path& folder, const std::string& stage) {
  return folder / (stage + ".subject.toml");
}

StageData load_stage(const fs::path& file, const std::string& stage) {
  io::StageFileContent content = io::read_stage_content(file);
  StageData data;
  data.stage = stage;
  data.signals = std::make_shared<io::SessionFile>(file);
  data.tables = std::move(content.tables);
  data.subject = std::move(content.subject);
  data.attributes = std::move(content.attributes);
  data.diagnostics = std::move(content.diagnostics);
  return data;
}

StageData load_session(const fs::path& file) {
  StageData data;
  data.stage = session_stage;
  data.signals = std::make_shared<io::SessionFile>(file);
  return data;
}

StageData load_subject(const fs::path& file) {
  StageData data;
  data.stage = "file:" + file.string();
  data.signals = std::make_shared<data::MemorySession>();
  data.subject = io::read_subject(file);
  return data;
}

std::string utc_now() {
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now));
}

}  // namespace brachium::pipelines
