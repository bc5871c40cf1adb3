#pragma once
/// TOML as a plain tree in which every value knows where it was written, and a strict reader over it that
/// collects all mistakes of a file before it complains.

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::io {

struct TomlNode {
  enum class Kind { boolean, integer, number, text, array, table };
  Kind kind = Kind::table;
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0.0;  ///< also set for integers
  std::string text;
  std::vector<TomlNode> items;                            ///< array
  std::vector<std::pair<std::string, TomlNode>> members;  ///< table, in the order of the file
  data::SourceSpan where;                                 ///< the value
  data::SourceSpan key_where;                             ///< the key it stands under, if any

  const TomlNode* find(const std::string& key) const;
  TomlNode* find(const std::string& key);
  /// Member of that name, made if absent (turns the node into a table).
  TomlNode& member(const std::string& key);

  static TomlNode of(bool value);
  static TomlNode of(std::int64_t value);
  static TomlNode of(double value);
  static TomlNode of(std::string value);
  static TomlNode of(const char* value) { return of(std::string(value)); }
  static TomlNode of(std::vector<double> values);
  static TomlNode of(std::vector<std::string> values);
  static TomlNode table();
};

std::string describe(TomlNode::Kind kind);  ///< "a number", "a table", ...

/// Parses a text or file. Throws InputError("toml-syntax") or ("missing-file") with a place.
TomlNode parse_toml(const std::string& text, const std::string& file_name);
TomlNode read_toml(const std::filesystem::path& file);
/// Parses a single value as it would stand right of `=`; bare words that are not TOML become text.
TomlNode parse_toml_value(const std::string& text, const std::string& origin);
/// The tree as TOML text: scalars first, then sub-tables; numbers round-trip.
std::string write_toml(const TomlNode& root);

/// A strict view of one table. Reading a key marks it as known; finish() reports every other key.
/// All mistakes go to the shared list; nothing is thrown until raise().
class TomlTable {
 public:
  TomlTable(const TomlNode& node, std::vector<data::Diagnostic>& diagnostics, std::string context = {});

  bool has(const std::string& key) const;
  const TomlNode& node() const { return *node_; }

  std::optional<double> number(const std::string& key);
  std::optional<std::int64_t> integer(const std::string& key);
  std::optional<bool> boolean(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::optional<std::vector<double>> numbers(const std::string& key);
  std::optional<std::vector<std::string>> texts(
      const std::string& key);  ///< one text stands for a list of one
  std::optional<TomlTable> table(const std::string& key);
  std::vector<TomlTable> tables(const std::string& key);  ///< array of tables; empty if absent

  double require_number(const std::string& key);  ///< NaN if missing or wrong (then an error is in the list)
  std::string require_text(const std::string& key);
  /// A number that must lie in [lower, upper] (exclusive bounds by name), else a "out-of-range" error.
  double positive(const std::string& key, std::optional<double> fallback = std::nullopt);
  double non_negative(const std::string& key, std::optional<double> fallback = std::nullopt);

  /// Marks a key as known without reading it (for values read through node()).
  void know(const std::string& key) { known_.insert(key); }
  void error(const std::string& code, const std::string& message, const std::string& key = {},
             const std::string& help = {});
  void warning(const std::string& code, const std::string& message, const std::string& key = {},
               const std::string& help = {});
  data::SourceSpan span_of(const std::string& key) const;  ///< the key's value, or the table itself
  /// Reports unknown keys, each with the nearest one that was asked for, or with the unit that it is given in.
  void finish();

 private:
  const TomlNode* take(const std::string& key);
  void wrong_type(const std::string& key, const std::string& wanted, const TomlNode& got);

  const TomlNode* node_;
  std::vector<data::Diagnostic>* diagnostics_;
  std::string context_;  ///< "stage `excitation`", for messages
  std::set<std::string> known_;
  mutable std::set<std::string> asked_;  ///< of `has`, known or not: what a mistaken key may have meant
};

/// Throws InputError with all diagnostics if any of them is an error.
void raise_if_errors(const std::vector<data::Diagnostic>& diagnostics);

}  // namespace brachium::io
