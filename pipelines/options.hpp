#pragma once
/// Options of a stage, from a TOML table and the stage's specification. Every mistake is collected with its
/// place.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "data/io/toml.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// Reads the options in `table`, with their places (Options::where). `owner` names it in messages ("stage
/// `excitation` (emg.envelope)"). Keys in `reserved` belong to the pipeline and are left alone. Options that
/// are absent get their defaults. Mistakes go to `diagnostics`: unknown-key, wrong-unit, wrong-type,
/// out-of-range, unknown-value, missing-option, wrong-length.
Options parse_options(const io::TomlNode& table, std::span<const OptionSpec> specs, const std::string& owner,
                      std::span<const std::string> reserved, std::vector<data::Diagnostic>& diagnostics);

/// The same from a text ("lowpass_hz = 6"); throws InputError with all mistakes. For tests and programs.
Options options_from_text(const std::string& toml, const StageSpec& stage);

/// Options as a TOML table, keys in the order of the specification; numbers round-trip.
io::TomlNode options_tree(const Options& options, std::span<const OptionSpec> specs);

/// Calls `visit` for every file that the options name (OptionSpec::is_file), also in nested tables, with the
/// place where it is named; it may change the path.
void for_each_file(
    Options& options, std::span<const OptionSpec> specs,
    const std::function<void(const OptionSpec&, std::string&, const data::SourceSpan&)>& visit);

/// One value as TOML would write it: 6.0, "mvc", [1.0, 2.0].
std::string value_text(const OptionValue& value);

/// A TOML value as it would stand right of `=`.
std::string node_text(const io::TomlNode& value);

/// "0.1 to 500 Hz", "greater than 0", "" where there is no range.
std::string range_text(const OptionSpec& spec);

/// "number", "list of texts", ...
std::string to_string(OptionType type);

}  // namespace brachium::pipelines
