#pragma once
/// A small table with named columns: verdicts, fit statistics, quality figures.

#include <string>
#include <variant>
#include <vector>

namespace brachium::data {

struct Column {
  std::string name;
  std::string unit;  ///< "1" for pure numbers, empty for text
  std::variant<std::vector<double>, std::vector<std::string>> values;
};

struct Table {
  std::string title;
  std::vector<Column> columns;  ///< all of the same length

  std::size_t rows() const;
  const Column& column(const std::string& name) const;                ///< throws InputError("missing-column")
  const std::vector<double>& numbers(const std::string& name) const;  ///< throws if text
  const std::vector<std::string>& texts(const std::string& name) const;  ///< throws if numbers
};

}  // namespace brachium::data
