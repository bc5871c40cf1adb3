#pragma once
/// What a stage is: a pure function of named, typed inputs and options, with one specification from which
/// validation, defaults, `explain`, templates and the manual come. The runner alone reads and writes files.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "data/model/error.hpp"
#include "data/model/scene.hpp"
#include "data/model/session.hpp"
#include "data/model/subject.hpp"
#include "data/model/table.hpp"
#include "pipelines/report/document.hpp"

namespace brachium::pipelines {

// ---------------------------------------------------------------- options

/// `table` is one table with the keys of `fields`, `tables` a list of them. `number_map` is a table whose
/// keys the user chooses (names of regions, of conditions), each with a number; a plain number stands for {
/// "*" = number }.
enum class OptionType { number, integer, boolean, text, numbers, texts, table, tables, number_map };

class Options;
using OptionValue =
    std::variant<double, std::int64_t, bool, std::string, std::vector<double>, std::vector<std::string>,
                 std::vector<Options>, std::map<std::string, double>>;

/// One option of a stage: everything a user may ask about it.
struct OptionSpec {
  std::string key;  ///< with its unit at the end where it has one: "lowpass_hz"
  OptionType type = OptionType::number;
  std::string unit;                     ///< "Hz", "s", ...; empty where it has none
  std::string doc;                      ///< one sentence, with the source where the default has one
  std::optional<OptionValue> fallback;  ///< default; none: required, unless `optional`
  bool optional = false;                ///< may be absent with no default
  std::optional<double> lower, upper;   ///< inclusive range of a number (every entry of numbers)
  bool lower_open = false, upper_open = false;
  std::vector<std::string> allowed;  ///< admissible texts; empty: any
  std::vector<OptionSpec> fields{};  ///< of a table, for OptionType::table and tables
  std::size_t length = 0;            ///< numbers: so many of them (3: a vector); 0: any
  bool is_file = false;  ///< text: an existing file, relative to the definition; part of the fingerprint
  /// Files that such a file names itself, as far as they exist: part of the fingerprint too.
  std::vector<std::filesystem::path> (*files_within)(const std::filesystem::path& file) = nullptr;
};

/// Validated options: every key of the specification that is required or has a default is present.
class Options {
 public:
  void set(const std::string& key, OptionValue value) { values_[key] = std::move(value); }
  bool has(const std::string& key) const { return values_.contains(key); }
  const std::map<std::string, OptionValue>& values() const { return values_; }

  // A key that the specification does not have is a programming error: these throw std::logic_error.
  double number(const std::string& key) const;
  std::int64_t integer(const std::string& key) const;
  bool boolean(const std::string& key) const;
  const std::string& text(const std::string& key) const;
  const std::vector<double>& numbers(const std::string& key) const;
  const std::vector<std::string>& texts(const std::string& key) const;
  const std::vector<Options>& tables(const std::string& key) const;
  const Options& table(const std::string& key) const;
  const Options* maybe_table(const std::string& key) const;  ///< null where it is absent
  const std::map<std::string, double>& number_map(const std::string& key) const;
  std::optional<double> maybe_number(const std::string& key) const;
  std::optional<std::string> maybe_text(const std::string& key) const;

  /// Where the user wrote it: the value of "key", an entry of its list "key[2]", a name of its table
  /// "key.name", or, for an empty path, this table. What was not written stands where its list or table does.
  /// Not part of the value: options are equal wherever they were written.
  const data::SourceSpan& where(const std::string& path = {}) const;
  void set_where(const std::string& path, data::SourceSpan where) { places_[path] = std::move(where); }

 private:
  std::map<std::string, OptionValue> values_;
  std::map<std::string, data::SourceSpan> places_;
};

// ---------------------------------------------------------------- inputs and outputs

/// What may flow along an edge of a pipeline.
enum class PortType { signals, subject, tables };

struct InputSpec {
  std::string name;
  PortType type = PortType::signals;
  std::string doc;
  bool optional = false;
  bool many = false;                 ///< takes a list of stages
  bool defaults_to_session = false;  ///< when not wired, the pipeline's session
};

/// One stage's stored output, as later stages and the report see it.
struct StageData {
  std::string stage;                                   ///< name in the pipeline; "session" for the recordings
  std::shared_ptr<const data::SessionSource> signals;  ///< never null; may have no trials
  std::map<std::string, data::Table> tables;
  std::optional<data::Subject> subject;
  std::map<std::string, std::string> attributes;  ///< texts: what was done, assumed, excluded
  std::vector<data::Diagnostic> diagnostics;      ///< warnings and notes of the run that made it
};

/// Where a stage leaves its results. Signals are streamed; the rest is kept until the end of the stage.
struct StageOutput {
  data::SessionSink* signals = nullptr;  ///< never null while a stage runs
  std::map<std::string, data::Table> tables;
  std::optional<data::Subject> subject;
  std::map<std::string, std::string> attributes;
  std::vector<data::Diagnostic> diagnostics;

  /// Why the numbers did not reach their end, where what was reached is worth keeping: the output is stored
  /// and shown in the report, but the stage counts as failed (exit code 1) and runs again next time.
  std::optional<std::string> failure;
  /// Names of further files that the stage wrote beside its output (StageContext::beside).
  std::vector<std::string> files;

  void warn(std::string code, std::string message, std::string help = {});
  void note(std::string code, std::string message);
};

/// What a stage is given.
struct StageContext {
  std::string name;  ///< of this stage in the pipeline
  const Options* options = nullptr;
  std::map<std::string, std::vector<const StageData*>> inputs;  ///< by port name; one entry unless `many`
  const data::Scene* scene = nullptr;                           ///< null if the pipeline names none
  std::vector<std::string> trials;  ///< trials to work on, already matched against the stage's `trials`
                                    ///< patterns; in the order of the first signals input
  std::size_t threads = 1;
  std::function<void(double fraction, const std::string& what)> progress;  ///< may be called from any thread
  std::function<void(const std::string& line)> say;  ///< a line for the log; may be empty
  /// What the output is made from (fingerprint.hpp); empty where a stage runs in memory.
  std::map<std::string, std::string> made_from;
  /// "<run folder>/03-muscle": how names of further files of this stage begin; empty in memory (none are
  /// written then). They are written atomically and named in StageOutput::files; "<beside>.restart" is a
  /// folder of the stage's own for what a later run can go on from.
  std::filesystem::path beside;

  const StageData& input(const std::string& port) const;        ///< the one entry; std::logic_error if absent
  const StageData* maybe_input(const std::string& port) const;  ///< null if not wired
  /// The pipeline's scene; throws InputError("missing-scene") naming the stage if there is none.
  const data::Scene& need_scene() const;
};

// ---------------------------------------------------------------- specification

/// A stage's chapter of the report and its sentence in the methods text.
struct ReportContext {
  std::string name;
  const Options* options = nullptr;
  const StageData* output = nullptr;
  std::map<std::string, std::vector<const StageData*>> inputs;
  const data::Scene* scene = nullptr;
};

/// What can be judged before anything runs.
struct CheckContext {
  std::string name;  ///< of this stage in the pipeline
  const Options* options = nullptr;
  const data::Scene* scene = nullptr;  ///< null if the pipeline names none
};

struct StageSpec {
  std::string name;     ///< "emg.envelope"
  std::string summary;  ///< one line
  std::string doc;      ///< paragraphs: what it does, with sources (DOI)
  std::vector<InputSpec> inputs;
  std::vector<OptionSpec> options;
  PortType output = PortType::signals;
  bool needs_scene = false;
  std::function<void(const StageContext&, StageOutput&)> run;
  /// Mistakes of options that fit the specification one by one and not together, or not with the files they
  /// name; each with its place (Options::where). May be empty; need not find what only the inputs can tell.
  std::function<std::vector<data::Diagnostic>(const CheckContext&)> check;
  std::function<void(const ReportContext&, report::Section&)> report;  ///< may be empty
  std::function<std::string(const ReportContext&)> methods;            ///< may be empty
  int version = 1;  ///< raised when the stage gives other results for the same inputs and options
};

/// All stages by name. Each folder adds its own (pipelines/stages/*.cpp).
class Catalogue {
 public:
  void add(StageSpec spec);  ///< std::logic_error on a name clash
  const StageSpec* find(const std::string& name) const;
  std::vector<std::string> names() const;
  const std::vector<StageSpec>& stages() const { return stages_; }

 private:
  std::vector<StageSpec> stages_;
};

/// The catalogue of everything that is built in.
Catalogue built_in_catalogue();

// One function per folder; called by built_in_catalogue().
void add_session_stages(Catalogue& catalogue);   ///< twin.session
void add_emg_stages(Catalogue& catalogue);       ///< emg.quality, emg.envelope, emg.onset, emg.activation
void add_limb_stages(Catalogue& catalogue);      ///< limb.kinematics, limb.inverse_dynamics, limb.dynamometer
void add_hill_stages(Catalogue& catalogue);      ///< hill.moment
void add_fem_stages(Catalogue& catalogue);       ///< fem.solve, fem.muscle_map
void add_optimise_stages(Catalogue& catalogue);  ///< optimise.calibrate, optimise.cross_validate
void add_compare_stages(Catalogue& catalogue);   ///< pipelines.compare

}  // namespace brachium::pipelines
