#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "data/io/stage_file.hpp"
#include "pipelines/fingerprint.hpp"
#include "pipelines/inspect.hpp"
#include "pipelines/run_records.hpp"

namespace brachium::pipelines {
namespace {

using Numbers = std::vector<double>;
using Texts = std::vector<std::string>;

std::string column_difference(const data::Column& a, const data::Column& b) {
  if (a.values.index() != b.values.index()) return "has another type";
  if (const auto* texts = std::get_if<Texts>(&a.values)) {
    const auto& others = std::get<Texts>(b.values);
    for (std::size_t r = 0; r < texts->size(); ++r) {
      if ((*texts)[r] != others[r])
        return fmt::format("row {}: \"{}\" and \"{}\"", r + 1, (*texts)[r], others[r]);
    }
    return {};
  }
  const auto &x = std::get<Numbers>(a.values), &y = std::get<Numbers>(b.values);
  double largest = 0.0;
  std::size_t at = 0, count = 0;
  for (std::size_t r = 0; r < x.size(); ++r) {
    if (x[r] == y[r] || (std::isnan(x[r]) && std::isnan(y[r]))) continue;
    ++count;
    const double difference = std::abs(x[r] - y[r]);
    if (count == 1 || difference > largest || std::isnan(difference)) {
      largest = difference;
      at = r;
    }
  }
  if (count == 0) return {};
  return fmt::format("{} of {} rows differ, most in row {}: {:.6g} and {:.6g}", count, x.size(), at + 1,
                     x[at], y[at]);
}

std::string table_difference(const std::string& place, const data::Table& a, const data::Table& b) {
  if (a.rows() != b.rows()) return fmt::format("  {}: {} rows and {} rows\n", place, a.rows(), b.rows());
  std::string out;
  for (const data::Column& column : a.columns) {
    const auto other = std::find_if(b.columns.begin(), b.columns.end(),
                                    [&](const data::Column& c) { return c.name == column.name; });
    if (other == b.columns.end()) {
      out += fmt::format("  {}.{}: only in the first run\n", place, column.name);
    } else if (const std::string difference = column_difference(column, *other); !difference.empty()) {
      out += fmt::format("  {}.{}: {}\n", place, column.name, difference);
    }
  }
  for (const data::Column& column : b.columns) {
    if (std::none_of(a.columns.begin(), a.columns.end(),
                     [&](const data::Column& c) { return c.name == column.name; })) {
      out += fmt::format("  {}.{}: only in the second run\n", place, column.name);
    }
  }
  return out;
}

std::string stage_difference(const StageRecord& a, const StageRecord& b) {
  std::error_code ignored;
  const bool has_a = std::filesystem::exists(a.output, ignored),
             has_b = std::filesystem::exists(b.output, ignored);
  if (!has_a && !has_b) return {};
  if (has_a != has_b) return fmt::format("  has an output only in the {} run\n", has_a ? "first" : "second");
  const io::StageFileContent x = io::read_stage_content(a.output), y = io::read_stage_content(b.output);
  std::string out;
  if (const std::string parts = difference_text(x.fingerprint, y.fingerprint); !parts.empty())
    out += fmt::format("  made differently: {}\n", parts);
  for (const auto& [name, table] : x.tables) {
    const auto other = y.tables.find(name);
    out += other == y.tables.end() ? fmt::format("  table {}: only in the first run\n", name)
                                   : table_difference(name, table, other->second);
  }
  for (const auto& [name, table] : y.tables) {
    if (!x.tables.contains(name)) out += fmt::format("  table {}: only in the second run\n", name);
  }
  const auto verdict = [](const io::StageFileContent& c) {
    return c.attributes.contains("verdict") ? c.attributes.at("verdict") : std::string();
  };
  if (verdict(x) != verdict(y)) out += fmt::format("  verdict: \"{}\" and \"{}\"\n", verdict(x), verdict(y));
  return out;
}

}  // namespace

std::string compare_runs(const std::filesystem::path& a, const std::filesystem::path& b) {
  const std::vector<StageRecord> first = read_stage_records(a), second = read_stage_records(b);
  const auto named = [](const std::vector<StageRecord>& records, const std::string& name) {
    return std::find_if(records.begin(), records.end(), [&](const StageRecord& r) { return r.name == name; });
  };
  std::string out;
  for (const StageRecord& record : first) {
    const auto other = named(second, record.name);
    const std::string difference =
        other == second.end() ? "  only in the first run\n" : stage_difference(record, *other);
    if (!difference.empty()) out += record.name + "\n" + difference;
  }
  for (const StageRecord& record : second) {
    if (named(first, record.name) == first.end()) out += record.name + "\n  only in the second run\n";
  }
  return out;
}

}  // namespace brachium::pipelines
