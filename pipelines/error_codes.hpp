#pragma once
/// What each code of a finding means and what to do: `brachium explain CODE`.

#include <optional>
#include <string>
#include <vector>

namespace brachium::pipelines {

struct ErrorCode {
  std::string code, meaning;
};

/// Every code that the program uses, in alphabetical order.
const std::vector<ErrorCode>& error_codes();

std::optional<std::string> explain_error(const std::string& code);

}  // namespace brachium::pipelines
