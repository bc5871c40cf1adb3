#include "hill/curve_set.hpp"

#include <fmt/format.h>

#include "data/model/error.hpp"

namespace brachium::hill {

const std::vector<std::string>& CurveSet::names() {
  static const std::vector<std::string> all = {"degroote_fregly_2016", "thelen_2003",       "millard_2012",
                                               "lloyd_2003",           "lloyd_2003_spline", "guenther_2007"};
  return all;
}

CurveSet CurveSet::named(std::string_view name) {
  if (name == "degroote_fregly_2016") return DeGrooteFregly2016();
  if (name == "thelen_2003") return Thelen2003();
  if (name == "millard_2012") return Millard2012();
  if (name == "lloyd_2003") return Lloyd2003();
  if (name == "lloyd_2003_spline") return Lloyd2003(Lloyd2003::Interpolant::spline);
  if (name == "guenther_2007") return Guenther2007();
  throw data::InputError("unknown-curve-set", fmt::format("`{}` is not a set of muscle curves", name),
                         data::suggest(name, names()));
}

std::string CurveSet::name() const {
  return std::visit([](const auto& set) { return std::string(set.name()); }, set_);
}
data::CurveValue CurveSet::active(double x) const {
  return std::visit([x](const auto& set) { return set.active(x); }, set_);
}
data::CurveValue CurveSet::passive(double x) const {
  return std::visit([x](const auto& set) { return set.passive(x); }, set_);
}
VelocityValue CurveSet::velocity(double v, double a) const {
  return std::visit([v, a](const auto& set) { return set.velocity(v, a); }, set_);
}
data::CurveValue CurveSet::tendon(double strain) const {
  return std::visit([strain](const auto& set) { return set.tendon(strain); }, set_);
}
CurveDomains CurveSet::domains() const {
  return std::visit([](const auto& set) { return set.domains(); }, set_);
}

}  // namespace brachium::hill
