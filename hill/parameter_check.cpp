#include "hill/parameter_check.hpp"

#include <fmt/format.h>

namespace brachium::hill {

void ParameterCheck::require(bool inside, const char* parameter, double value, const char* range) {
  if (inside) return;
  data::Diagnostic d;
  d.code = "bad-parameter";
  d.message = fmt::format("`{}` of {} is {}", parameter, owner_, value);
  d.help = fmt::format("it must be {}", range);
  mistakes_.push_back(std::move(d));
}

void ParameterCheck::finish() const {
  if (!mistakes_.empty()) throw data::InputError(mistakes_);
}

}  // namespace brachium::hill
