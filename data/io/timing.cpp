#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/io/recording.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using data::SourceSpan;

constexpr std::size_t block_rows = 4096;
constexpr double rate_tolerance = 1e-3;   // stated rate against time stamps, relative
constexpr double jitter_tolerance = 0.1;  // [sample periods] a time stamp may lie off the even grid
constexpr double rounding_tolerance =
    0.01;                           // [sample periods] rounding the rate to whole Hz may move a stamp
constexpr double gap_factor = 1.5;  // [sample periods] a longer step is a gap

constexpr double most_made_up = 10.0;  // samples a row may stand for when gaps are bridged
constexpr std::size_t steps_for_median = 1000;

SourceSpan line_of(const Recording& recording, std::size_t line) {
  return {recording.file().string(), static_cast<int>(line), 0, 1, {}};
}

// Calls visit(row, time, line) for the time stamp of every row; returns the number of rows.
template <class Visit>
std::size_t each_stamp(Recording& recording, Visit visit) {
  recording.rewind();
  std::size_t rows = 0;
  double time = 0.0;
  for (; recording.read_times(std::span(&time, 1)) == 1; ++rows) visit(rows, time, recording.line());
  recording.rewind();
  return rows;
}

/// What one pass over the time stamps gives without knowing the rate.
struct Stamps {
  std::size_t rows = 0;
  double first = 0.0, last = 0.0;
  double rate_hz = 0.0;  // of the steps that are no gaps
};

Stamps scan_stamps(Recording& recording) {
  Stamps stamps;
  std::vector<double> first_steps;
  double usual = 0.0, sum = 0.0;  // median of the first steps; sum of the steps that are no gaps
  std::size_t counted = 0;
  const auto count_step = [&](double step) {
    if (!(step <= gap_factor * usual)) return;
    sum += step;
    ++counted;
  };
  const auto settle_usual = [&] {
    if (usual > 0.0 || first_steps.empty()) return;
    std::vector<double> sorted = first_steps;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    usual = *middle;
    for (const double step : first_steps) count_step(step);
  };
  stamps.rows = each_stamp(recording, [&](std::size_t row, double time, std::size_t line) {
    if (!recording.header().has_time) return;
    if (row == 0) {
      stamps.first = time;
    } else if (!(time > stamps.last)) {
      const bool back = time < stamps.last;
      throw InputError(
          Diagnostic{Severity::error, "time-backwards",
                     fmt::format("time {} from {:.9g} s to {:.9g} s", back ? "goes back" : "stands still",
                                 stamps.last, time),
                     line_of(recording, line),
                     back ? "sort the rows, or cut the recording where its clock was reset"
                          : "the time stamps are too coarse; leave the time column out and give `rate_hz`"});
    } else if (row <= steps_for_median) {
      first_steps.push_back(time - stamps.last);
      if (row == steps_for_median) settle_usual();
    } else {
      count_step(time - stamps.last);
    }
    stamps.last = time;
  });
  settle_usual();
  if (counted > 0) stamps.rate_hz = static_cast<double>(counted) / sum;
  return stamps;
}

/// Gaps and jitter against the even grid of timing.rate_hz; returns the line of the largest jitter.
std::size_t compare_with_grid(Recording& recording, Timing& timing) {
  const double period = 1.0 / timing.rate_hz;
  double previous = 0.0, shift = 0.0;
  std::size_t jitter_line = 0;
  each_stamp(recording, [&](std::size_t row, double time, std::size_t line) {
    if (row > 0 && time - previous > gap_factor * period) {
      if (timing.gaps++ == 0) timing.first_gap_line = line;
      timing.longest_gap_s = std::max(timing.longest_gap_s, time - previous);
      // Behind a gap the grid starts anew, so that jitter is told from gaps.
      shift = time - timing.start_time_s - static_cast<double>(row) * period;
    }
    const double off =
        std::abs(time - timing.start_time_s - shift - static_cast<double>(row) * period) / period;
    if (off > timing.largest_jitter) {
      timing.largest_jitter = off;
      jitter_line = line;
    }
    previous = time;
  });
  return jitter_line;
}

// A whole number of Hz is what a recorder means when rounded time stamps say 119.99998.
double rounded_rate(double rate_hz, std::size_t rows) {
  const double whole = std::round(rate_hz);
  const auto steps = static_cast<double>(rows - 1);
  return whole >= 1.0 && std::abs(steps / whole - steps / rate_hz) * whole < rounding_tolerance ? whole
                                                                                                : rate_hz;
}

void check_row_count(const Recording& recording, std::size_t rows, bool ignore,
                     std::vector<Diagnostic>& warnings) {
  const auto& stated = recording.header().rows;
  if (!stated || *stated == rows) return;
  Diagnostic d{Severity::error, "row-count-mismatch",
               fmt::format("`{}` states {} rows but has {}", recording.file().string(), *stated, rows),
               std::nullopt, "the file may be cut off; if it is whole, say `ignore_stated_rows = true`"};
  if (!ignore) throw InputError(d);
  d.severity = Severity::warning;
  d.help.clear();
  warnings.push_back(std::move(d));
}

// Strict: the first gap or the largest jitter is an error.
void refuse_uneven(const Recording& recording, const Timing& timing, std::size_t jitter_line) {
  if (timing.gaps > 0) {
    throw InputError(Diagnostic{
        Severity::error, "time-gap",
        fmt::format("{} gap{} in time, the longest {:.6g} s at a sample period of {:.6g} s", timing.gaps,
                    timing.gaps == 1 ? "" : "s", timing.longest_gap_s, 1.0 / timing.rate_hz),
        line_of(recording, timing.first_gap_line),
        "cut the recording there, or bridge gaps with `timing = \"interpolate\"`"});
  }
  if (timing.largest_jitter > jitter_tolerance) {
    throw InputError(Diagnostic{
        Severity::error, "time-jitter",
        fmt::format("a time stamp lies {:.3g} sample periods off the even grid of {:.9g} Hz",
                    timing.largest_jitter, timing.rate_hz),
        line_of(recording, jitter_line),
        "give the true `rate_hz`, or bring the samples onto an even grid with `timing = \"interpolate\"`"});
  }
}

}  // namespace

Timing check_timing(Recording& recording, const TimingOptions& options, std::vector<Diagnostic>& warnings) {
  const RecordingHeader& header = recording.header();
  const std::string file = recording.file().string();
  const Stamps stamps = scan_stamps(recording);
  if (stamps.rows == 0) {
    throw InputError("empty-recording", fmt::format("`{}` has a header but no samples", file),
                     "export the recording again");
  }
  check_row_count(recording, stamps.rows, options.ignore_stated_rows, warnings);
  const std::optional<double> stated = options.rate_hz ? options.rate_hz : header.rate_hz;
  Timing timing;
  timing.rows = timing.samples = stamps.rows;
  timing.start_time_s = header.has_time ? stamps.first : header.start_time_s.value_or(0.0);
  if (!header.has_time || stamps.rows == 1) {
    if (!stated) {
      throw InputError("no-time",
                       header.has_time ? fmt::format("`{}` has one row and states no rate", file)
                                       : fmt::format("`{}` has neither a time column nor a rate", file),
                       "name the time column with `time`, or give `rate_hz`");
    }
    timing.rate_hz = *stated;
    return timing;
  }
  const bool bridging = options.rule == TimingRule::interpolate;
  const bool new_rate =
      bridging && options.rate_hz.has_value();  // then it is the wanted rate, not a claim about the file
  if (stated && !new_rate && !(std::abs(stamps.rate_hz / *stated - 1.0) <= rate_tolerance)) {
    throw InputError(
        "rate-mismatch",
        fmt::format("`{}`: the rate is stated as {:.6g} Hz, but the time stamps run at {:.6g} Hz", file,
                    *stated, stamps.rate_hz),
        "correct the stated rate, or leave it out");
  }
  timing.rate_hz = stated && !new_rate ? *stated : rounded_rate(stamps.rate_hz, stamps.rows);
  const std::size_t jitter_line = compare_with_grid(recording, timing);
  if (!bridging) {
    refuse_uneven(recording, timing, jitter_line);
    return timing;
  }
  if (new_rate) timing.rate_hz = *options.rate_hz;
  const double samples = std::floor((stamps.last - stamps.first) * timing.rate_hz + 1e-6) + 1.0;
  if (!(samples <= most_made_up * static_cast<double>(stamps.rows))) {
    throw InputError("time-gap",
                     fmt::format("`{}`: {} rows cannot be bridged to {:.6g} samples at {:.6g} Hz", file,
                                 stamps.rows, samples, timing.rate_hz),
                     "give a lower `rate_hz`, or cut the recording at its gaps");
  }
  timing.samples = static_cast<std::size_t>(samples);
  const bool gaps = timing.gaps > 0;
  if (gaps || timing.largest_jitter > jitter_tolerance) {
    warnings.push_back({Severity::warning, gaps ? "time-gap" : "time-jitter",
                        fmt::format("{} gap{} (longest {:.6g} s) and time stamps up to {:.3g} sample periods "
                                    "off were bridged by straight "
                                    "lines onto {:.6g} Hz",
                                    timing.gaps, timing.gaps == 1 ? "" : "s", timing.longest_gap_s,
                                    timing.largest_jitter, timing.rate_hz),
                        line_of(recording, gaps ? timing.first_gap_line : jitter_line),
                        "what lies in a gap was not measured"});
  }
  return timing;
}

void stream_columns(Recording& recording, const Timing& timing, TimingRule rule,
                    std::span<const std::size_t> columns, const BlockSink& sink) {
  const std::size_t width = recording.header().columns.size();
  std::vector<double> time(block_rows), values(block_rows * width);
  std::vector<std::vector<double>> block(columns.size());
  std::vector<double> before(width);
  double time_before = 0.0;
  std::size_t done = 0;  // samples handed on
  std::size_t rows_read = 0;
  const bool even = rule == TimingRule::strict || !recording.header().has_time;
  recording.rewind();
  for (std::size_t n = 0; (n = recording.read_rows(time, values)) > 0; rows_read += n) {
    for (std::vector<double>& column : block) column.clear();
    for (std::size_t r = 0; r < n; ++r) {
      const double* row = values.data() + r * width;
      if (even) {
        for (std::size_t c = 0; c < columns.size(); ++c) block[c].push_back(row[columns[c]]);
        continue;
      }
      // Every grid time up to this row lies between the row before and this one.
      const double reach = 1e-6 / timing.rate_hz;
      for (std::size_t at = done + (block.empty() ? 0 : block[0].size()); at < timing.samples; ++at) {
        const double wanted = timing.start_time_s + static_cast<double>(at) / timing.rate_hz;
        if (wanted > time[r] + reach) break;
        const bool first = rows_read + r == 0;
        const double weight =
            first ? 1.0 : std::clamp((wanted - time_before) / (time[r] - time_before), 0.0, 1.0);
        for (std::size_t c = 0; c < columns.size(); ++c) {
          const double y0 = first ? row[columns[c]] : before[columns[c]];
          block[c].push_back(y0 + weight * (row[columns[c]] - y0));
        }
        if (block.empty()) break;
      }
      time_before = time[r];
      std::copy_n(row, width, before.begin());
    }
    const std::size_t got = block.empty() ? 0 : block[0].size();
    if (got > 0) sink(done, block);
    done += got;
  }
  recording.rewind();
}

std::vector<data::Signal> read_all(Recording& recording, const TimingOptions& options) {
  std::vector<Diagnostic> ignored;
  const Timing timing = check_timing(recording, options, ignored);
  const RecordingHeader& header = recording.header();
  std::vector<data::Signal> signals(header.columns.size());
  std::vector<std::size_t> columns(signals.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c] = c;
    signals[c].info.name = header.columns[c].name;
    signals[c].info.unit = header.columns[c].unit;
    signals[c].info.rate_hz = timing.rate_hz;
    signals[c].info.start_time_s = timing.start_time_s;
    signals[c].info.count = timing.samples;
  }
  stream_columns(recording, timing, options.rule, columns,
                 [&](std::size_t, std::span<const std::vector<double>> block) {
                   for (std::size_t c = 0; c < signals.size(); ++c)
                     signals[c].samples.insert(signals[c].samples.end(), block[c].begin(), block[c].end());
                 });
  return signals;
}

}  // namespace brachium::io
