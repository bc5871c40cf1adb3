#pragma once
/// Single-signal CSV exports of Noraxon's MR software: a metadata row (type, name, time_units, begin_time,
/// frequency, count, units), a blank line, then time and value | x,y,z | x,y,z,w.

#include <filesystem>

#include "data/io/recording.hpp"

namespace brachium::io {

/// Opens an export. Throws InputError: "missing-file", "empty-file", "not-noraxon" (what is missing),
/// "unknown-type". The stated count and frequency are checked against the rows by check_timing.
Recording open_noraxon(const std::filesystem::path& file);

}  // namespace brachium::io
