#pragma once
/// A recording in a text file, whatever its format: columns of numbers against time, read by rows, so that memory
/// does not grow with its length. The readers (csv.hpp, noraxon.hpp, opensim_file.hpp) know the headers; this knows
/// the rows.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/model/error.hpp"
#include "data/model/signal.hpp"

namespace brachium::io {

struct RecordingColumn {
  std::string name;
  std::string unit;  ///< as the file says it; empty if it does not
};

/// What a file says of itself before its first row.
struct RecordingHeader {
  std::string name;                            ///< title, or empty
  std::vector<RecordingColumn> columns;        ///< without the time column
  bool has_time = false;                       ///< a time column is there
  std::string time_unit = "s";
  std::optional<double> rate_hz;               ///< stated rate
  std::optional<double> start_time_s;          ///< stated time of the first row
  std::optional<std::size_t> rows;             ///< stated number of rows
  std::vector<data::Diagnostic> notes;         ///< oddities of the header that do no harm

  /// Index of the column of that name; throws InputError("missing-column") naming the file and the nearest column.
  std::size_t column_index(const std::string& column, const std::filesystem::path& file) const;
};

/// How rows are written. Filled by the readers.
struct RowFormat {
  char delimiter = ',';          ///< ' ' means any run of blanks and tabs
  bool decimal_comma = false;
  std::string comment;           ///< lines that start with this are skipped; empty: none
  bool quotes = true;            ///< fields may stand in double quotes
  std::optional<std::size_t> time_field;     ///< field that holds the time
  std::vector<std::size_t> value_fields;     ///< field of each column of the header
  std::size_t fields = 0;                    ///< fields a row must have (0: not checked)
  bool trailing_empty = false;               ///< rows may end with further empty fields
  std::size_t first_line = 1;                ///< line (from 1) of the first row
  std::uintmax_t first_byte = 0;             ///< its place in the file
  bool allow_non_finite = false;             ///< NaN and Inf are handed on instead of refused
};

class Recording {
 public:
  Recording(std::filesystem::path file, RecordingHeader header, RowFormat format);
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  const std::filesystem::path& file() const;
  const RecordingHeader& header() const;

  /// Reads up to time.size() rows. `time` [s] gets the time stamps (NaN without a time column); `values` is row-major,
  /// rows x columns, in the file's units. Returns the number of rows, 0 at the end.
  /// Throws InputError with file:line:column: "not-a-number", "missing-field", "extra-field", "non-finite-sample".
  std::size_t read_rows(std::span<double> time, std::span<double> values);
  void rewind();
  /// Line (from 1) of the row that was read last.
  std::size_t line() const;
  double bytes_read_fraction() const;  ///< for progress

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What the time stamps of a recording say, found in one pass over it.
struct Timing {
  std::size_t rows = 0;
  double rate_hz = 0.0;         ///< stated rate, else the mean rate of the time stamps
  double start_time_s = 0.0;
  double largest_jitter = 0.0;  ///< largest distance of a time stamp from the even grid [sample periods]
  std::size_t gaps = 0;         ///< steps longer than 1.5 sample periods
  double longest_gap_s = 0.0;
  std::size_t first_gap_line = 0;
};

/// Rules for uneven time stamps.
enum class TimingRule {
  strict,      ///< gaps, repeated stamps and rates that disagree with the stamps are errors
  interpolate  ///< as strict, but gaps and jitter are bridged by straight lines onto the even grid, with a warning
};

/// Checks time stamps and counts rows; throws InputError: "empty-recording", "time-backwards", "time-gap",
/// "rate-mismatch", "row-count-mismatch", "no-time" (neither a time column nor a rate). Rewinds.
/// `rate_hz` overrides what the file states (and must agree with the time stamps, if there are any).
Timing check_timing(Recording& recording, TimingRule rule = TimingRule::strict,
                    std::optional<double> rate_hz = std::nullopt);

/// All columns in memory, in the file's units, evenly spaced; for files known to be small.
std::vector<data::Signal> read_all(Recording& recording, TimingRule rule = TimingRule::strict,
                                   std::optional<double> rate_hz = std::nullopt);

}  // namespace brachium::io
