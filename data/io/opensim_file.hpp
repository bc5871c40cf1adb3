#pragma once
/// OpenSim storage files, .sto and .mot, in all dialects met: version 1 to 3 headers, CEINMS'
/// `datacolumns/datarows` (as SIMM wrote them, with `range`), no version at all, missing row and column
/// counts, comment text before `endheader`, headers and rows saved as CSV by a spreadsheet, trailing
/// delimiters.

#include <filesystem>
#include <map>
#include <span>
#include <string>

#include "data/io/recording.hpp"
#include "data/model/signal.hpp"

namespace brachium::io {

/// inDegrees=yes says that rotational columns are in degrees, but not which columns those are. Stated rule: a
/// column is rotational unless its name ends in _tx, _ty, _tz (OpenSim's translations), _force, _moment, _X,
/// _Y, _Z, _vx, _vy, _vz, _px, _py or _pz, holds a dot (muscle states of OpenSim 3), or is a path of OpenSim
/// 4 outside /jointset. Such columns carry the unit "deg" in a file in degrees, all others none: an import
/// names their units.
bool is_rotational_column(const std::string& name);

struct StorageHeader {
  int version = 0;  ///< 0: not stated
  bool in_degrees = false;
  std::map<std::string, std::string> fields;  ///< every key=value of the header, as written
};

/// Opens a storage file. A stated row count that disagrees with the rows is an error found by check_timing
/// (the file may be cut off); a stated column count that disagrees with the column labels is a warning in the
/// header's notes, since every row is held against the labels. Throws InputError: "missing-file",
/// "empty-file", "not-a-storage-file", "duplicate-column", "unsupported-data-type" (DataType other than
/// double), "unsupported-version".
Recording open_storage(const std::filesystem::path& file, StorageHeader* header = nullptr);

/// Writes signals of equal rate, start and count as a version-1 storage file (tab separated, all digits),
/// atomically. Angles are written in radians with inDegrees=no, or in degrees with inDegrees=yes. Throws
/// InputError("unequal-time-stamps") naming the first signal that differs.
void write_storage(std::span<const data::Signal> signals, const std::string& title,
                   const std::filesystem::path& file, bool in_degrees = false);

}  // namespace brachium::io
