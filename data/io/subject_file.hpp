#pragma once
/// A calibrated subject as a TOML file: units in the keys, provenance, verdicts. Numbers keep all 17 digits.

#include <filesystem>
#include <string>

#include "data/model/subject.hpp"

namespace brachium::io {

std::string subject_to_toml(const data::Subject& subject);
/// Strict: every mistake (unknown key, missing key, value outside its domain) at once, with file:line:column.
/// An infinite standard error stands in the file as the text "not identified", an infinite bound as inf.
data::Subject parse_subject(const std::string& toml, const std::string& file_name);

/// Atomic: the file is the old one or the whole new one.
void write_subject(const data::Subject& subject, const std::filesystem::path& file);
data::Subject read_subject(const std::filesystem::path& file);

}  // namespace brachium::io
