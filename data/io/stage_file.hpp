#pragma once
/// The output of one stage: a session file (signals) that also carries tables, texts, findings, a calibrated
/// subject and the fingerprint of what it was made from.
///
///   /attributes              one text attribute per entry
///   /fingerprint             one text attribute per entry
///   /tables/<table>          attributes: title, column_order (JSON list)
///   /tables/<table>/<column> float64 or UTF-8 text, attributes unit and units for numbers
///   /diagnostics             one UTF-8 text, a JSON list
///   /subject                 one UTF-8 text, the subject as TOML (data/io/subject_file.hpp)

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/io/session_file.hpp"
#include "data/model/error.hpp"
#include "data/model/subject.hpp"
#include "data/model/table.hpp"

namespace brachium::io {

/// Everything of a stage's output but its signals.
struct StageFileContent {
  std::map<std::string, data::Table> tables;
  std::map<std::string, std::string> attributes;
  std::vector<data::Diagnostic> diagnostics;
  std::optional<data::Subject> subject;
  std::map<std::string, std::string> fingerprint;
};

/// Signals are streamed while the stage runs; finish() adds the rest, flushes and renames.
class StageFileWriter final : public SessionFileWriter {
 public:
  using SessionFileWriter::SessionFileWriter;
  /// Writes `content` and commits; nothing may be written afterwards. Throws as SessionFileWriter::commit.
  void finish(const StageFileContent& content);
};

/// Tables, attributes, findings, subject and fingerprint of a stage file; its signals: SessionFile(file).
/// Throws InputError as SessionFile does.
StageFileContent read_stage_content(const std::filesystem::path& file);

/// The fingerprint alone, or nothing if the file is absent, damaged or not a stage's output.
std::optional<std::map<std::string, std::string>> read_fingerprint(
    const std::filesystem::path& file) noexcept;

}  // namespace brachium::io
