#pragma once
/// The folder of a run: names of its files, one run at a time, stored outputs of stages.

#include <filesystem>
#include <optional>
#include <string>

#include "pipelines/definition.hpp"
#include "pipelines/fingerprint.hpp"

namespace brachium::pipelines {

/// A folder held by one run. The lock ends with the process however it ends, so a killed run leaves none
/// behind.
class RunFolder {
 public:
  /// Makes the folder if need be and locks it. Throws InputError("cannot-write") and ("run-in-progress") with
  /// the process that holds it.
  explicit RunFolder(const std::filesystem::path& folder);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// A note if a run was killed here before, else nothing.
  const std::optional<std::string>& left_behind() const { return left_behind_; }

  /// Removes what killed runs were writing, and renames outputs of stages that moved to another place in the
  /// definition.
  void tidy(const Definition& definition) const;

 private:
  std::filesystem::path path_;
  int lock_ = -1;
  std::optional<std::string> left_behind_;
};

/// "<folder>/03-excitation.h5"; number 0 is the imported session.
std::filesystem::path output_file(const std::filesystem::path& folder, std::size_t number,
                                  const std::string& stage);
std::filesystem::path subject_file(const std::filesystem::path& folder, const std::string& stage);

/// A stage's stored output as later stages see it; signals are read when asked for. Throws InputError.
StageData load_stage(const std::filesystem::path& file, const std::string& stage);
/// A session file as the input `session`. Throws InputError.
StageData load_session(const std::filesystem::path& file);
/// A subject file as the input of a stage. Throws InputError.
StageData load_subject(const std::filesystem::path& file);

/// "2026-03-01T12:00:00Z"
std::string utc_now();

}  // namespace brachium::pipelines
