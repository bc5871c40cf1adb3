#pragma once
/// Expected numbers that a definition carries: [[expect]] names a number of a stage's table and what it
/// should be.

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/io/toml.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

/// `column` of the one row of `table` that `where` selects (or of row `row`); with `every` of all rows that it selects.
struct Expectation {
  std::string name;
  std::string stage, table, column;
  std::map<std::string, std::string> where;  ///< column -> value as text; every entry must hold
  std::optional<std::size_t> row;            ///< from 0
  bool every = false;                        ///< all selected rows, at least one
  std::optional<double> value;
  double tolerance = 0.0;  ///< absolute
  std::optional<double> minimum, maximum;
  data::SourceSpan place;
};

struct ExpectationResult {
  const Expectation* expectation = nullptr;
  bool checked = false;  ///< false: its stage was not part of this run
  bool passed = false;
  std::optional<double> found;  ///< of every row: the first that fails, else the first
  std::string remark;           ///< why there is no number
};

std::vector<Expectation> parse_expectations(io::TomlTable& root, std::vector<data::Diagnostic>& diagnostics);

/// Checks one expectation on its stage's output (null: the stage was not run).
ExpectationResult check_expectation(const Expectation& expectation, const StageData* output);

std::string wanted_text(const Expectation& expectation);  ///< "1.1 +- 0.05", "at most 2"
std::string place_text(const Expectation& expectation);   ///< "verdict/metrics[model=fim].rmse_N_m"

/// A table for the terminal, one line per expectation.
std::string expectation_table(std::span<const ExpectationResult> results);

}  // namespace brachium::pipelines
