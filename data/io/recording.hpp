#pragma once
/// A recording in a text file, whatever its format: columns of numbers against time, read by rows, so that
/// memory does not grow with its length. The readers (csv.hpp, noraxon.hpp, opensim_file.hpp) know the
/// headers; this knows the rows.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
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
  std::string name;                      ///< title, or empty
  std::vector<RecordingColumn> columns;  ///< without the time column
  bool has_time = false;                 ///< a time column is there
  std::string time_unit = "s";
  std::optional<double> rate_hz;        ///< stated rate
  std::optional<double> start_time_s;   ///< stated time of the first row
  std::optional<std::size_t> rows;      ///< stated number of rows
  std::vector<data::Diagnostic> notes;  ///< oddities of the header that do no harm

  /// Index of the column of that name; throws InputError("missing-column") naming the file and the nearest
  /// column.
  std::size_t column_index(const std::string& column, const std::filesystem::path& file) const;
};

/// How rows are written. Filled by the readers.
struct RowFormat {
  char delimiter = ',';  ///< ' ' means any run of blanks and tabs
  bool decimal_comma = false;
  std::string comment;                    ///< lines that start with this are skipped; empty: none
  bool quotes = true;                     ///< fields may stand in double quotes
  std::optional<std::size_t> time_field;  ///< field that holds the time
  double time_to_s = 1.0;                 ///< factor from the file's time unit to s
  std::vector<std::size_t> value_fields;  ///< field of each column of the header
  std::size_t fields = 0;                 ///< fields a row must have (0: not checked)
  bool trailing_empty = false;            ///< rows may end with further empty fields
  std::size_t first_line = 1;             ///< line (from 1) of the first row
  std::uintmax_t first_byte = 0;          ///< its place in the file
};

class Recording {
 public:
  Recording(std::filesystem::path file, RecordingHeader header, RowFormat format);
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;

  const std::filesystem::path& file() const;
  const RecordingHeader& header() const;

  /// Reads up to time.size() rows. `time` [s] gets the time stamps (0 without a time column); `values` is
  /// row-major, rows x columns, in the file's units. Returns the number of rows, 0 at the end. Throws
  /// InputError with file:line:column: "not-a-number", "missing-field", "extra-field", "non-finite-sample".
  std::size_t read_rows(std::span<double> time, std::span<double> values);
  /// The same for the time stamps alone, several times faster; other fields are not looked at.
  std::size_t read_times(std::span<double> time);
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
  std::size_t rows = 0;     ///< rows of the file
  std::size_t samples = 0;  ///< samples on the even grid; equals rows unless gaps are bridged
  double rate_hz = 0.0;     ///< stated rate, else the mean rate of the time stamps
  double start_time_s = 0.0;
  double largest_jitter = 0.0;  ///< largest distance of a time stamp from the even grid [sample periods]
  std::size_t gaps = 0;         ///< steps longer than 1.5 sample periods
  double longest_gap_s = 0.0;
  std::size_t first_gap_line = 0;
};

/// Rules for uneven time stamps.
enum class TimingRule {
  strict,      ///< gaps, jitter and rates that disagree with the stamps are errors
  interpolate  ///< gaps and jitter are bridged by straight lines onto the even grid, with a warning
};

struct TimingOptions {
  TimingRule rule = TimingRule::strict;
  std::optional<double> rate_hz = {};  ///< overrides what the file states; must agree with its time stamps,
                                       ///< if any; with TimingRule::interpolate: the rate of the even grid
  bool ignore_stated_rows = false;     ///< a row count in the header that is wrong becomes a warning
};

/// Checks time stamps and counts rows. Time stamps must lie within 0.1 sample periods of the even grid
/// (TimingRule); a stated rate must agree with them to 0.1 %. Without a stated rate the mean rate of the
/// stamps is taken, rounded to a whole number of Hz where that moves no stamp by more than 1 % of a sample
/// period. Throws InputError with the place: "empty-recording", "time-backwards", "time-gap", "time-jitter",
/// "rate-mismatch", "row-count-mismatch", "no-time" (neither a time column nor a rate). Rewinds. Adds
/// warnings to `warnings`.
Timing check_timing(Recording& recording, const TimingOptions& options,
                    std::vector<data::Diagnostic>& warnings);

/// Hands the samples of the chosen columns on in blocks, evenly spaced as `timing` says: sink(first, block),
/// block column-major: block[c] are the samples of columns[c]. With TimingRule::interpolate they are read off
/// straight lines between the recorded rows. Memory does not grow with the recording.
using BlockSink = std::function<void(std::size_t first, std::span<const std::vector<double>> block)>;
void stream_columns(Recording& recording, const Timing& timing, TimingRule rule,
                    std::span<const std::size_t> columns, const BlockSink& sink);

/// All columns in memory, in the file's units, evenly spaced; for files known to be small.
std::vector<data::Signal> read_all(Recording& recording, const TimingOptions& options = {});

}  // namespace brachium::io
