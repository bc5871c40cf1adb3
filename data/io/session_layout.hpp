#pragma once
/// Names in a session file, shared by its reader and its writer. For the .cpp files of data/io only.

#include <algorithm>
#include <string>
#include <string_view>

namespace brachium::io::layout {

inline constexpr std::string_view format = "brachium-session";
inline constexpr int version = 1;
inline const std::string attribute = "attribute.";
inline const std::string condition = "condition.";
inline const std::string anthropometry = "anthropometry.";
inline constexpr const char* help =
    "the layout is described in data/io/README.md; import the recordings again";

/// time_<digits>: a dimension scale, not a signal.
inline bool is_time_name(const std::string& name) {
  return name.starts_with("time_") && name.size() > 5 &&
         std::all_of(name.begin() + 5, name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace brachium::io::layout
