#pragma once
/// Delimited text of any common layout.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "data/io/recording.hpp"

namespace brachium::io {

/// How a delimited file is laid out. Rows are counted from 1 after skip_rows; comment lines are not counted.
/// A header cell "emg1 (uV)" or "emg1 [uV]" gives name and unit where the units row says nothing.
struct CsvLayout {
  std::string delimiter = ",";  ///< one character, "tab" or "whitespace"
  bool decimal_comma = false;   ///< 3,14; the delimiter must then be another character
  std::string comment = {};     ///< prefix of lines to skip; empty: none
  std::size_t skip_rows = 0;    ///< rows before everything else (free text of the recorder)
  /// Row with the column names; none: columns are named "1", "2", ...
  std::optional<std::size_t> header_row = 1;
  std::optional<std::size_t> units_row = {};       ///< row with the units
  std::optional<std::size_t> first_data_row = {};  ///< default: the row after header and units
  std::string time_column = {};                    ///< name of the time column; empty: there is none
  std::string time_unit = "s";                     ///< used where the units row says nothing
  std::optional<double> rate_hz = {};              ///< needed where there is no time column
  double start_time_s = 0.0;                       ///< used where there is no time column
};

/// Opens a delimited file. Throws InputError: "missing-file", "empty-file", "missing-column",
/// "duplicate-column", "bad-layout".
Recording open_csv(const std::filesystem::path& file, const CsvLayout& layout);

/// Splits one line into fields; quoted fields may hold the delimiter and doubled quotes. Blanks around are
/// removed.
std::vector<std::string> split_fields(const std::string& line, const std::string& delimiter);

}  // namespace brachium::io
