#include "data/io/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

#include "data/model/error.hpp"

namespace brachium::io {
namespace {

using data::InputError;

std::string host_name() {
  char name[256] = "host";
  if (::gethostname(name, sizeof name - 1) != 0) return "host";
  return name;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
  return file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
}

[[noreturn]] void fail(const std::filesystem::path& file, int error) {
  throw InputError("write-failed", fmt::format("cannot write `{}`: {}", file.string(), std::strerror(error)),
                   error == ENOSPC || error == EDQUOT ? "free some space on the disk and run again"
                                                      : "check the folder and its permissions");
}

// Remains of processes of this machine that were killed while they wrote the same target.
void remove_leftovers(const std::filesystem::path& folder, const std::string& prefix) {
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  for (; !error && entries != std::filesystem::directory_iterator(); entries.increment(error)) {
    const std::string name = entries->path().filename().string();
    if (!name.starts_with(prefix)) continue;
    long process = 0;
    const char* begin = name.data() + prefix.size();
    const auto [end, status] = std::from_chars(begin, name.data() + name.size(), process);
    if (status != std::errc() || end == begin || process <= 0) continue;
    if (::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH) {
      std::error_code ignored;
      std::filesystem::remove(entries->path(), ignored);
    }
  }
}

// A rename survives a power cut only once the folder itself is on the disk. Some file systems cannot flush
// folders; the rename is then as durable as they make it.
void flush_folder(const std::filesystem::path& folder) {
  const int handle = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return;
  ::fsync(handle);
  ::close(handle);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  static std::atomic<unsigned> counter{0};
  const std::filesystem::path folder = folder_of(target_);
  std::error_code ignored;
  if (target_.filename().empty() || std::filesystem::is_directory(target_, ignored)) {
    throw InputError("bad-path",
                     fmt::format("`{}` is a folder, not a file that can be written", target_.string()));
  }
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw InputError(
        "missing-folder",
        fmt::format("cannot write `{}`: there is no folder `{}`", target_.string(), folder.string()),
        "make the folder first");
  }
  const std::string prefix = fmt::format(".{}.partial-{}-", target_.filename().string(), host_name());
  remove_leftovers(folder, prefix);
  temporary_ = folder / fmt::format("{}{}-{}", prefix, static_cast<long>(::getpid()), counter++);
  const int handle = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (handle < 0) {
    const int error = errno;
    if (error == EACCES || error == EROFS || error == EPERM) {
      throw InputError("read-only-folder",
                       fmt::format("cannot write `{}`: {}", target_.string(), std::strerror(error)),
                       "choose a folder you may write to");
    }
    fail(target_, error);
  }
  ::close(handle);
}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

void AtomicFile::commit() {
  const int handle = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  if (handle < 0) fail(target_, errno);
  if (::fsync(handle) != 0) {
    const int error = errno;
    ::close(handle);
    fail(target_, error);
  }
  ::close(handle);
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(target_, errno);
  committed_ = true;
  flush_folder(folder_of(target_));
}

void write_text_atomically(const std::filesystem::path& target, const std::string& text) {
  AtomicFile file(target);
  const int handle = ::open(file.temporary().c_str(), O_WRONLY | O_TRUNC | O_CLOEXEC);
  if (handle < 0) fail(target, errno);
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t written = ::write(handle, text.data() + done, text.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      ::close(handle);
      fail(target, error);
    }
    done += static_cast<std::size_t>(written);
  }
  if (::close(handle) != 0) fail(target, errno);
  file.commit();
}

std::string read_text(const std::filesystem::path& file) {
  std::error_code ignored;
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file, ignored)) {
    throw InputError("missing-file", fmt::format("cannot read `{}`", file.string()),
                     "check the path and its permissions");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  if (text.str().empty()) throw InputError("empty-file", fmt::format("`{}` is empty", file.string()));
  return text.str();
}

}  // namespace brachium::io
