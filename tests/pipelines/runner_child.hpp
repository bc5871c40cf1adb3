#pragma once
/// The tests' command line as a program of its own, to be stopped, killed or starved of disk.

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "runner_fake_stages.hpp"

namespace brachium::pipelines::tests {

namespace fs = std::filesystem;

/// A program of the tests' command line, started in a folder; its output goes to files there.
class Child {
 public:
  Child(const fs::path& folder, std::vector<std::string> arguments, rlim_t file_limit = RLIM_INFINITY)
      : folder_(folder) {
    arguments.insert(arguments.begin(), BRACHIUM_FAKE_PROGRAM);
    std::vector<char*> argv;
    for (std::string& a : arguments) argv.push_back(a.data());
    argv.push_back(nullptr);
    const std::string out = (folder / "stdout").string(), err = (folder / "stderr").string(),
                      where = folder.string();
    pid_ = ::fork();
    if (pid_ == 0) {
      const rlimit limit{file_limit, file_limit};
      if (::chdir(where.c_str()) != 0 || !std::freopen(out.c_str(), "w", stdout) ||
          !std::freopen(err.c_str(), "w", stderr))
        ::_exit(99);
      if (file_limit != RLIM_INFINITY) ::setrlimit(RLIMIT_FSIZE, &limit);
      ::execv(argv[0], argv.data());
      ::_exit(99);
    }
  }
  void send(int signal) const { ::kill(pid_, signal); }
  /// Exit code, or minus the signal that ended it.
  int wait() const {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  std::string out() const { return file_text(folder_ / "stdout"); }
  std::string err() const { return file_text(folder_ / "stderr"); }

 private:
  fs::path folder_;
  pid_t pid_ = -1;
};

}  // namespace brachium::pipelines::tests
