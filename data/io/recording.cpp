#include "data/io/recording.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "data/io/text_lines.hpp"

namespace brachium::io {
namespace {

using data::Diagnostic;
using data::InputError;
using data::Severity;
using data::SourceSpan;

constexpr std::size_t longest_excerpt = 120;

std::string_view trim(std::string_view s) {
  while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
  while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
  return s;
}

bool is_space(char c) {
  return c == ' ' || c == '\t';
}

}  // namespace

std::size_t RecordingHeader::column_index(const std::string& column,
                                          const std::filesystem::path& file) const {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == column) return i;
    known.push_back(columns[i].name);
  }
  throw InputError("missing-column", fmt::format("`{}` has no column `{}`", file.string(), column),
                   data::suggest(column, known));
}

struct Recording::Impl {
  std::filesystem::path file;
  RecordingHeader header;
  RowFormat format;
  TextLines lines;
  std::vector<int> role;  // of each field: -1 ignored, 0 time, 1 + column
  std::vector<std::string_view> fields;
  std::string number;  // scratch for decimal commas

  Impl(std::filesystem::path path, RecordingHeader h, RowFormat f)
      : file(std::move(path)), header(std::move(h)), format(std::move(f)), lines(file) {
    std::size_t last = format.time_field.value_or(0);
    for (const std::size_t field : format.value_fields) last = std::max(last, field);
    role.assign(last + 1, -1);
    if (format.time_field) role[*format.time_field] = 0;
    for (std::size_t c = 0; c < format.value_fields.size(); ++c)
      role[format.value_fields[c]] = static_cast<int>(c) + 1;
    rewind();
  }

  void rewind() { lines.seek(format.first_byte, format.first_line - 1); }

  [[noreturn]] void fail(const std::string& code, const std::string& message, std::string_view line,
                         std::string_view field, const std::string& help) const {
    SourceSpan span{file.string(), static_cast<int>(lines.line()), 0, 1, {}};
    const std::size_t column = static_cast<std::size_t>(field.data() - line.data());
    span.column = static_cast<int>(column) + 1;
    span.length = static_cast<int>(std::max<std::size_t>(1, std::min<std::size_t>(field.size(), 40)));
    if (line.size() <= longest_excerpt) span.text = std::string(line);
    throw InputError(Diagnostic{Severity::error, code, message, span, help});
  }

  std::string column_name(int r) const {
    return r == 0 ? "the time column"
                  : fmt::format("column `{}`", header.columns[static_cast<std::size_t>(r - 1)].name);
  }

  // Splits a line; with quotes the outer quotes of a field go, inner ones are not numbers anyway.
  void split(std::string_view line) {
    fields.clear();
    if (format.delimiter == ' ') {
      std::size_t i = 0;
      while (true) {
        while (i < line.size() && is_space(line[i])) ++i;
        if (i == line.size()) return;
        const std::size_t start = i;
        while (i < line.size() && !is_space(line[i])) ++i;
        fields.push_back(line.substr(start, i - start));
      }
    }
    std::size_t start = 0;
    bool inside = false;
    for (std::size_t i = 0; i <= line.size(); ++i) {
      if (i < line.size() && format.quotes && line[i] == '"') inside = !inside;
      if (i < line.size() && (inside || line[i] != format.delimiter)) continue;
      std::string_view field = trim(line.substr(start, i - start));
      if (format.quotes && field.size() >= 2 && field.front() == '"' && field.back() == '"')
        field = trim(field.substr(1, field.size() - 2));
      fields.push_back(field);
      start = i + 1;
    }
  }

  double parse(std::string_view field, int r, std::string_view line) {
    std::string_view text = field;
    if (format.decimal_comma) {
      number.assign(field);
      std::replace(number.begin(), number.end(), ',', '.');
      text = number;
    }
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0.0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status == std::errc::result_out_of_range) {
      fail("not-a-number", fmt::format("`{}` in {} is beyond what a number can hold", field, column_name(r)),
           line, field, {});
    }
    if (status != std::errc() || end != text.data() + text.size()) {
      fail("not-a-number", fmt::format("`{}` in {} is not a number", field, column_name(r)), line, field,
           field.find(',') != std::string_view::npos && !format.decimal_comma
               ? "if the file writes 3,14, say `decimal_comma = true`"
               : "");
    }
    if (!std::isfinite(value)) {
      fail("non-finite-sample", fmt::format("{} has `{}`", column_name(r), field), line, field,
           "mend or cut the recording; Brachium does not replace samples");
    }
    return value;
  }

  bool next_row_line(std::string_view& line) {
    while (lines.next(line)) {
      if (trim(line).empty()) continue;
      if (!format.comment.empty() && line.starts_with(format.comment)) continue;
      return true;
    }
    return false;
  }

  bool read_time(double& time) {
    std::string_view line;
    if (!next_row_line(line)) return false;
    time = 0.0;
    if (!format.time_field) return true;
    const std::size_t field = *format.time_field;
    if (field == 0 && format.delimiter != ' ') {
      fields.assign(1, trim(line.substr(0, line.find(format.delimiter))));
      if (format.quotes && fields[0].starts_with('"')) split(line);
    } else {
      split(line);
    }
    if (fields.size() <= field || fields[field].empty()) {
      fail("missing-field", "the time column is empty", line, line.substr(line.size()),
           "the file may be cut off; export the recording again");
    }
    time = parse(fields[field], 0, line) * format.time_to_s;
    return true;
  }

  bool read_row(double& time, double* values) {
    std::string_view line;
    if (!next_row_line(line)) return false;
    split(line);
    if (format.trailing_empty) {
      while (fields.size() > role.size() && fields.back().empty()) fields.pop_back();
    }
    if (fields.size() < role.size() || (format.fields > 0 && fields.size() < format.fields)) {
      const std::size_t needed = std::max(role.size(), format.fields);
      fail("missing-field",
           fmt::format("a row of `{}` has {} fields, {} are needed", file.filename().string(), fields.size(),
                       needed),
           line, line.substr(line.size()), "the file may be cut off; export the recording again");
    }
    if (format.fields > 0 && fields.size() > format.fields) {
      fail("extra-field",
           fmt::format("a row of `{}` has {} fields, not {}", file.filename().string(), fields.size(),
                       format.fields),
           line, fields[format.fields], "check the delimiter and the header");
    }
    time = 0.0;
    for (std::size_t f = 0; f < role.size(); ++f) {
      const int r = role[f];
      if (r < 0) continue;
      if (fields[f].empty()) {
        fail("missing-field", fmt::format("{} is empty", column_name(r)), line, fields[f],
             "mend or cut the recording; Brachium does not replace samples");
      }
      const double value = parse(fields[f], r, line);
      if (r == 0) {
        time = value * format.time_to_s;
      } else {
        values[r - 1] = value;
      }
    }
    return true;
  }
};

Recording::Recording(std::filesystem::path file, RecordingHeader header, RowFormat format)
    : impl_(std::make_unique<Impl>(std::move(file), std::move(header), std::move(format))) {}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

const std::filesystem::path& Recording::file() const {
  return impl_->file;
}
const RecordingHeader& Recording::header() const {
  return impl_->header;
}

std::size_t Recording::read_rows(std::span<double> time, std::span<double> values) {
  const std::size_t columns = impl_->header.columns.size();
  if (values.size() < time.size() * columns)
    throw std::logic_error("Recording::read_rows: room for fewer values than rows");
  std::size_t rows = 0;
  while (rows < time.size() && impl_->read_row(time[rows], values.data() + rows * columns)) ++rows;
  return rows;
}

std::size_t Recording::read_times(std::span<double> time) {
  std::size_t rows = 0;
  while (rows < time.size() && impl_->read_time(time[rows])) ++rows;
  return rows;
}

void Recording::rewind() {
  impl_->rewind();
}
std::size_t Recording::line() const {
  return impl_->lines.line();
}
double Recording::bytes_read_fraction() const {
  return impl_->lines.fraction();
}

}  // namespace brachium::io
