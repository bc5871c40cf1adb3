#pragma once
/// Runs a pipeline: each stage after those it reads, results on the disk, nothing twice.
///
/// A stage's output is one file, written under a temporary name and renamed when it is whole. It carries the
/// fingerprint of what it was made from; while that stands, the stage is not run again. So a run that was
/// killed at any moment goes on where it stopped.

#include <atomic>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "pipelines/definition.hpp"
#include "pipelines/fingerprint.hpp"

namespace brachium::pipelines {

struct RunRequest {
  std::filesystem::path definition;
  std::vector<std::string> settings;        ///< KEY=VALUE
  std::optional<std::string> only;          ///< run this stage alone, from stored inputs
  std::optional<std::string> from;          ///< run this stage and all that depends on it again
  std::optional<std::string> until;         ///< run only this stage and what it needs
  std::filesystem::path out;                ///< run folder; empty: runs/<name of the definition>
  std::size_t threads = 0;                  ///< 0: as the definition says
  std::vector<std::string> command_line;    ///< for the provenance
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end the run at the next chance
};

enum class StageStatus { done, reused, failed, skipped };
std::string to_string(StageStatus status);

struct StageRecord {
  std::string name, run;
  StageStatus status = StageStatus::skipped;
  std::string reason;          ///< why it ran, or was not run
  std::string started, ended;  ///< UTC; of the run that made the output
  double seconds = 0.0;        ///< wall time of the run that made the output
  std::filesystem::path output;
  Fingerprint fingerprint;
  std::vector<std::string> reads;          ///< names of what it reads
  std::vector<data::Diagnostic> findings;  ///< warnings and notes of the run that made the output
};

enum class Outcome { done, expectation_failed, numerical_failure, input_error, interrupted };
int exit_code(Outcome outcome);  ///< 0, 1, 1, 2, 130
std::string to_string(Outcome outcome);

struct RunResult {
  std::shared_ptr<const Definition> definition;
  std::filesystem::path folder;
  Outcome outcome = Outcome::done;
  std::string failed_stage;              ///< empty if none failed
  std::vector<data::Diagnostic> errors;  ///< what ended the run
  std::vector<StageRecord> stages;       ///< in the order of the run; the imported session first
  std::vector<ExpectationResult> expectations;
  std::string verdict;  ///< the line a reader remembers; may be empty
  std::string started, ended;
  std::map<std::string, std::string> files;  ///< input files and their SHA-256
  std::vector<std::string> command_line;

  const StageRecord* find(const std::string& stage) const;
};

/// Told what happens while it happens; called from one thread at a time.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void stage_begins(const StageRecord& stage, std::size_t place, std::size_t count) = 0;
  virtual void stage_progress(const StageRecord& stage, double fraction, const std::string& what) = 0;
  virtual void stage_ends(const StageRecord& stage, const std::vector<data::Diagnostic>& findings) = 0;
  virtual void message(const std::string& text) = 0;
};

/// Runs the pipeline. Mistakes of the definition and of the run folder are thrown (InputError) before
/// anything has run; what goes wrong later is told by the result, and the report of what was done is written
/// all the same.
RunResult run_pipeline(const Catalogue& catalogue, const RunRequest& request, RunObserver& observer);

/// Writes the report of a finished run folder again; returns its path. Throws InputError.
std::filesystem::path write_report_again(const Catalogue& catalogue, const std::filesystem::path& folder);

/// Thrown through a stage by its progress or its output when the run is to stop.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace brachium::pipelines
