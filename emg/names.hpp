#pragma once
/// Names of enumerators, both ways: a table of (value, name) pairs serves every enumeration of the folder.

#include <fmt/format.h>

#include <string>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::emg {

template <class Table, class Value>
std::string name_of(const Table& table, Value wanted) {
  for (const auto& [value, name] : table) {
    if (value == wanted) return name;
  }
  return {};
}

/// Throws InputError(code), "`name` is not <what>", with the nearest name.
template <class Table>
auto parse_name(const Table& table, const std::string& name, const std::string& code,
                const std::string& what) {
  std::vector<std::string> known;
  for (const auto& [value, n] : table) {
    if (name == n) return value;
    known.emplace_back(n);
  }
  throw data::InputError(code, fmt::format("`{}` is not {}", name, what), data::suggest(name, known));
}

}  // namespace brachium::emg
