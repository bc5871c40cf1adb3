#include "hill/guenther_2007.hpp"

#include "hill/parameter_check.hpp"

namespace brachium::hill {

Guenther2007::Guenther2007(const Parameters& p) : p_(p) {
  ParameterCheck check("curve set `guenther_2007`");
  check.require(p.ascending_width > 0, "ascending_width", p.ascending_width, "positive");
  check.require(p.descending_width > 0, "descending_width", p.descending_width, "positive");
  check.require(p.ascending_exponent > 1, "ascending_exponent", p.ascending_exponent,
                "above 1, or the peak has a corner");
  check.require(p.descending_exponent > 1, "descending_exponent", p.descending_exponent,
                "above 1, or the peak has a corner");
  check.finish();
}

}  // namespace brachium::hill
