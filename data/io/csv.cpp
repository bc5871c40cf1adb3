#include "data/io/csv.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "data/io/text_lines.hpp"
#include "data/model/units.hpp"

namespace brachium::io {
namespace {

using data::InputError;

std::string trimmed(std::string_view s) {
  const auto first = s.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return std::string(s.substr(first, s.find_last_not_of(" \t") - first + 1));
}

char delimiter_of(const std::string& name) {
  if (name == "whitespace") return ' ';
  if (name == "tab") return '\t';
  if (name.size() == 1 && name != "\"" && name != " ") return name[0];
  throw InputError("bad-layout", fmt::format("`{}` cannot be a delimiter", name),
                   "one character, \"tab\" or \"whitespace\"");
}

/// "emg1 (uV)" or "emg1 [uV]" as spreadsheets write it: name and unit, where what stands in brackets is a
/// unit.
void split_unit(RecordingColumn& column) {
  const std::string& name = column.name;
  if (!column.unit.empty() || name.empty() || (name.back() != ')' && name.back() != ']')) return;
  const std::size_t open = name.rfind(name.back() == ')' ? '(' : '[');
  if (open == std::string::npos || open == 0) return;
  const std::string unit = trimmed(std::string_view(name).substr(open + 1, name.size() - open - 2));
  try {
    if (unit.empty()) return;
    data::parse_unit(unit);
  } catch (const InputError&) {
    return;  // a remark, not a unit
  }
  column.unit = unit;
  column.name = trimmed(std::string_view(name).substr(0, open));
}

struct HeaderRows {
  std::vector<std::string> names, units, first_data;
  std::size_t first_line = 1;  // of the data
  std::uintmax_t first_byte = 0;
};

HeaderRows read_header(const std::filesystem::path& file, const CsvLayout& layout,
                       std::size_t first_data_row) {
  TextLines lines(file);
  HeaderRows rows;
  std::string_view line;
  std::size_t row = 0;
  for (std::uintmax_t start = lines.next_byte(); lines.next(line); start = lines.next_byte()) {
    if (!layout.comment.empty() && line.starts_with(layout.comment)) continue;
    ++row;
    if (row == layout.header_row) rows.names = split_fields(std::string(line), layout.delimiter);
    if (row == layout.units_row) rows.units = split_fields(std::string(line), layout.delimiter);
    if (row < first_data_row || trimmed(line).empty()) continue;
    rows.first_data = split_fields(std::string(line), layout.delimiter);
    rows.first_line = lines.line();
    rows.first_byte = start;
    return rows;
  }
  if (layout.header_row && row < *layout.header_row) {
    throw InputError("bad-layout", fmt::format("`{}` has {} rows, but its header should stand in row {}",
                                               file.string(), row, *layout.header_row));
  }
  throw InputError("empty-recording", fmt::format("`{}` has a header but no samples", file.string()),
                   "export the recording again");
}

}  // namespace

std::vector<std::string> split_fields(const std::string& line, const std::string& delimiter) {
  const char mark = delimiter_of(delimiter);
  std::vector<std::string> fields;
  std::string field;
  bool inside = false, was_quoted = false, between = true;
  const auto take = [&] {
    fields.push_back(was_quoted ? field : trimmed(field));
    field.clear();
    was_quoted = false;
  };
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && inside && i + 1 < line.size() && line[i + 1] == '"') {
      field += '"';
      ++i;
    } else if (c == '"' && (inside || trimmed(field).empty())) {
      inside = !inside;
      if (inside) field.clear();
      was_quoted = true;
      between = false;
    } else if (inside) {
      field += c;
    } else if (mark == ' ' && (c == ' ' || c == '\t')) {
      if (!between) take();
      between = true;
    } else if (mark != ' ' && c == mark) {
      take();
    } else if (!was_quoted || (c != ' ' && c != '\t')) {
      field += c;
      between = false;
    }
  }
  if (mark != ' ' || !between) take();
  return fields;
}

Recording open_csv(const std::filesystem::path& file, const CsvLayout& layout) {
  RowFormat format;
  format.delimiter = delimiter_of(layout.delimiter);
  format.decimal_comma = layout.decimal_comma;
  format.comment = layout.comment;
  if (layout.decimal_comma && format.delimiter == ',') {
    throw InputError("bad-layout", "`decimal_comma` needs a delimiter other than `,`",
                     "say `delimiter = \";\"` or \"tab\"");
  }
  std::size_t first_data_row = layout.skip_rows + 1;
  CsvLayout placed = layout;
  for (auto* row : {&placed.header_row, &placed.units_row}) {
    if (!*row) continue;
    **row += layout.skip_rows;
    first_data_row = std::max(first_data_row, **row + 1);
  }
  if (layout.first_data_row) first_data_row = layout.skip_rows + *layout.first_data_row;
  const HeaderRows rows = read_header(file, placed, first_data_row);

  RecordingHeader header;
  std::vector<std::string> names = rows.names;
  if (!layout.header_row) {
    for (std::size_t i = 0; i < rows.first_data.size(); ++i) names.push_back(std::to_string(i + 1));
  }
  while (!names.empty() && names.back().empty()) names.pop_back();
  std::map<std::string, std::size_t> seen;
  header.time_unit = layout.time_unit;
  for (std::size_t field = 0; field < names.size(); ++field) {
    RecordingColumn column{names[field], field < rows.units.size() ? rows.units[field] : ""};
    split_unit(column);
    const bool is_time = !layout.time_column.empty() &&
                         (column.name == layout.time_column || names[field] == layout.time_column);
    if (column.name.empty()) continue;  // a column without a name cannot be asked for
    if (!seen.emplace(column.name, field).second) {
      throw InputError("duplicate-column",
                       fmt::format("`{}` has two columns `{}`", file.string(), column.name),
                       "give the columns names of their own, or say `header_row = 0` and use their numbers");
    }
    if (is_time) {
      format.time_field = field;
      header.has_time = true;
      if (!column.unit.empty()) header.time_unit = column.unit;
      continue;
    }
    header.columns.push_back(std::move(column));
    format.value_fields.push_back(field);
  }
  if (!layout.time_column.empty() && !header.has_time) {
    throw InputError("missing-column",
                     fmt::format("`{}` has no time column `{}`", file.string(), layout.time_column),
                     data::suggest(layout.time_column, names));
  }
  format.time_to_s = data::convert(1.0, header.time_unit, "s");
  if (!header.has_time) {
    header.rate_hz = layout.rate_hz;
    header.start_time_s = layout.start_time_s;
  }
  format.first_line = rows.first_line;
  format.first_byte = rows.first_byte;
  format.trailing_empty = true;
  return Recording(file, std::move(header), std::move(format));
}

}  // namespace brachium::io
