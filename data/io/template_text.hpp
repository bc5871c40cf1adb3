#pragma once
/// Texts with {variables}. For the .cpp files of data/io only.

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace brachium::io {

/// `text` with every {name} replaced; names without a value are added to `unknown` and left as they are.
std::string fill(const std::string& text, const std::map<std::string, std::string>& variables,
                 std::vector<std::string>& unknown);

}  // namespace brachium::io
