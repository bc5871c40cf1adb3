#pragma once
/// A session description: a TOML file that says which columns of which files are which signals.
///
///   [session]             subject, recordings (base folder), body_mass_kg, ...
///   [session.attributes]  source, licence, citation, assumptions: free texts that reach the report
///   [[trial]]             name, kind, conditions, each = [{...}, ...] (one trial per entry, with variables)
///   [[file]]              path (glob with * and ?, and {variables}), format, what its columns are
///
/// The keys are documented in data/io/README.md; pipelines/sessions/elbow_curls.toml is a worked example.

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "data/io/csv.hpp"
#include "data/io/recording.hpp"
#include "data/model/error.hpp"
#include "data/model/session.hpp"

namespace brachium::io {

/// One column of a file and the signal it becomes: value_SI = scale * (to SI of (column)) + offset.
struct SignalMapping {
  std::string column;  ///< name of the column; empty: every column (or the only one)
  std::string name;    ///< signal name; {column} and trial variables are replaced
  data::Quantity quantity = data::Quantity::other;
  std::string unit;  ///< unit of the column; empty: as the file says
  std::string muscle;
  std::string coordinate;
  double scale = 1.0;   ///< sign * scale of the description
  double offset = 0.0;  ///< added after scaling, in SI
  data::SourceSpan where;
};

enum class FileFormat { csv, noraxon, opensim };

struct FileMapping {
  std::string path;  ///< relative to the recordings folder; *, ? and {variables}
  FileFormat format = FileFormat::csv;
  CsvLayout csv;                    ///< format csv only
  std::vector<std::string> trials;  ///< patterns of trial names the file belongs to; empty: all
  TimingOptions timing;
  double time_offset_s = 0.0;  ///< added to the file's time stamps: aligns recorders' clocks
  std::vector<SignalMapping> signals;
  data::SourceSpan where;
};

struct TrialDescription {
  data::TrialInfo info;                          ///< without signals
  std::map<std::string, std::string> variables;  ///< what {name} stands for in paths and signal names
};

struct SessionDescription {
  std::filesystem::path file;
  std::filesystem::path recordings;  ///< base folder, resolved against the description's own folder
  data::SessionInfo session;         ///< subject, anthropometry, attributes; no trials
  std::vector<TrialDescription> trials;
  std::vector<FileMapping> files;
  data::SourceSpan recordings_where;
};

/// One file of one trial, found on the disk.
struct ResolvedFile {
  std::size_t trial = 0;  ///< index into SessionDescription::trials
  std::size_t file = 0;   ///< index into SessionDescription::files
  std::filesystem::path path;
};

/// Reads a description. `overrides`: key of [session] (or a dotted key from the root) -> TOML value as text,
/// as given by --set; a relative `recordings` from an override is relative to the current folder. Throws
/// InputError with every mistake and its place.
SessionDescription read_session_description(const std::filesystem::path& file,
                                            const std::map<std::string, std::string>& overrides = {});

/// The files of all trials. Throws InputError with all mistakes: "missing-folder", "missing-file" (with the
/// nearest name), "ambiguous-file" (a pattern that matches several).
std::vector<ResolvedFile> resolve_files(const SessionDescription& description);

/// Everything import_session would refuse that can be seen from headers: files, columns, units, duplicate
/// signals. Returns warnings; throws InputError with all errors at once.
std::vector<data::Diagnostic> check_session(const SessionDescription& description);

/// Streams the whole session into `sink`, in SI units, signal by signal; memory stays small for long
/// recordings. Returns warnings and notes (jitter, bridged gaps, constant channels). Throws InputError with
/// all mistakes of all files.
std::vector<data::Diagnostic> import_session(
    const SessionDescription& description, data::SessionSink& sink,
    const std::function<void(double fraction, const std::string& what)>& progress = {});

}  // namespace brachium::io
