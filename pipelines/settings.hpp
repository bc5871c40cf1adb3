#pragma once
/// What a user may change of a definition without editing it: `--set KEY=VALUE` and ${variables}.
///
/// KEY is `stage.option`, `stage.trials`, `stage.input.port`, `pipeline.key`, `expect` or `expect.NAME.key`,
/// a name in [variables], or a key of the session description ("recordings", "session.body_mass_kg").

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "data/io/toml.hpp"

namespace brachium::pipelines {

struct AppliedSettings {
  io::TomlNode variables;                                ///< name -> value, as used
  std::map<std::string, std::string> session_overrides;  ///< for the session description
};

/// Applies `settings` to the tree of a definition and replaces ${name} in its texts. Relative paths in
/// settings are made absolute against `current`, those in [variables] with `path = true` against `folder`.
/// Mistakes: bad-setting, unknown-setting, unknown-variable, unset-variable.
AppliedSettings apply_settings(io::TomlNode& root, std::span<const std::string> settings,
                               const std::filesystem::path& folder, const std::filesystem::path& current,
                               std::vector<data::Diagnostic>& diagnostics);

}  // namespace brachium::pipelines
