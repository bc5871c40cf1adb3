#include "data/io/noraxon.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "data/io/csv.hpp"
#include "data/io/text_lines.hpp"
#include "data/model/units.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using data::SourceSpan;

const std::vector<std::string> metadata_keys{"type",      "name",  "time_units", "begin_time",
                                             "frequency", "count", "units"};

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line, const std::string& message) {
  throw InputError(
      Diagnostic{Severity::error, "not-noraxon",
                 fmt::format("`{}` is not a Noraxon signal export: {}", file.filename().string(), message),
                 SourceSpan{file.string(), static_cast<int>(line), 0, 1, {}},
                 "export single signals as CSV, or describe the file with `format = \"csv\"`"});
}

double number(const std::filesystem::path& file, const std::string& key, const std::string& text) {
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
    fail(file, 2, fmt::format("`{}` is `{}`, not a number", key, text));
  }
  return value;
}

}  // namespace

Recording open_noraxon(const std::filesystem::path& file) {
  TextLines lines(file);
  std::array<std::string, 4> head;
  std::uintmax_t first_byte = 0;
  for (std::string& text : head) {
    std::string_view line;
    if (lines.next(line)) text = line;
    first_byte = lines.next_byte();
  }
  if (split_fields(head[0], ",") != metadata_keys)
    fail(file, 1, "the first row must be `type,name,time_units,begin_time,frequency,count,units`");
  const std::vector<std::string> values = split_fields(head[1], ",");
  if (values.size() != metadata_keys.size())
    fail(file, 2, fmt::format("the second row has {} fields, not 7", values.size()));
  if (!head[2].empty()) fail(file, 3, "the third row must be blank");
  const std::vector<std::string> columns = split_fields(head[3], ",");
  const std::string& type = values[0];
  std::vector<std::string> wanted;
  if (type == "signal") {
    wanted = {"time", "value"};
  } else if (type == "signal_3d") {
    wanted = {"time", "x", "y", "z"};
  } else if (type == "signal_4d") {
    wanted = {"time", "x", "y", "z", "w"};
  } else {
    throw InputError(Diagnostic{
        Severity::error, "unknown-type",
        fmt::format("`{}` is not a type of Noraxon signal that can be read", type),
        SourceSpan{file.string(), 2, 1, static_cast<int>(std::max<std::size_t>(1, type.size())), head[1]},
        "known: signal, signal_3d, signal_4d"});
  }
  if (columns != wanted)
    fail(file, 4, fmt::format("the columns of a `{}` must be `{}`", type, fmt::join(wanted, ",")));

  RecordingHeader header;
  header.name = values[1];
  header.time_unit = values[2];
  const double to_s = data::convert(1.0, header.time_unit, "s");
  header.start_time_s = number(file, "begin_time", values[3]) * to_s;
  header.rate_hz = number(file, "frequency", values[4]);
  const double count = number(file, "count", values[5]);
  if (!(*header.rate_hz > 0.0)) fail(file, 2, fmt::format("`frequency` is {}", values[4]));
  if (!(count >= 0.0 && count <= 1e12 && count == std::floor(count)))
    fail(file, 2, fmt::format("`count` is {}", values[5]));
  header.rows = static_cast<std::size_t>(count);
  header.has_time = true;
  RowFormat format;
  format.time_field = 0;
  format.time_to_s = to_s;
  format.fields = wanted.size();
  format.first_line = 5;
  format.first_byte = first_byte;
  for (std::size_t i = 1; i < wanted.size(); ++i) {
    header.columns.push_back({wanted[i], values[6].empty() ? "1" : values[6]});
    format.value_fields.push_back(i);
  }
  return Recording(file, std::move(header), std::move(format));
}

}  // namespace brachium::io
