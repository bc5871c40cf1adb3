#pragma once
/// Collects every parameter outside its range, so that all are reported at once.

#include <string>
#include <vector>

#include "data/model/error.hpp"

namespace brachium::hill {

class ParameterCheck {
 public:
  /// `owner` as it shall stand in messages: "muscle `BRA`", "curve set `thelen_2003`".
  explicit ParameterCheck(std::string owner) : owner_(std::move(owner)) {}

  /// Notes a mistake unless `inside`; pass the comparison itself, so that NaN fails it.
  void require(bool inside, const char* parameter, double value, const char* range);
  /// Throws InputError("bad-parameter") if there were mistakes.
  void finish() const;

 private:
  std::string owner_;
  std::vector<data::Diagnostic> mistakes_;
};

}  // namespace brachium::hill
