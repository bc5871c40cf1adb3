#include <algorithm>
#include <cctype>
#include <cmath>

#include "data/model/units.hpp"
#include "pipelines/report/build.hpp"
#include "pipelines/report/text.hpp"

namespace brachium::pipelines::report {
namespace {

template <typename Map>
const typename Map::mapped_type* find(const Map& map, const std::string& key) {
  const auto entry = map.find(key);
  return entry == map.end() ? nullptr : &entry->second;
}

/// Counts and indices are shown without decimals.
bool all_integers(const std::vector<double>& values) {
  bool any = false;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    if (!(std::abs(v) < 1e9) || v != std::round(v)) return false;
    any = true;
  }
  return any;
}

std::vector<Cell> number_cells(const data::Column& column, const GridOptions& options) {
  std::vector<double> values = std::get<std::vector<double>>(column.values);
  const auto* rule = find(options.number_tone, column.name);
  std::vector<Tone> tones;
  for (const double v : values)
    tones.push_back(rule ? (*rule)(v) : Tone::plain);  // rules speak of stored units
  if (const auto* unit = find(options.units, column.name)) {
    for (double& v : values) v = data::convert(v, column.unit, *unit);
  }
  const int* own = find(options.column_digits, column.name);
  const bool whole = !own && all_integers(values);
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const int* decimals = find(options.decimals, column.name);
    const std::string text = std::isnan(values[i]) ? options.undefined
                             : decimals            ? fixed(values[i], *decimals)
                             : whole               ? fixed(values[i], 0)
                                                   : significant(values[i], own ? *own : options.digits);
    cells.push_back({.text = text, .tone = tones[i], .numeric = true});
  }
  return cells;
}

std::vector<Cell> text_cells(const data::Column& column, const GridOptions& options) {
  const auto* rule = find(options.text_tone, column.name);
  std::vector<Cell> cells;
  for (const std::string& text : std::get<std::vector<std::string>>(column.values)) {
    const std::string shown = options.words.contains(column.name) ? in_words(text) : text;
    cells.push_back(make_text_cell(shown, rule               ? (*rule)(text)
                                          : options.verdicts ? verdict_tone(text)
                                                             : Tone::plain));
  }
  return cells;
}

std::string heading(const data::Column& column, const GridOptions& options) {
  const std::string* name = find(options.names, column.name);
  const std::string* unit = find(options.units, column.name);
  const std::string& symbol = unit ? *unit : column.unit;
  if (!name) {
    // The name's own ending says the stored unit; a table of mixed units says none.
    const std::string plain = label_of_name(column.name, column.unit == "mixed" ? "1" : column.unit);
    return unit ? plain.substr(0, plain.rfind(" [")) + " [" + *unit + "]" : plain;
  }
  return symbol.empty() || symbol == "1" || symbol == "mixed" ? *name : *name + " [" + symbol + "]";
}

}  // namespace

Grid make_grid(const data::Table& table, const GridOptions& options) {
  std::vector<const data::Column*> columns;
  if (options.columns.empty()) {
    for (const data::Column& column : table.columns) columns.push_back(&column);
  } else {
    for (const std::string& name : options.columns) columns.push_back(&table.column(name));
  }
  Grid grid{.caption = table.title};
  if (!grid.caption.empty())
    grid.caption[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(grid.caption[0])));
  grid.rows.resize(columns.empty() ? 0 : table.rows());
  for (const data::Column* column : columns) {
    grid.header.push_back(heading(*column, options));
    const bool numbers = std::holds_alternative<std::vector<double>>(column->values);
    const std::vector<Cell> cells = numbers ? number_cells(*column, options) : text_cells(*column, options);
    for (std::size_t i = 0; i < grid.rows.size(); ++i) grid.rows[i].push_back(cells.at(i));
  }
  return grid;
}

}  // namespace brachium::pipelines::report
