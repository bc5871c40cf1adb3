#include "pipelines/error_codes.hpp"

#include <algorithm>

namespace brachium::pipelines {

std::optional<std::string> explain_error(const std::string& code) {
  const auto& all = error_codes();
  const auto found = std::find_if(all.begin(), all.end(), [&](const ErrorCode& e) { return e.code == code; });
  return found == all.end() ? std::nullopt : std::optional(found->meaning);
}

}  // namespace brachium::pipelines
