#include "data/model/table.hpp"

#include <fmt/format.h>

#include "data/model/error.hpp"

namespace brachium::data {

std::size_t Table::rows() const {
  return columns.empty() ? 0 : std::visit([](const auto& v) { return v.size(); }, columns.front().values);
}

const Column& Table::column(const std::string& name) const {
  std::vector<std::string> known;
  for (const Column& c : columns) {
    if (c.name == name) return c;
    known.push_back(c.name);
  }
  throw InputError("missing-column", fmt::format("table `{}` has no column `{}`", title, name),
                   suggest(name, known));
}

const std::vector<double>& Table::numbers(const std::string& name) const {
  const auto* values = std::get_if<std::vector<double>>(&column(name).values);
  if (!values)
    throw InputError("wrong-column-type",
                     fmt::format("column `{}` of table `{}` holds text, not numbers", name, title));
  return *values;
}

const std::vector<std::string>& Table::texts(const std::string& name) const {
  const auto* values = std::get_if<std::vector<std::string>>(&column(name).values);
  if (!values)
    throw InputError("wrong-column-type",
                     fmt::format("column `{}` of table `{}` holds numbers, not text", name, title));
  return *values;
}

}  // namespace brachium::data
