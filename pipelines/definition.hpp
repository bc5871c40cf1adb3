#pragma once
/// A pipeline definition: which stages, wired how, with which options, on which session and scene. A TOML
/// file, documented key by key in pipelines/README.md. Reading it finds every mistake that can be found
/// before running.

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/io/toml.hpp"
#include "data/model/scene.hpp"
#include "pipelines/expectation.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// The name under which the pipeline's own recordings are wired.
inline const std::string session_stage = "session";

/// What feeds a port: a stage's output (or the session), or a file from elsewhere ("file:old.subject.toml").
struct Wire {
  std::string stage;           ///< empty where a file is named
  std::filesystem::path file;  ///< absolute
  data::SourceSpan where;
};

struct StageDefinition {
  std::size_t number = 0;  ///< place in the definition from 1; the start of its output's file name
  std::string name;
  const StageSpec* spec = nullptr;
  Options options;
  std::map<std::string, std::vector<Wire>> inputs;  ///< by port
  std::vector<std::string> trials;                  ///< shell patterns; empty: all
  bool export_sto = false;
  data::SourceSpan where, trials_where;
};

struct Definition {
  std::filesystem::path file;
  std::string title;
  std::filesystem::path session;  ///< absolute; a session file (.h5) or a description (.toml); empty: none
  std::map<std::string, std::string> session_overrides;  ///< key of the description -> TOML value
  std::filesystem::path scene_file;                      ///< absolute, empty: none
  std::optional<data::Scene> scene;
  std::size_t threads = 0;              ///< 0: all cores
  io::TomlNode variables;               ///< table: name -> value
  std::vector<StageDefinition> stages;  ///< in the order of the file
  std::vector<std::size_t> order;       ///< indices of stages: each after all it reads
  std::vector<Expectation> expectations;
  std::vector<std::string> settings;       ///< KEY=VALUE texts that were applied
  std::vector<data::Diagnostic> warnings;  ///< of session and scene

  bool session_is_description() const { return session.extension() == ".toml"; }
  const StageDefinition* find(const std::string& stage) const;
};

/// Whether the stages' own checks (StageSpec::check) are part of reading a definition. They read the files
/// that options name; a definition is also read to look at it where these are no longer at hand.
enum class StageChecks { leave, run };

/// Reads and checks a definition; paths in it are relative to its folder, paths in `settings` to the current
/// one. The definition refers to the catalogue, which must outlive it. Throws InputError with all mistakes at
/// once: those of the definition, of its scene and of its session description, and of its stages.
Definition read_definition(const std::filesystem::path& file, std::span<const std::string> settings,
                           const Catalogue& catalogue, StageChecks checks = StageChecks::leave);

/// The definition with every default written out and paths absolute; reading it gives the same definition.
std::string resolved_text(const Definition& definition);

/// Indices of `stages` in an order in which each follows all stages it reads, as early in the file as
/// possible. A loop is added to `diagnostics` ("cycle") with the names of its stages.
std::vector<std::size_t> topological_order(std::span<const StageDefinition> stages,
                                           std::vector<data::Diagnostic>& diagnostics);

std::string to_string(PortType type);  ///< "signals", "a subject", "tables"

}  // namespace brachium::pipelines
