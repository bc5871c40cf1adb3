#pragma once
/// What a stage's output was made from, part by part, so that the runner can tell whether it still stands
/// and, if not, why.

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pipelines/definition.hpp"

namespace brachium::pipelines {

/// part -> value: "program", "stage", "trials", "scene", "option.lowpass_hz" = "6.0",
/// "input.excitation.0" = "excitation 9f86d081..." (name and digest of what it read).
using Fingerprint = std::map<std::string, std::string>;

/// One text for all parts: SHA-256 over them, each with its length.
std::string digest(const Fingerprint& fingerprint);

/// Parts that the definition alone determines; inputs, scene and program are added by the runner.
Fingerprint stage_fingerprint(const StageDefinition& stage);

/// Why an output with fingerprint `stored` does not do for `wanted`: "option lowpass_hz changed 6.0 -> 4.0,
/// input `excitation` ran again". Empty if it does.
std::string difference_text(const Fingerprint& stored, const Fingerprint& wanted);

/// SHA-256 of files, remembered in a file together with size and time of change, so that a large recording is
/// read once and not at every run.
class FileDigests {
 public:
  /// Starts from what is remembered in `memory`; a damaged memory is forgotten.
  explicit FileDigests(std::filesystem::path memory);
  /// Throws InputError("missing-file").
  std::string of(const std::filesystem::path& file);
  void save() const;  ///< throws InputError("write-failed", ...)
  /// Files asked for since construction, and their digests.
  const std::map<std::string, std::string>& used() const { return used_; }

 private:
  struct Entry {
    std::uintmax_t size = 0;
    long long changed = 0;  ///< [ns] of the file clock
    std::string digest;
  };
  std::filesystem::path memory_;
  std::map<std::string, Entry> entries_;
  std::map<std::string, std::string> used_;
};

}  // namespace brachium::pipelines
