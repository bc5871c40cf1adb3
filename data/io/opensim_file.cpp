#include "data/io/opensim_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <set>

#include "data/io/atomic_file.hpp"
#include "data/io/csv.hpp"
#include "data/io/text_lines.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using data::SourceSpan;

constexpr std::size_t longest_header = 10'000;  // lines; beyond, the file is no storage file

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

std::string trimmed(const std::string& s, const char* blanks = " \t") {
  const auto first = s.find_first_not_of(blanks);
  if (first == std::string::npos) return {};
  return s.substr(first, s.find_last_not_of(blanks) - first + 1);
}

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& code, std::size_t line,
                       const std::string& message, const std::string& help = {}) {
  throw InputError(Diagnostic{Severity::error, code, message,
                              SourceSpan{file.string(), static_cast<int>(line), 0, 1, {}}, help});
}

/// The header's lines up to `endheader`, as fields; `range` and further text are kept out.
struct HeaderText {
  StorageHeader header;
  std::optional<std::size_t> rows, columns;
  std::string title, labels;
  std::size_t label_line = 0;
  std::uintmax_t first_byte = 0;
};

std::optional<std::size_t> count_of(const std::string& text) {
  std::size_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  return status == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

HeaderText read_header(const std::filesystem::path& file) {
  TextLines lines(file);
  HeaderText out;
  std::string_view view;
  bool ended = false;
  while (!ended && lines.line() < longest_header && lines.next(view)) {
    // Spreadsheets pad header lines with delimiters.
    const std::string line = trimmed(std::string(view), " \t,;");
    if (lower(line) == "endheader") {
      ended = true;
      break;
    }
    if (lines.line() == 1) out.title = line;
    std::string key, value;
    const std::size_t blank = line.find_first_of(" \t"), equals = line.find('=');
    const std::string word = lower(line.substr(0, blank));
    if (word == "datacolumns" || word == "datarows" || word == "range") {  // SIMM: key value
      key = word == "datacolumns" ? "ncolumns" : word == "datarows" ? "nrows" : word;
      value = blank == std::string::npos ? "" : trimmed(line.substr(blank));
    } else if (equals != std::string::npos && equals > 0) {
      key = trimmed(line.substr(0, equals));
      value = trimmed(line.substr(equals + 1));
      if (key.find_first_of(" \t") != std::string::npos) continue;  // a sentence with an equals sign
    } else {
      continue;  // free text
    }
    out.header.fields[key] = value;
    const std::string name = lower(key);
    if (name == "nrows") out.rows = count_of(value);
    if (name == "ncolumns") out.columns = count_of(value);
    if ((name == "nrows" || name == "ncolumns") && !count_of(value)) {
      fail(file, "not-a-storage-file", lines.line(),
           fmt::format("`{}` of the header is `{}`, not a count", key, value));
    }
    if (name == "version") {
      const auto version = count_of(value);
      if (!version || *version > 3)
        fail(file, "unsupported-version", lines.line(),
             fmt::format("storage version `{}` is not known", value), "known: 1, 2, 3");
      out.header.version = static_cast<int>(*version);
    }
    if (name == "indegrees") {
      const std::string answer = lower(value);
      if (answer != "yes" && answer != "no")
        fail(file, "not-a-storage-file", lines.line(), fmt::format("`inDegrees` is `{}`", value),
             "yes or no");
      out.header.in_degrees = answer == "yes";
    }
    if (name == "datatype" && lower(value) != "double") {
      fail(file, "unsupported-data-type", lines.line(),
           fmt::format("columns of type `{}` cannot be read", value),
           "only DataType=double is a table of numbers");
    }
  }
  if (!ended) {
    throw InputError(
        "not-a-storage-file",
        fmt::format("`{}` is not an OpenSim storage file: there is no line `endheader`", file.string()),
        "describe the file with `format = \"csv\"`");
  }
  while (lines.next(view)) {
    if (trimmed(std::string(view), " \t,;").empty()) continue;
    out.labels = view;
    out.label_line = lines.line();
    break;
  }
  if (out.labels.empty())
    fail(file, "not-a-storage-file", lines.line(), "there are no column labels after `endheader`");
  out.first_byte = lines.next_byte();
  return out;
}

bool ends_with_any(const std::string& name, std::initializer_list<const char*> endings) {
  return std::any_of(endings.begin(), endings.end(),
                     [&](const char* ending) { return name.ends_with(ending); });
}

}  // namespace

bool is_rotational_column(const std::string& name) {
  // OpenSim 4 state names: /jointset/knee_r/knee_angle_r/value; the coordinate is the last but one part.
  std::string coordinate = name;
  const bool state = name.starts_with("/");
  if (state) {
    if (!ends_with_any(name, {"/value", "/speed"}) || !name.starts_with("/jointset/")) return false;
    coordinate = name.substr(0, name.rfind('/'));
  }
  if (ends_with_any(coordinate, {"_u"})) coordinate.resize(coordinate.size() - 2);  // speeds of OpenSim 3
  if (coordinate.find('.') != std::string::npos) return false;  // muscle states, body positions
  return !ends_with_any(coordinate, {"_tx", "_ty", "_tz", "_force", "_moment", "_X", "_Y", "_Z", "_vx", "_vy",
                                     "_vz", "_px", "_py", "_pz"});
}

Recording open_storage(const std::filesystem::path& file, StorageHeader* header_out) {
  const HeaderText text = read_header(file);
  RecordingHeader header;
  header.name = text.title;
  header.rows = text.rows;
  header.has_time = true;
  RowFormat format;
  // Tabs by the format's rule; blanks and commas are met in the wild.
  format.delimiter = text.labels.find('\t') != std::string::npos  ? '\t'
                     : text.labels.find(',') != std::string::npos ? ','
                                                                  : ' ';
  const std::string delimiter = format.delimiter == ' ' ? "whitespace" : std::string(1, format.delimiter);
  std::vector<std::string> labels = split_fields(text.labels, delimiter);
  while (!labels.empty() && labels.back().empty()) labels.pop_back();
  if (labels.empty() || lower(labels.front()) != "time") {
    fail(file, "not-a-storage-file", text.label_line, "the first column must be `time`");
  }
  if (text.columns && *text.columns != labels.size()) {
    // Programs that drop columns forget to count again. Nothing is lost: every row is held against the
    // labels.
    header.notes.push_back(
        {Severity::warning,
         "column-count-mismatch",
         fmt::format("the header states {} columns, but {} are labelled", *text.columns, labels.size()),
         SourceSpan{file.string(), static_cast<int>(text.label_line), 0, 1, {}},
         {}});
  }
  std::set<std::string> seen;
  for (std::size_t field = 1; field < labels.size(); ++field) {
    if (!seen.insert(labels[field]).second || labels[field].empty()) {
      fail(file, "duplicate-column", text.label_line,
           fmt::format("there are two columns `{}`", labels[field]));
    }
    header.columns.push_back(
        {labels[field], text.header.in_degrees && is_rotational_column(labels[field]) ? "deg" : ""});
    format.value_fields.push_back(field);
  }
  format.time_field = 0;
  format.fields = labels.size();
  format.trailing_empty = true;
  format.quotes = false;
  format.first_line = text.label_line + 1;
  format.first_byte = text.first_byte;
  if (header_out) *header_out = text.header;
  return Recording(file, std::move(header), std::move(format));
}

void write_storage(std::span<const data::Signal> signals, const std::string& title,
                   const std::filesystem::path& file, bool in_degrees) {
  if (signals.empty())
    throw InputError("no-signals", fmt::format("there is no signal to write to `{}`", file.string()));
  const data::SignalInfo& first = signals.front().info;
  for (const data::Signal& s : signals) {
    if (s.info.rate_hz != first.rate_hz || s.info.start_time_s != first.start_time_s ||
        s.samples.size() != signals.front().samples.size()) {
      throw InputError(
          "unequal-time-stamps",
          fmt::format("signals `{}` and `{}` do not share their time stamps", first.name, s.info.name),
          "align them before writing");
    }
    if (s.info.name.find_first_of("\t\n\r") != std::string::npos || s.info.name.empty()) {
      throw InputError("bad-name", fmt::format("`{}` cannot be a column of a storage file", s.info.name));
    }
  }
  const std::size_t rows = signals.front().samples.size();
  std::string flat_title = title;
  std::replace(flat_title.begin(), flat_title.end(), '\n', ' ');
  std::string text = fmt::format("{}\nversion=1\nnRows={}\nnColumns={}\ninDegrees={}\nendheader\ntime",
                                 flat_title, rows, signals.size() + 1, in_degrees ? "yes" : "no");
  for (const data::Signal& s : signals) text += "\t" + s.info.name;
  text += "\n";
  for (std::size_t i = 0; i < rows; ++i) {
    text += fmt::format("{}", first.time_s(i));
    for (const data::Signal& s : signals) {
      const bool turn = in_degrees && (s.info.unit == "rad" || s.info.unit == "rad/s");
      text += fmt::format("\t{}", turn ? s.samples[i] * (180.0 / std::numbers::pi) : s.samples[i]);
    }
    text += "\n";
  }
  write_text_atomically(file, text);
}

}  // namespace brachium::io
