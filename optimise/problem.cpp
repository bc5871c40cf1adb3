#include "optimise/problem.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "data/model/error.hpp"

namespace brachium::optimise {
namespace {

std::string complaint(const Parameter& p) {
  if (!std::isfinite(p.start) || !std::isfinite(p.lower) || !std::isfinite(p.upper))
    return fmt::format("start {}, bounds [{}, {}] must be finite", p.start, p.lower, p.upper);
  if (!(p.lower < p.upper))
    return fmt::format("lower bound {} is not below the upper bound {}", p.lower, p.upper);
  if (!(p.start >= p.lower && p.start <= p.upper))
    return fmt::format("start {} is outside the bounds [{}, {}]", p.start, p.lower, p.upper);
  if (!(p.scale > 0.0) || !std::isfinite(p.scale)) return fmt::format("scale {} is not positive", p.scale);
  if (p.prior && (!(p.prior->standard_deviation > 0.0) || !std::isfinite(p.prior->mean)))
    return fmt::format("prior {} +- {} needs a finite mean and a positive deviation", p.prior->mean,
                       p.prior->standard_deviation);
  return {};
}

template <class Member>
Eigen::VectorXd collect(const std::vector<Parameter>& parameters, Member member) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t j = 0; j < parameters.size(); ++j)
    out[static_cast<Eigen::Index>(j)] = parameters[j].*member;
  return out;
}

}  // namespace

void check_parameters(const std::vector<Parameter>& parameters) {
  std::vector<data::Diagnostic> found;
  std::set<std::string> labels;
  for (const Parameter& p : parameters) {
    const std::string text = complaint(p);
    if (!text.empty())
      found.push_back({data::Severity::error,
                       "bad-parameter",
                       fmt::format("parameter `{}`: {}", p.label(), text),
                       {},
                       {}});
    if (!labels.insert(p.label()).second)
      found.push_back({data::Severity::error,
                       "duplicate-parameter",
                       fmt::format("parameter `{}` is set free twice", p.label()),
                       {},
                       "keep one of the entries"});
  }
  if (!found.empty()) throw data::InputError(std::move(found));
}

Eigen::VectorXd start_of(const std::vector<Parameter>& parameters) {
  return collect(parameters, &Parameter::start);
}
Eigen::VectorXd lower_of(const std::vector<Parameter>& parameters) {
  return collect(parameters, &Parameter::lower);
}
Eigen::VectorXd upper_of(const std::vector<Parameter>& parameters) {
  return collect(parameters, &Parameter::upper);
}
Eigen::VectorXd scale_of(const std::vector<Parameter>& parameters) {
  return collect(parameters, &Parameter::scale);
}

}  // namespace brachium::optimise
