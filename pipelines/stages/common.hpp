#pragma once
/// What the stages' bindings share: short ways to write specifications, and the headers of the sessions they write.

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/report/build.hpp"
#include "pipelines/stage.hpp"

namespace brachium::pipelines {

// ---------------------------------------------------------------- specifications

struct Bounds {
  std::optional<double> lower{}, upper{};
  bool lower_open = false, upper_open = false;
};
inline Bounds above(double lower) {
  return {lower, std::nullopt, true, false};
}
inline Bounds at_least(double lower) {
  return {lower, std::nullopt, false, false};
}
inline Bounds between(double lower, double upper) {
  return {lower, upper, false, false};
}

OptionSpec number_option(std::string key, std::string unit, double fallback, Bounds bounds, std::string doc);
OptionSpec optional_number(std::string key, std::string unit, Bounds bounds, std::string doc);
OptionSpec integer_option(std::string key, std::int64_t fallback, Bounds bounds, std::string doc);
OptionSpec flag_option(std::string key, bool fallback, std::string doc);
OptionSpec choice_option(std::string key, std::string fallback, std::vector<std::string> allowed,
                         std::string doc);
OptionSpec text_option(std::string key, std::string fallback, std::string doc);
OptionSpec optional_text(std::string key, std::string doc);
OptionSpec texts_option(std::string key, std::vector<std::string> fallback, std::string doc);

// ---------------------------------------------------------------- sessions

/// Trial of that name in a stage's signals; InputError("missing-trial") says which stage's output lacks it.
const data::TrialInfo& trial_info(const StageData& data, const std::string& trial);
std::size_t trial_index(const StageData& data, const std::string& trial);

/// Indices of the trial's signals of one quantity.
std::vector<std::size_t> signals_of(const data::TrialInfo& trial, data::Quantity quantity);

/// The one signal of a quantity that belongs to the coordinate (or to none, where only one is there).
/// Throws InputError("missing-signal") naming trial, quantity and stage.
data::Signal signal_of(const StageData& data, const std::string& trial, data::Quantity quantity,
                       const std::string& coordinate);
bool has_signal_of(const StageData& data, const std::string& trial, data::Quantity quantity,
                   const std::string& coordinate);

/// Begins the output: the input's session header, and the given trials without signals.
void begin_output(const StageContext& context, const StageData& from, StageOutput& out);

/// Patterns matched against the names; every pattern must match. No pattern: all names.
std::vector<std::string> select(const std::vector<std::string>& patterns,
                                const std::vector<std::string>& names, const std::string& what);

std::vector<std::string> names_of(const data::TrialInfo& trial, const std::vector<std::size_t>& signals);

/// The scene's only coordinate, or the one named; InputError("missing-coordinate") where a choice is needed.
const data::Coordinate& coordinate_of(const data::Scene& scene, const std::string& name);

// ---------------------------------------------------------------- tables

/// How a figure that may not be defined, such as R2 against a reference that does not vary, stands in a table (NaN:
/// a number would claim something) and in a sentence.
inline double or_undefined(const std::optional<double>& value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}
std::string figure_text(const std::optional<double>& value, int decimals);
inline constexpr const char* undefined_text = "not defined";

/// A table built row by row.
class TableBuilder {
 public:
  explicit TableBuilder(std::string title);
  TableBuilder& number(const std::string& name, const std::string& unit);
  TableBuilder& text(const std::string& name);
  /// One value a column, in their order.
  void row(std::vector<std::variant<double, std::string>> values);
  data::Table take() { return std::move(table_); }

 private:
  data::Table table_;
};

/// A report's plots of one quantity, one small plot a trial, a line a signal.
report::PlotRow trial_plots(const data::SessionSource& source, const std::vector<std::string>& trials,
                            data::Quantity quantity, const std::string& what, const std::string& unit = "");

}  // namespace brachium::pipelines
