#include "pipelines/expectation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pipelines/options.hpp"

namespace brachium::pipelines {
namespace {

using data::Severity;
using io::TomlNode;

bool row_matches(const data::Table& table, std::size_t row, const std::map<std::string, std::string>& where) {
  for (const auto& [column, wanted] : where) {
    const data::Column& c = table.column(column);
    if (const auto* texts = std::get_if<std::vector<std::string>>(&c.values)) {
      if ((*texts)[row] != wanted) return false;
    } else {
      const double value = std::get<std::vector<double>>(c.values)[row];
      if (fmt::format("{}", value) != wanted && fmt::format("{:g}", value) != wanted) return false;
    }
  }
  return true;
}

std::vector<double> find_numbers(const Expectation& e, const StageData& output) {
  const auto found = output.tables.find(e.table);
  if (found == output.tables.end()) {
    std::vector<std::string> known;
    for (const auto& [name, table] : output.tables) known.push_back(name);
    throw data::InputError("missing-table", fmt::format("stage `{}` has no table `{}`", e.stage, e.table),
                           data::suggest(e.table, known));
  }
  const data::Table& table = found->second;
  const std::vector<double>& numbers = table.numbers(e.column);
  std::vector<double> selected;
  for (std::size_t r = 0; r < table.rows(); ++r) {
    if ((!e.row || *e.row == r) && row_matches(table, r, e.where)) selected.push_back(numbers[r]);
  }
  if (e.every && selected.empty())
    throw data::InputError("ambiguous-row", fmt::format("no row of `{}` is selected", e.table));
  if (!e.every && selected.size() != 1) {
    throw data::InputError(
        "ambiguous-row", fmt::format("{} rows of `{}` are selected instead of one", selected.size(), e.table),
        "add to `where`, or ask of all of them: every = true");
  }
  return selected;
}

bool is_met(const Expectation& e, double found) {
  return std::isfinite(found) && (!e.value || std::abs(found - *e.value) <= e.tolerance) &&
         (!e.minimum || found >= *e.minimum) && (!e.maximum || found <= *e.maximum);
}

std::string number_text(double value) {
  return fmt::format("{:.6g}", value);
}

}  // namespace

std::vector<Expectation> parse_expectations(io::TomlTable& root, std::vector<data::Diagnostic>& diagnostics) {
  std::vector<Expectation> expectations;
  if (!root.has("expect")) return expectations;
  for (io::TomlTable entry : root.tables("expect")) {
    const std::size_t before = diagnostics.size();
    Expectation e;
    e.place = entry.node().where;
    e.stage = entry.require_text("stage");
    e.table = entry.require_text("table");
    e.column = entry.require_text("column");
    e.name = entry.text("name").value_or(std::to_string(expectations.size() + 1));
    if (auto where = entry.table("where")) {
      for (const auto& [column, wanted] : where->node().members) {
        const bool numeric = wanted.kind == TomlNode::Kind::number || wanted.kind == TomlNode::Kind::integer;
        if (!numeric && wanted.kind != TomlNode::Kind::text) {
          diagnostics.push_back({Severity::error,
                                 "wrong-type",
                                 fmt::format("`{}` in `where` must be a text or a number", column),
                                 wanted.where,
                                 {}});
        }
        e.where[column] = numeric ? fmt::format("{}", wanted.number) : wanted.text;
      }
    }
    if (const auto row = entry.integer("row")) {
      if (*row < 0) entry.error("out-of-range", "`row` counts from 0", "row");
      e.row = static_cast<std::size_t>(std::max<std::int64_t>(*row, 0));
    }
    e.every = entry.boolean("every").value_or(false);
    e.value = entry.number("value");
    const auto tolerance = entry.number("tolerance");
    e.minimum = entry.number("min");
    e.maximum = entry.number("max");
    if (tolerance && !(*tolerance >= 0.0))
      entry.error("out-of-range", "`tolerance` must be 0 or greater", "tolerance");
    if (e.value && !tolerance) entry.error("missing-key", "an expected `value` needs a `tolerance`");
    if (!e.value && tolerance) entry.error("missing-key", "a `tolerance` needs the expected `value`");
    e.tolerance = tolerance.value_or(0.0);
    if (!e.value && !e.minimum && !e.maximum && diagnostics.size() == before) {
      entry.error("missing-key", "an expectation needs `value` with `tolerance`, `min` or `max`");
    }
    entry.finish();
    expectations.push_back(std::move(e));
  }
  return expectations;
}

ExpectationResult check_expectation(const Expectation& e, const StageData* output) {
  ExpectationResult result;
  result.expectation = &e;
  if (!output) {
    result.remark = fmt::format("stage `{}` is not part of this run", e.stage);
    return result;
  }
  result.checked = true;
  try {
    const std::vector<double> found = find_numbers(e, *output);
    const auto failed = std::ranges::find_if_not(found, [&](double number) { return is_met(e, number); });
    result.passed = failed == found.end();
    result.found = result.passed ? found.front() : *failed;
  } catch (const data::InputError& error) {
    result.remark = error.what();
  }
  return result;
}

std::string wanted_text(const Expectation& e) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (e.value) add(fmt::format("{} +- {}", number_text(*e.value), number_text(e.tolerance)));
  if (e.minimum) add("at least " + number_text(*e.minimum));
  if (e.maximum) add("at most " + number_text(*e.maximum));
  return text;
}

std::string place_text(const Expectation& e) {
  std::string rows;
  for (const auto& [column, wanted] : e.where) rows += (rows.empty() ? "" : ",") + column + "=" + wanted;
  if (e.row) rows += (rows.empty() ? "" : ",") + fmt::format("row {}", *e.row);
  if (e.every) rows += (rows.empty() ? "every row" : ", every row");
  return fmt::format("{}/{}{}.{}", e.stage, e.table, rows.empty() ? "" : "[" + rows + "]", e.column);
}

std::string expectation_table(std::span<const ExpectationResult> results) {
  std::vector<std::array<std::string, 4>> rows{{"expected number", "wanted", "found", ""}};
  for (const ExpectationResult& r : results) {
    rows.push_back({place_text(*r.expectation), wanted_text(*r.expectation),
                    r.found ? number_text(*r.found) : "-",
                    !r.checked         ? "not checked: " + r.remark
                    : r.passed         ? "ok"
                    : r.remark.empty() ? "FAILED"
                                       : "FAILED: " + r.remark});
  }
  std::array<std::size_t, 4> width{};
  for (const auto& row : rows) {
    for (std::size_t c = 0; c < 4; ++c) width[c] = std::max(width[c], row[c].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line = fmt::format("  {:<{}}  {:<{}}  {:<{}}  {}", row[0], width[0], row[1], width[1], row[2],
                                   width[2], row[3]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace brachium::pipelines
