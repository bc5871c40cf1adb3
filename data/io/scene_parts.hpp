#pragma once
/// The parts of a scene file, one reader each. For data/io/scene_file.cpp; use that.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "data/io/toml.hpp"
#include "data/model/scene.hpp"

namespace brachium::io::detail {

/// A scene as it is being read, with all mistakes found so far.
struct SceneDraft {
  data::Scene scene;
  std::filesystem::path folder;  ///< csv files are relative to it
  std::vector<data::Diagnostic> diagnostics;
};

/// A number of a named thing that must lie in a domain; NaN (and an error naming thing, key, value and
/// domain) if not.
struct DomainReader {
  TomlTable& table;
  std::string owner;  ///< "muscle `BRA`"

  double positive(const std::string& key) { return check(key, true, table.require_number(key)); }
  double positive(const std::string& key, double fallback) {
    return check(key, true, table.number(key).value_or(fallback));
  }
  double non_negative(const std::string& key) { return check(key, false, table.require_number(key)); }
  double non_negative(const std::string& key, double fallback) {
    return check(key, false, table.number(key).value_or(fallback));
  }

 private:
  double check(const std::string& key, bool strictly, double value);
};

/// Reports a name used twice among things of one kind: "duplicate-muscle", ...
void check_unique(const std::string& kind, const std::string& name, std::vector<std::string>& seen,
                  TomlTable& table);

/// The [[muscle]] entries: parameters, activation, geometry, drive. `channels` as in read_scene.
void read_muscles(TomlTable& root, SceneDraft& draft, std::span<const std::string> channels);

/// Drops what no wanted quantity depends on, with a note each, and notes undriven muscles that stay.
void leave_out_unwanted(data::Scene& scene);

}  // namespace brachium::io::detail
